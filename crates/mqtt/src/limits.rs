//! Every bound of the gate, each with its reason. Bounds on how many may come in at once are the accept loop's.

use std::time::Duration;

/// The longest CONNECT: names and a will, which is a short message.
pub const CONNECT: usize = 64 * 1024;

/// The longest packet of a client: a photo of a phone, scaled down, fits.
pub const CLIENT_PACKET: usize = 256 * 1024;

/// So many packets of a client are taken before it is looked whether others wait.
pub(crate) const TURN: usize = 64;

/// The longest topic or filter, in bytes.
pub(crate) const TOPIC: usize = 512;

/// The most levels of a topic or filter: they are gone through level by level.
pub(crate) const LEVELS: usize = 32;

/// Topics that a client of MQTT 5 may give a short name (topic alias), and that are given one for it.
pub const ALIASES: u16 = 10;

/// A client that takes no longer packets than this is told nothing in words: no packet with some is longer, in bytes.
pub(crate) const WITH_WORDS: u32 = 1024;

/// The longest keep alive that is granted one who is told so, in seconds: its silence is then no longer than `SILENCE`.
pub const KEEP_ALIVE_S: u16 = 57_600;

/// What a client says of itself (user properties) when it publishes, in bytes, and all else that goes on with a message.
pub(crate) const PROPERTIES: usize = 16 * 1024;

/// Filters held by one connection: Home Assistant makes one for each topic of each of its devices.
pub const FILTERS: usize = 1024;

/// Bytes of all filters held by one connection.
pub(crate) const FILTER_BYTES: usize = 64 * 1024;

/// Filters in one packet, since a packet is answered in one turn. Home Assistant sends up to 500.
pub(crate) const PACKET_FILTERS: usize = 512;

/// Kept messages of all clients,
pub(crate) const KEPT: usize = 10 * 1024;

/// and their bytes, topics included;
pub(crate) const KEPT_BYTES: usize = 32 * 1024 * 1024;

/// so many of the places,
pub(crate) const KEPT_RESERVE: usize = 2048;

/// and of the bytes, are for keys that keep little,
pub(crate) const KEPT_RESERVE_BYTES: usize = 8 * 1024 * 1024;

/// which is less than so much, in messages,
pub(crate) const KEPT_LITTLE: usize = 256;

/// and in bytes;
pub(crate) const KEPT_LITTLE_BYTES: usize = 1024 * 1024;

/// of these one key may have so many,
pub(crate) const KEPT_SHARE: usize = 4096;

/// and so many bytes.
pub(crate) const KEPT_SHARE_BYTES: usize = 8 * 1024 * 1024;

/// Kept messages of the program itself, which has a dozen topics,
pub(crate) const PROGRAM_KEPT: usize = 256;

/// and their bytes: a large map, a photo, and what stands on the other topics.
pub(crate) const PROGRAM_KEPT_BYTES: usize = 8 * 1024 * 1024;

/// Among the kept messages so many places are looked at for one client before it is another one's turn.
pub(crate) const KEPT_STEPS: usize = 512;

/// Kept messages that a client has not acknowledged yet: what mosquitto allows, too.
pub(crate) const KEPT_UNDER_WAY: usize = 20;

/// What a message takes beside its topic and payload, about, in bytes.
pub(crate) const MESSAGE_COST: usize = 128;

/// A long message weighs no more than this while it waits for one of its readers, who all have it in common.
pub(crate) const HEAVIEST: usize = 16 * 1024;

/// So much may wait for one subscriber, by weight: what he gets at once when he has not read for a moment. Of more, the oldest is lost.
pub(crate) const QUEUE: usize = 256 * 1024;

/// And the messages that wait for him take no more than this, whoever else has them: of more, the oldest of those that weigh less than
/// they take is lost.
pub(crate) const QUEUE_BYTES: usize = 2 * 1024 * 1024;

/// For one who is away, or goes, messages wait only while those that wait for anybody take no more than this.
pub(crate) const AWAY: usize = 8 * 1024 * 1024;

/// So much may wait for a subscriber, by weight, before whoever publishes more in a flood is made to wait: a part of the queue, since
/// several may publish at once, and enough that nobody waits for the other;
pub(crate) const LAG: usize = QUEUE / 4;

/// and so many bytes.
pub(crate) const LAG_BYTES: usize = QUEUE_BYTES / 4;

/// So much of a client's is taken before it is looked whether somebody lags: others may publish at the same time.
pub(crate) const PIECE: usize = LAG / 4;

/// It waits until they are no more than this,
pub(crate) const RELIEF: usize = LAG / 2;

/// and no more bytes than this.
pub(crate) const RELIEF_BYTES: usize = LAG_BYTES / 2;

/// So long a publisher waits for a subscriber who reads, though too slowly,
pub(crate) const PATIENCE: Duration = Duration::from_millis(500);

/// and so long for one who does not read: something urgent may stand behind what the publisher has said. When several stop reading one after the
/// other, it waits for each half as long as for the one before,
pub(crate) const STILL: Duration = Duration::from_millis(40);

/// and for none any more when that would be less than this.
pub(crate) const STILL_SHORTEST: Duration = Duration::from_millis(1);

/// A subscriber that could not be waited for is not waited for during so long,
pub(crate) const FORGIVEN: Duration = Duration::from_secs(10);

/// and each time twice as long as the last time, but no longer than this.
pub(crate) const FORGIVEN_LONGEST: Duration = Duration::from_secs(640);

/// After so long without that it counts as the first time again.
pub(crate) const MENDED: Duration = Duration::from_secs(60);

/// A message counts once more in a flood for each of so many bytes in it.
pub(crate) const LONG: usize = 512;

/// So many messages in a second are no flood: whoever publishes no more never waits for anybody, so that what is urgent is read at once.
pub(crate) const NO_FLOOD: u64 = 256;

/// A payload of so many bytes is there once for all to whom it goes; shorter ones are copied for each, which is cheaper.
pub(crate) const SHARED: usize = 1024;

/// No further kept message is put before a client while more than this waits for it,
pub(crate) const KEPT_ROOM: usize = 32 * 1024;

/// and no further message at all while more than this does.
pub const CLIENT_ROOM: usize = 64 * 1024;

/// No more is taken from a client while more than this waits for it. What is urgent is heard all the same; one that goes on sending, and
/// reads none of it, is sent away.
pub const ANSWER_ROOM: usize = 512 * 1024;

/// So many messages a client may leave unacknowledged before no more go out to it that it is to acknowledge,
pub(crate) const WINDOW: usize = 100;

/// and so many bytes of them.
pub(crate) const WINDOW_BYTES: usize = 512 * 1024;

/// Messages of QoS 2 that a client has not released.
pub const UNRELEASED: usize = 4096;

/// Commands by which a duplicate is known.
pub(crate) const HANDLED: usize = 256;

/// The longest silence of a client, whatever it announced.
pub(crate) const SILENCE: Duration = Duration::from_secs(24 * 3600);
