//! Every bound of our own broker, with its reason.

/// Clients at once, beside our own session: every screen, sensor and script of a site. Each costs three descriptors, its own and two
/// towards the engine.
pub const CONNECTIONS: usize = 256;

/// How long a client may take to say who it is, in milliseconds.
pub const CONNECT_TIME_MS: u16 = 5_000;

/// The longest packet of ours, in bytes: the JSON of a large map, or a photo.
pub const HOUSE_PACKET: usize = 2 * 1024 * 1024;

/// How many messages the engine hands to one client before it looks after the others.
pub const BATCH: u64 = 1_000;

/// How many packets of one client the engine takes at a time.
pub const INFLIGHT: usize = 1_000;

/// The engine keeps messages in segments of this size, in bytes, for subscribers who lag,
pub const SEGMENT_BYTES: usize = 1024 * 1024;

/// and so many of them for each filter. A subscriber who lags further behind misses messages.
pub const SEGMENTS: usize = 4;
