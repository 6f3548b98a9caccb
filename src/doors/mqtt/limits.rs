//! How many clients our own broker serves, and what they may cost, with the reasons. Limits of a packet and of a connection are
//! in the gate.

use std::time::Duration;

pub(super) const WAITING: usize = 256;

/// Maximum number of closing connections that still receive a reason or remaining messages. Beyond it some are cut off.
pub(super) const LEAVING: usize = 64;

/// Maximum time for a client to introduce itself.
pub(super) const CONNECT_TIME: Duration = Duration::from_secs(5);

pub(super) const CONNECTION_BYTES: usize = 1024 * 1024;

/// Part of `CONNECTION_BYTES` for messages to the client.
pub(super) const MESSAGES_PART: usize = 256 * 1024;

/// Part of `CONNECTION_BYTES` reserved for output to a client that does not read, in addition to what waits already.
pub(super) const UNREAD_PART: usize = 448 * 1024;

pub(super) const READ_AHEAD: usize = 16 * 1024 * 1024;

/// Number of bytes that each connection may always read ahead.
pub(super) const ALWAYS_AHEAD: usize = 64 * 1024;
