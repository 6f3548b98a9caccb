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

/// So many bytes more than it had at first, beside what is kept, the program may have in use before the engine is taken for the cause
/// and started anew. It forgets no message before enough newer ones have come to the same filter, and each holds on to all that was
/// read with it.
pub(super) const APPETITE: usize = 64 * 1024 * 1024;
