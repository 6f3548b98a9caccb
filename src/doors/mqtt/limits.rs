//! Limits of our own broker, with the reasons: the number of clients, and the memory for each client. The gate limits
//! packets and connections.

use std::time::Duration;

pub(super) const WAITING: usize = 256;

/// Maximum number of closing connections that may still send a reason or the remaining messages. Beyond this number,
/// the oldest one of the network with the most closing connections is cut off.
pub(super) const LEAVING: usize = 64;

/// Maximum time until a new client has sent its CONNECT.
pub(super) const CONNECT_TIME: Duration = Duration::from_secs(5);

pub(super) const CONNECTION_BYTES: usize = 1024 * 1024;

/// Part of `CONNECTION_BYTES` for messages that wait for the client.
pub(super) const MESSAGES_PART: usize = 256 * 1024;

/// Part of `CONNECTION_BYTES` reserved for further output to a client that does not read. It comes in addition to the
/// output that waits already.
pub(super) const UNREAD_PART: usize = 448 * 1024;

pub(super) const READ_AHEAD: usize = 16 * 1024 * 1024;

/// Number of bytes that each connection may always read ahead.
pub(super) const ALWAYS_AHEAD: usize = 64 * 1024;
