//! How many clients our own broker serves and how much the engine behind it remembers, each with its reason. What one packet or one
//! connection may bring is bounded in the gate.

use std::time::Duration;

/// Clients at once, beside our own session: every screen, sensor and script of a site. Each costs three descriptors, its own and two
/// towards the engine.
pub(super) const CONNECTIONS: usize = 256;

/// Connections at once, with those that have not said yet who they are: however many there are, a newcomer can say it.
pub(super) const PLACES: usize = CONNECTIONS + 64;

/// How long a client may take to say who it is.
pub(super) const CONNECT_TIME: Duration = Duration::from_secs(5);

/// How many messages the engine hands to one client before it looks after the others: more cost memory for every client that lags,
/// and speed nothing up.
pub(super) const BATCH: u64 = 200;

/// How many packets of one client the engine takes at a time.
pub(super) const PACKETS: usize = 1_000;

/// The engine keeps messages in segments of this size, in bytes, for subscribers who lag,
pub(super) const SEGMENT_BYTES: usize = 1024 * 1024;

/// and so many of them for each filter. A subscriber who lags further behind misses messages.
pub(super) const SEGMENTS: usize = 4;

/// So many bytes more than it had at first the program may have in use before the engine is taken for the cause and started anew. A
/// segment is measured by what is said in it; small messages, each of which holds on to all that was read with it, may cost a
/// thousand times that, and the engine forgets none of them before enough newer ones have come.
pub(super) const APPETITE: usize = 512 * 1024 * 1024;
