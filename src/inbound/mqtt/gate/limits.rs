//! Every bound of the gate, each with its reason. Bounds on how many may come in at once are the accept loop's.

use std::time::Duration;

/// The longest CONNECT: names and a will, which is a short message.
pub const CONNECT: usize = 64 * 1024;

/// The longest packet of a guest: a photo of a phone, scaled down, fits.
pub const GUEST_PACKET: usize = 256 * 1024;

/// The longest packet of the program itself, which publishes maps and photos. The engine must accept as much.
pub const HOUSE_PACKET: usize = 2 * 1024 * 1024;

/// So many packets of a client are taken before it is looked whether others wait.
pub const TURN: usize = 64;

/// The longest topic or filter, in bytes: the engine keeps every one that it ever saw.
pub const TOPIC: usize = 512;

/// The most levels of a topic or filter: the engine compares them level by level, for every message.
pub const LEVELS: usize = 32;

/// Filters held by one connection.
pub const FILTERS: usize = 64;

/// Topics that one connection publishes on: the engine counts them for each connection.
pub const TOPICS: usize = 16 * 1024;

/// Filters that ever reached an engine, which keeps a log for each until it ends.
pub const ENGINE_FILTERS: usize = 4096;

/// Of these, those that whoever only looks may spend.
pub const VIEWERS_FILTERS: usize = ENGINE_FILTERS / 2;

/// Topics that ever reached an engine, which remembers what each matched until it ends.
pub const ENGINE_TOPICS: usize = 64 * 1024;

/// Kept messages of the whole broker.
pub const KEPT: usize = 8192;

/// Their bytes in all, topics included.
pub const KEPT_BYTES: usize = 32 * 1024 * 1024;

/// Beside these there is room for so many of the program's own, which has a dozen topics,
pub const KEPT_OURS: usize = 256;

/// and so many bytes: a large map, a photo, and what stands on the other topics.
pub const KEPT_OURS_BYTES: usize = 16 * 1024 * 1024;

/// What a kept message costs beside its topic and payload, about.
pub const KEPT_COST: usize = 128;

/// Kept messages of QoS 1 that a client has not acknowledged yet: what mosquitto allows, too.
pub const KEPT_UNDER_WAY: usize = 20;

/// So many messages may be on their way to a subscriber before whoever publishes more is made to wait: a small part of what the
/// engine keeps, and enough that nobody waits for the other. Long ones count for several.
pub const LAG: i64 = 2_000;

/// A message counts once more for each of so many bytes in it, so that long ones are no more than a mebibyte together.
pub const LONG: usize = 512;

/// It waits until they are no more than this.
pub const RELIEF: i64 = 1_000;

/// So long a publisher waits for its subscribers, all of them together.
pub const PATIENCE: Duration = Duration::from_millis(500);

/// A subscriber that could not be waited for is not waited for during so long,
pub const FORGIVEN: Duration = Duration::from_secs(10);

/// and each time twice as long as the last time, but no longer than this.
pub const FORGIVEN_LONGEST: Duration = Duration::from_secs(640);

/// So many messages in a second are no flood: whoever publishes no more never waits for anybody, so that a STOP is read at once.
pub const NO_FLOOD: u64 = 256;

/// The ids of kept messages: above the engine's, which are 1 to 100.
pub const KEPT_IDS: std::ops::RangeInclusive<u16> = 1001..=2000;

/// No further kept message is put before a client, and nothing more is read from the engine for it, while more than this waits for it.
pub const CLIENT_ROOM: usize = 256 * 1024;

/// No more is taken from a client while more than this waits for it. Its STOPs are heard all the same; one that goes on sending, and
/// reads none of it, is sent away.
pub const ANSWER_ROOM: usize = 512 * 1024;

/// No more is taken from a client while more than this waits for the engine.
pub const ENGINE_ROOM: usize = 128 * 1024;

/// Messages of the engine that a client has not acknowledged: it sends 100 and waits; beyond twice that it is not itself.
pub const OUTSTANDING: usize = 200;

/// Answers of the engine to SUBSCRIBE and UNSUBSCRIBE that a client is waiting for.
pub const PENDING: usize = 1024;

/// Messages of QoS 2 that a client has not released.
pub const UNRELEASED: usize = 4096;

/// Commands by which a duplicate is known.
pub const HANDLED: usize = 256;

/// The longest silence of a client, whatever it announced. The engine's own patience must be longer.
pub const SILENCE: Duration = Duration::from_secs(24 * 3600);
