//! How many clients our own broker serves, and what they may cost, each with its reason. What one packet or one
//! connection may bring is bounded in the gate.

use std::time::Duration;

/// Connections at once that have not said yet who they are: however many there are, a newcomer can say it.
pub(super) const WAITING: usize = 256;

/// Connections at once that are told why they end, or are still to read what was left for them: of more than these some are cut.
pub(super) const LEAVING: usize = 64;

/// How long a client may take to say who it is.
pub(super) const CONNECT_TIME: Duration = Duration::from_secs(5);

/// What one connection may cost, in bytes: what was read ahead of it, and what waits for its client.
pub(super) const CONNECTION_BYTES: usize = 1024 * 1024;

/// Of these, what is left to messages that come for it,
pub(super) const MESSAGES_PART: usize = 256 * 1024;

/// and so much more of a client that does not read what comes: then all that may wait for it does.
pub(super) const UNREAD_PART: usize = 448 * 1024;

/// What is read ahead of all connections together, in bytes,
pub(super) const READ_AHEAD: usize = 16 * 1024 * 1024;

/// beside what can always be read of each.
pub(super) const ALWAYS_AHEAD: usize = 64 * 1024;
