//! How many clients our own broker serves, and what they may cost, each with its reason. Bounds of a packet and of a connection
//! are in the gate.

use std::time::Duration;

/// Maximum number of clients: every screen, sensor and script of a site. Each costs a descriptor.
pub(super) const CONNECTIONS: usize = 256;

/// Maximum number of connections that have not authenticated yet; beyond it the oldest are cut, so that a newcomer can always
/// introduce itself.
pub(super) const WAITING: usize = 256;

/// Maximum number of closing connections that still receive a reason or remaining messages; beyond it some are cut.
pub(super) const LEAVING: usize = 64;

/// Maximum time for a client to introduce itself.
pub(super) const CONNECT_TIME: Duration = Duration::from_secs(5);

/// Share of one key among all clients: every screen of a large site. As many are reserved for operators who are not connected
/// yet.
pub(super) const SHARE: usize = CONNECTIONS / 4;

/// Maximum memory of one connection in bytes: bytes read ahead, and bytes waiting for its client.
pub(super) const CONNECTION_BYTES: usize = 1024 * 1024;

/// Part of `CONNECTION_BYTES` for messages to the client.
pub(super) const MESSAGES_PART: usize = 256 * 1024;

/// Part of `CONNECTION_BYTES` set aside for output to a client that does not read, beside what waits already.
pub(super) const UNREAD_PART: usize = 448 * 1024;

/// Maximum number of bytes waiting for all clients together, because they do not read.
pub(super) const UNREAD: usize = 12 * 1024 * 1024;

/// Maximum number of bytes waiting for viewers, which leaves room for operators.
pub(super) const VIEWERS_UNREAD: usize = UNREAD / 2;

/// A client with no more waiting bytes than this gives way to nobody.
pub(super) const LITTLE_UNREAD: usize = 48 * 1024;

/// Maximum number of bytes read ahead of all connections together.
pub(super) const READ_AHEAD: usize = 16 * 1024 * 1024;

/// Bytes that can always be read ahead of each connection.
pub(super) const ALWAYS_AHEAD: usize = 64 * 1024;
