//! All limits of the broker, each with its reason. The number of clients connected at once is limited by the
//! program's accept loop.

use std::time::Duration;

/// Longest CONNECT, in bytes: enough for the names and a short will.
pub const CONNECT: usize = 64 * 1024;

/// Longest packet of a client, in bytes: enough for a scaled-down photo of a phone.
pub const CLIENT_PACKET: usize = 256 * 1024;

/// Packets handled per client before other clients get a turn.
pub(crate) const TURN: usize = 64;

/// Longest topic or filter, in bytes.
pub(crate) const TOPIC: usize = 512;

/// Maximum number of levels of a topic or filter: searches go through them level by level.
pub(crate) const LEVELS: usize = 32;

/// Maximum number of topic aliases that each side sets: a client of MQTT 5, and the broker for such a client.
pub const ALIASES: u16 = 10;

/// Maximum length of a packet with a reason in words, in bytes. A client that does not accept longer packets than
/// this gets no reasons in words.
pub(crate) const WITH_WORDS: u32 = 1024;

/// Longest keep alive granted to a client of MQTT 5, in seconds. `SILENCE` is one and a half times as long.
pub const KEEP_ALIVE_S: u16 = 57_600;

/// Maximum size of the properties that are forwarded with a message, in bytes, user properties included.
pub(crate) const PROPERTIES: usize = 16 * 1024;

/// Maximum number of filters held by one connection. Home Assistant subscribes to one filter for each topic of each
/// device.
pub const FILTERS: usize = 1024;

/// Maximum total size of the filters held by one connection, in bytes.
pub(crate) const FILTER_BYTES: usize = 64 * 1024;

/// Maximum number of filters in one packet, which is answered in one turn. Home Assistant sends up to 500.
pub(crate) const PACKET_FILTERS: usize = 512;

/// Maximum number of retained messages of all clients together. The program's own messages have separate room
/// (`PROGRAM_KEPT`).
pub(crate) const KEPT: usize = 10 * 1024;

/// Maximum size of the retained messages of all clients, in bytes, topics included.
pub(crate) const KEPT_BYTES: usize = 32 * 1024 * 1024;

/// Number of retained messages, out of `KEPT`, that is reserved for keys that retain little.
pub(crate) const KEPT_RESERVE: usize = 2048;

/// Number of bytes, out of `KEPT_BYTES`, that is reserved for keys that retain little.
pub(crate) const KEPT_RESERVE_BYTES: usize = 8 * 1024 * 1024;

/// A key with fewer retained messages than this may use the reserve.
pub(crate) const KEPT_LITTLE: usize = 256;

/// A key whose retained messages take fewer bytes than this may use the reserve.
pub(crate) const KEPT_LITTLE_BYTES: usize = 1024 * 1024;

/// Maximum number of retained messages of one key: less than half of `KEPT`, so that no key fills it alone.
pub(crate) const KEPT_SHARE: usize = 4096;

/// Maximum size of the retained messages of one key, in bytes.
pub(crate) const KEPT_SHARE_BYTES: usize = 8 * 1024 * 1024;

/// Maximum number of retained messages of the program itself, which has a dozen topics.
pub(crate) const PROGRAM_KEPT: usize = 256;

/// Maximum size of the program's retained messages, in bytes: a large map, a photo, and the messages on the other
/// topics.
pub(crate) const PROGRAM_KEPT_BYTES: usize = 8 * 1024 * 1024;

/// Retained messages examined for one client before other clients get a turn.
pub(crate) const KEPT_STEPS: usize = 512;

/// Maximum number of unacknowledged retained messages of one client, the same as in Mosquitto.
pub(crate) const KEPT_UNDER_WAY: usize = 20;

/// Approximate memory that a message takes in addition to its topic and payload, in bytes.
pub(crate) const MESSAGE_COST: usize = 128;

/// Maximum weight of one message in a subscriber's queue, in bytes. A long message weighs less than its size, because
/// all its readers share one copy.
pub(crate) const HEAVIEST: usize = 16 * 1024;

/// Maximum weight of the messages that wait for one subscriber. This is enough for a subscriber that does not read
/// for a moment. Beyond this the oldest message is lost.
pub(crate) const QUEUE: usize = 256 * 1024;

/// Maximum memory of the messages that wait for one subscriber, in bytes, including memory shared with other
/// subscribers. Beyond this the oldest message longer than `HEAVIEST` is lost.
pub(crate) const QUEUE_BYTES: usize = 2 * 1024 * 1024;

/// Messages wait for a subscriber that is away only while all waiting messages together take at most this many bytes.
/// When they take more, a subscriber that goes away loses its queue.
pub(crate) const AWAY: usize = 8 * 1024 * 1024;

/// Flooding publishers wait for a subscriber while messages of more than this weight wait for it. The limit is only a
/// part of `QUEUE`, because several publishers may send at once. It is large enough that neither side idles.
pub(crate) const LAG: usize = QUEUE / 4;

/// Flooding publishers wait for a subscriber while messages of more than this many bytes wait for it.
pub(crate) const LAG_BYTES: usize = QUEUE_BYTES / 4;

/// After passing on messages of this weight, a client's connection checks whether readers lag behind. It is a part of
/// `LAG`, because other clients may publish at the same time.
pub(crate) const PIECE: usize = LAG / 4;

/// A waiting publisher goes on when messages of at most this weight wait for the subscriber.
pub(crate) const RELIEF: usize = LAG / 2;

/// A waiting publisher goes on when messages of at most this many bytes wait for the subscriber.
pub(crate) const RELIEF_BYTES: usize = LAG_BYTES / 2;

/// Longest wait of a publisher for a subscriber that reads too slowly.
pub(crate) const PATIENCE: Duration = Duration::from_millis(500);

/// Longest wait of a publisher for the first subscriber that does not read. It is short, because an urgent message
/// may follow the messages that the publisher has sent. When several subscribers stop reading, each wait is half as
/// long as the one before.
pub(crate) const STILL: Duration = Duration::from_millis(40);

/// A wait that would be shorter than this is left out.
pub(crate) const STILL_SHORTEST: Duration = Duration::from_millis(1);

/// Time for which no publisher waits for a subscriber that did not catch up during the last wait. It doubles each
/// time.
pub(crate) const FORGIVEN: Duration = Duration::from_secs(10);

/// Upper bound of the doubled `FORGIVEN`.
pub(crate) const FORGIVEN_LONGEST: Duration = Duration::from_secs(640);

/// If this time passes after the end of `FORGIVEN` without another wait in vain for the subscriber, the doubling
/// starts again from the first value.
pub(crate) const MENDED: Duration = Duration::from_secs(60);

/// A message of n bytes counts as 1 + n / `LONG` messages (rounded down) when a flood is recognised.
pub(crate) const LONG: usize = 512;

/// A client that publishes at most this many messages per second is not flooding. It never waits for a subscriber, so
/// its urgent messages are read at once.
pub(crate) const NO_FLOOD: u64 = 256;

/// A payload of at least this many bytes is shared by all its readers. A shorter payload is copied for each reader,
/// which is cheaper.
pub(crate) const SHARED: usize = 1024;

/// No further retained message is sent to a client while at least this many bytes wait for it.
pub(crate) const KEPT_ROOM: usize = 32 * 1024;

/// No further message is sent to a client while at least this many bytes wait for it.
pub const CLIENT_ROOM: usize = 64 * 1024;

/// No more packets of a client are handled while at least this many bytes wait for it. Its urgent messages take
/// effect even then. A client that goes on sending and reads nothing is disconnected.
pub const ANSWER_ROOM: usize = 512 * 1024;

/// A client with this many unacknowledged messages gets no more messages that need an acknowledgement.
pub(crate) const WINDOW: usize = 100;

/// A client whose unacknowledged messages take this many bytes gets no more messages that need an acknowledgement.
pub(crate) const WINDOW_BYTES: usize = 512 * 1024;

/// Maximum number of messages of QoS 2 that a client may leave unreleased. The broker sends this number to clients of
/// MQTT 5 as Receive Maximum.
pub const UNRELEASED: usize = 4096;

/// Number of a client's latest commands with which a new command is compared to recognise a duplicate.
pub(crate) const HANDLED: usize = 256;

/// Longest silence of a client, whatever keep alive it announced.
pub(crate) const SILENCE: Duration = Duration::from_secs(24 * 3600);
