//! Every bound of the gate, each with its reason. How many clients may connect at once is limited by the program's
//! accept loop.

use std::time::Duration;

/// Longest CONNECT, in bytes: names and a will, which is a short message.
pub const CONNECT: usize = 64 * 1024;

/// Longest packet of a client, in bytes: a scaled-down photo of a phone fits.
pub const CLIENT_PACKET: usize = 256 * 1024;

/// Packets handled per client before other clients get a turn.
pub(crate) const TURN: usize = 64;

/// Longest topic or filter, in bytes.
pub(crate) const TOPIC: usize = 512;

/// Most levels of a topic or filter: searches go through them level by level.
pub(crate) const LEVELS: usize = 32;

/// Topic aliases that a client of MQTT 5 may set, and most that are set for it.
pub const ALIASES: u16 = 10;

/// A client that accepts no packets longer than this, in bytes, gets no reasons in words: no packet with such a reason
/// is longer.
pub(crate) const WITH_WORDS: u32 = 1024;

/// Longest keep alive granted to a client of MQTT 5, in seconds: one and a half times this is `SILENCE`.
pub const KEEP_ALIVE_S: u16 = 57_600;

/// Most bytes of properties that go on with a message, user properties included.
pub(crate) const PROPERTIES: usize = 16 * 1024;

/// Filters held by one connection: Home Assistant makes one for each topic of each of its devices.
pub const FILTERS: usize = 1024;

/// Total size of the filters held by one connection, in bytes.
pub(crate) const FILTER_BYTES: usize = 64 * 1024;

/// Filters in one packet, since a packet is answered in one turn. Home Assistant sends up to 500.
pub(crate) const PACKET_FILTERS: usize = 512;

/// Most retained messages of all clients together; the program has room of its own (`PROGRAM_KEPT`).
pub(crate) const KEPT: usize = 10 * 1024;

/// Size of the retained messages of all clients, in bytes, topics included.
pub(crate) const KEPT_BYTES: usize = 32 * 1024 * 1024;

/// Places of `KEPT` reserved for keys that retain little.
pub(crate) const KEPT_RESERVE: usize = 2048;

/// Bytes of `KEPT_BYTES` reserved for keys that retain little.
pub(crate) const KEPT_RESERVE_BYTES: usize = 8 * 1024 * 1024;

/// A key with fewer retained messages than this may use the reserve.
pub(crate) const KEPT_LITTLE: usize = 256;

/// A key whose retained messages take fewer bytes than this may use the reserve.
pub(crate) const KEPT_LITTLE_BYTES: usize = 1024 * 1024;

/// Most retained messages of one key: less than half of `KEPT`, so that no key fills it alone.
pub(crate) const KEPT_SHARE: usize = 4096;

/// Size of the retained messages of one key, in bytes.
pub(crate) const KEPT_SHARE_BYTES: usize = 8 * 1024 * 1024;

/// Retained messages of the program itself, which has a dozen topics.
pub(crate) const PROGRAM_KEPT: usize = 256;

/// Size of the program's retained messages, in bytes: a large map, a photo, and what stands on the other topics.
pub(crate) const PROGRAM_KEPT_BYTES: usize = 8 * 1024 * 1024;

/// Retained messages examined for one client before other clients get a turn.
pub(crate) const KEPT_STEPS: usize = 512;

/// Unacknowledged retained messages of one client. Mosquitto allows as many.
pub(crate) const KEPT_UNDER_WAY: usize = 20;

/// Approximate memory that a message takes beside its topic and payload, in bytes.
pub(crate) const MESSAGE_COST: usize = 128;

/// Most that a message weighs while it waits for one of its readers, in bytes: a long one is in memory once for all of
/// them.
pub(crate) const HEAVIEST: usize = 16 * 1024;

/// Most that may wait for one subscriber, by weight: what it gets at once when it has not read for a moment. Beyond
/// this the oldest message is lost.
pub(crate) const QUEUE: usize = 256 * 1024;

/// Most memory of the messages that wait for one subscriber, in bytes, whoever shares them. Beyond this the oldest of
/// those that weigh less than they take is lost.
pub(crate) const QUEUE_BYTES: usize = 2 * 1024 * 1024;

/// Messages wait for a subscriber that is away only while all waiting messages together take at most this many bytes.
/// One that goes away when they take more loses its queue.
pub(crate) const AWAY: usize = 8 * 1024 * 1024;

/// Weight of the messages waiting for a subscriber from which on flooding publishers wait for it: a part of the queue,
/// since several may publish at once, and large enough that neither side idles.
pub(crate) const LAG: usize = QUEUE / 4;

/// Bytes of the messages waiting for a subscriber from which on flooding publishers wait for it.
pub(crate) const LAG_BYTES: usize = QUEUE_BYTES / 4;

/// Weight of a client's messages passed on before lagging readers are looked for: others may publish at the same time.
pub(crate) const PIECE: usize = LAG / 4;

/// A publisher waits until at most this weight waits for the subscriber.
pub(crate) const RELIEF: usize = LAG / 2;

/// A publisher waits until at most this many bytes wait for the subscriber.
pub(crate) const RELIEF_BYTES: usize = LAG_BYTES / 2;

/// Longest wait of a publisher for a subscriber that reads, though too slowly.
pub(crate) const PATIENCE: Duration = Duration::from_millis(500);

/// Longest wait of a publisher for the first subscriber that does not read, as something urgent may stand behind what
/// the publisher has sent. When several stop reading one after the other, each is waited for half as long as the one
/// before.
pub(crate) const STILL: Duration = Duration::from_millis(40);

/// A wait that would be shorter than this is left out.
pub(crate) const STILL_SHORTEST: Duration = Duration::from_millis(1);

/// How long nobody waits for a subscriber that was waited for in vain. Each time it is twice as long as the last time.
pub(crate) const FORGIVEN: Duration = Duration::from_secs(10);

/// Upper bound of the doubling of `FORGIVEN`.
pub(crate) const FORGIVEN_LONGEST: Duration = Duration::from_secs(640);

/// After this time without a new offence, `FORGIVEN` starts from its first value again.
pub(crate) const MENDED: Duration = Duration::from_secs(60);

/// In a flood, a message counts once more for each of this many bytes in it.
pub(crate) const LONG: usize = 512;

/// Messages per second that are no flood: a client that publishes no more never waits for anybody, so that urgent
/// messages are read at once.
pub(crate) const NO_FLOOD: u64 = 256;

/// A payload of at least this many bytes is shared by all its readers; shorter ones are copied for each, which is
/// cheaper.
pub(crate) const SHARED: usize = 1024;

/// No further retained message is sent to a client while more bytes than this wait for it.
pub(crate) const KEPT_ROOM: usize = 32 * 1024;

/// No further message is sent to a client while more bytes than this wait for it.
pub const CLIENT_ROOM: usize = 64 * 1024;

/// No more packets are handled for a client while more bytes than this wait for it. Urgent messages are heard all the
/// same; a client that goes on sending and reads nothing is disconnected.
pub const ANSWER_ROOM: usize = 512 * 1024;

/// Unacknowledged messages of a client beyond which it gets no more messages that need an acknowledgement.
pub(crate) const WINDOW: usize = 100;

/// Bytes of unacknowledged messages of a client beyond which it gets no more messages that need an acknowledgement.
pub(crate) const WINDOW_BYTES: usize = 512 * 1024;

/// Most messages of QoS 2 that a client leaves unreleased. Clients of MQTT 5 are told it as Receive Maximum.
pub const UNRELEASED: usize = 4096;

/// Number of latest commands of a client that are compared to recognise a duplicate.
pub(crate) const HANDLED: usize = 256;

/// Longest silence of a client, whatever keep alive it announced.
pub(crate) const SILENCE: Duration = Duration::from_secs(24 * 3600);
