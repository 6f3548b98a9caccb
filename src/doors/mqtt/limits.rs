//! How many clients our own broker serves and how much the router behind it remembers, each with its reason. What one packet or one
//! connection may bring is bounded in the gate.

use std::time::Duration;

/// Clients at once, beside our own session: every screen, sensor and script of a site. Each costs three descriptors.
pub(super) const CONNECTIONS: usize = 256;

/// Connections at once that have not said yet who they are: however many there are, a newcomer can say it.
pub(super) const WAITING: usize = 256;

/// Connections at once that are told why they end, or are still to read what was left for them: of more than these some are cut.
pub(super) const LEAVING: usize = 64;

/// All that may have a way to the router at once, with those that are just leaving.
pub(super) const PLACES: usize = CONNECTIONS + 64;

/// Clients that have left before there was a way to the router for what they published: it waits for one. Beyond these it is lost.
pub(super) const LATE: usize = 64;

/// How long a client may take to say who it is.
pub(super) const CONNECT_TIME: Duration = Duration::from_secs(5);

/// How many messages the router hands to one client before the others: more cost memory for each that lags, and speed nothing up.
pub(super) const BATCH: u64 = 200;

/// How many packets of one client the router takes at a time.
pub(super) const PACKETS: usize = 1_000;

/// So many bytes more than it had at first, beside what is kept, the program may have in use before the router is taken for the cause
/// and started anew. It forgets no message before enough newer ones have come to the same filter, and each holds on to all that was
/// read with it.
pub(super) const APPETITE: usize = 64 * 1024 * 1024;

/// A router that was given no more than this since half of that was taken is not the cause: it holds at most four times as much, and
/// what crowds of connections cost is no doing of its.
pub(super) const MEAL: u64 = APPETITE as u64 / 8;

/// No more than this does a router hold for a filter: room for three times 1,024 messages, and four times the bytes that it counts,
pub(super) const OF_FILTER: usize = 1536 * 1024;

/// and for a client, whose queues these are. Where that comes to less than what was taken, the program has it, as for a large hall.
pub(super) const OF_CLIENT: usize = 512 * 1024;

/// Of all clients, those whom one key may bring, every screen of a large site; and as many are kept from those who only look, for
/// operators who are not there yet.
pub(super) const SHARE: usize = CONNECTIONS / 4;

/// What one connection may cost, in bytes: what was read ahead of it, what waits for the router, and what waits for its client.
pub(super) const CONNECTION_BYTES: usize = 1024 * 1024;

/// Of these, what is left to messages that come from the router for it,
pub(super) const ROUTER_PART: usize = 256 * 1024;

/// and so much more of a client that does not read what comes: it waits at the router, where each message costs many times its bytes.
pub(super) const UNREAD_PART: usize = 448 * 1024;

/// What may wait for the clients of all connections together, in bytes, because they do not read it,
pub(super) const UNREAD: usize = 12 * 1024 * 1024;

/// and for those of viewers, so that there is room for operators' still.
pub(super) const VIEWERS_UNREAD: usize = UNREAD / 2;

/// A client for which no more than this waits gives way to nobody.
pub(super) const LITTLE_UNREAD: usize = 48 * 1024;

/// What is read ahead of all connections together, in bytes,
pub(super) const READ_AHEAD: usize = 16 * 1024 * 1024;

/// beside what can always be read of each.
pub(super) const ALWAYS_AHEAD: usize = 64 * 1024;
