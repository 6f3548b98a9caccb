//! Every bound of the gate, each with its reason. Bounds on how many may come in at once are the accept loop's.

use std::time::Duration;

/// The longest CONNECT: names and a will, which is a short message.
pub const CONNECT: usize = 64 * 1024;

/// The longest packet of a client: a photo of a phone, scaled down, fits.
pub const CLIENT_PACKET: usize = 256 * 1024;

/// The longest packet of the program itself, which publishes maps and photos. The router must accept as much.
pub const PROGRAM_PACKET: usize = 2 * 1024 * 1024;

/// So many packets of a client are taken before it is looked whether others wait.
pub(crate) const TURN: usize = 64;

/// The longest topic or filter, in bytes: the router keeps every one that it ever saw.
pub(crate) const TOPIC: usize = 512;

/// The most levels of a topic or filter: the router compares them level by level, for every message.
pub(crate) const LEVELS: usize = 32;

/// Filters held by one connection.
pub const FILTERS: usize = 64;

/// Filters in one packet: more than a connection may hold, so that each is answered, and few enough to be read at once.
pub(crate) const PACKET_FILTERS: usize = 256;

/// Filters of clients that ever reached a router, which keeps a log for each until it ends.
pub const ROUTER_FILTERS: usize = 4096;

/// Of these, those that clients of the limited tier may spend,
pub(crate) const LIMITED_FILTERS: usize = ROUTER_FILTERS / 2;

/// and those of one key of the full tier.
pub(crate) const SHARE_FILTERS: usize = 2048;

/// Topics of clients that ever reached a router, which remembers what each matched until it ends. What nobody reads does not reach it.
pub(crate) const ROUTER_TOPICS: usize = 64 * 1024;

/// Of these, those that clients of the limited tier may spend,
pub(crate) const LIMITED_TOPICS: usize = 8 * 1024;

/// and those of one key of the full tier.
pub(crate) const SHARE_TOPICS: usize = 16 * 1024;

/// A key of the limited tier has so small a part of one of the full tier.
pub(crate) const LIMITED_SHARE: usize = 16;

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

/// What a kept message costs beside its topic and payload, about.
pub(crate) const KEPT_COST: usize = 128;

/// Among the kept messages so many places are looked at for one client before it is another one's turn.
pub(crate) const KEPT_STEPS: usize = 512;

/// Kept messages of QoS 1 that a client has not acknowledged yet: what mosquitto allows, too.
pub(crate) const KEPT_UNDER_WAY: usize = 20;

/// The router keeps messages for each filter in segments of this size, in bytes. Small ones: what is in them is given back only with
/// the whole of it, and a message of a few bytes costs many times what it counts.
pub const SEGMENT_BYTES: usize = 56 * 1024;

/// It keeps so many segments for each filter. Few ones: for each it takes room for 1,024 messages, which is 225 KiB, however few come.
pub const SEGMENTS: usize = 3;

/// A long message counts no more than this.
pub(crate) const HEAVIEST: usize = 16 * 1024;

/// A message that counts less is padded on its way through the router: what it holds of each beside its bytes is more than this.
pub(crate) const PADDED: usize = 96;

/// A subscriber that is no further behind than this has lost nothing,
pub(crate) const ROUTER_KEEPS: i64 = ((SEGMENTS - 1) * SEGMENT_BYTES) as i64;

/// and nobody has more than this before him.
pub(crate) const ROUTER_HOLDS: i64 = (SEGMENTS * SEGMENT_BYTES) as i64;

/// So many bytes may be on their way to a subscriber before whoever publishes more is made to wait: a part of what the router keeps,
/// since several may publish at once, and enough that nobody waits for the other.
pub(crate) const LAG: i64 = ROUTER_KEEPS / 4;

/// So much of a client's may go to the router before it is looked whether somebody lags: others may publish at the same time.
pub(crate) const PIECE: i64 = LAG / 4;

/// It waits until they are no more than this.
pub(crate) const RELIEF: i64 = LAG / 2;

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

/// When nothing has come from the router for so long, nothing will: whatever else was published is lost.
pub(crate) const QUIET: Duration = Duration::from_millis(500);

/// A message counts once more in a flood for each of so many bytes in it.
pub(crate) const LONG: usize = 512;

/// So many messages in a second are no flood: whoever publishes no more never waits for anybody, so that what is urgent is read at once.
pub(crate) const NO_FLOOD: u64 = 256;

/// The ids of kept messages: above the router's, which are 1 to 100.
pub(crate) const KEPT_IDS: std::ops::RangeInclusive<u16> = 1001..=2000;

/// A payload of so many bytes is there once for all who wait for it; the router keeps a batch of shorter ones for each.
pub(crate) const SHARED: usize = 1024;

/// So many bytes of long messages are on their way to one reader,
pub(crate) const PARCELS_BYTES: usize = 1024 * 1024;

/// and to one who is away only while no more than this waits for anybody.
pub(crate) const PARCELS_AWAY: usize = 4 * 1024 * 1024;

/// No further kept message is put before a client while more than this waits for it,
pub(crate) const KEPT_ROOM: usize = 32 * 1024;

/// and nothing more is read from the router for it while more than this does.
pub const CLIENT_ROOM: usize = 256 * 1024;

/// No more is taken from a client while more than this waits for it. What is urgent is heard all the same; one that goes on sending, and
/// reads none of it, is sent away.
pub const ANSWER_ROOM: usize = 512 * 1024;

/// No more is taken from a client while more than this waits for the router.
pub(crate) const ROUTER_ROOM: usize = 128 * 1024;

/// So many messages the router sends to a client before it waits for an acknowledgement;
pub(crate) const ROUTER_WINDOW: usize = 100;

/// beyond twice that it is not itself.
pub(crate) const OUTSTANDING: usize = 2 * ROUTER_WINDOW;

/// No more is taken from a client while the router has not answered for so many filters that it subscribed to or let go of, each time
/// counted. The router writes an answer for each that is let go, and keeps the room that its answers ever took at once, a few hundred
/// bytes for each, as long as the connection lasts. As many as a connection may hold, twice: nobody waits who asks for all his filters.
pub(crate) const ASKED: usize = 2 * FILTERS;

/// Messages of QoS 2 that a client has not released.
pub const UNRELEASED: usize = 4096;

/// Commands by which a duplicate is known.
pub(crate) const HANDLED: usize = 256;

/// The longest silence of a client, whatever it announced. The router's own patience must be longer.
pub(crate) const SILENCE: Duration = Duration::from_secs(24 * 3600);
