//! All limits and times of the endpoint, each with its reason.

use std::time::Duration;

/// Largest payload of one message, in bytes. With header and options it fits into one unfragmented packet (RFC 7252,
/// section 4.6).
pub const BLOCK: usize = 1024;

/// Largest size of a message without its payload, in bytes: header, token and the longest options that this endpoint
/// sends.
pub const HEAD: usize = 128;

/// Largest body of a request, in bytes, sent in blocks or in one message. A command needs only a few dozen bytes.
pub const BODY: usize = 16 * 1024;

/// Maximum number of request bodies that are incomplete. Also the maximum number of answers that are being read block
/// by block. Beyond the limit the oldest is dropped. Bodies from other machines have a separate limit of the same
/// size.
pub const ASSEMBLIES: usize = 64;

/// Time in which a peer uses a message id for a single message (RFC 7252, section 4.8.2).
pub const EXCHANGE_LIFETIME: Duration = Duration::from_secs(247);

/// Maximum number of messages stored with their answers, each of some 1.2 kB at most. Beyond the limit, the sender
/// with the most messages loses its oldest one. Commands from this machine have a table of their own, so that a flood
/// of reads, or of messages from other machines, cannot push out their answers.
pub const EXCHANGES: usize = 8192;

/// Maximum number of requests that wait for the application's answer. Beyond the limit the oldest request is still
/// carried out, but gets no answer.
pub const OPEN: usize = 4096;

/// When an answer takes longer than this, an empty acknowledgement is sent and the answer follows separately. The
/// limit is well below two seconds, after which the sender would repeat the request.
pub(super) const PATIENCE: Duration = Duration::from_millis(500);

/// Shortest time before a message that needs an acknowledgement is sent again (RFC 7252, section 4.8).
pub const ACK_TIMEOUT: Duration = Duration::from_secs(2);

/// Random extension of `ACK_TIMEOUT`, as a fraction of it. Without it, messages that were lost at the same time would
/// be repeated at the same time.
pub(super) const ACK_SPREAD: f64 = 0.5;

/// Maximum number of retransmissions of a message. The wait doubles before each of them.
pub(super) const MAX_RETRANSMIT: u32 = 4;

/// Maximum number of separate answers for one peer that wait until an earlier message to it is acknowledged. Further
/// answers are sent at once, without asking for an acknowledgement.
pub const WAITING: usize = 32;

/// Maximum number of peers with an unacknowledged message of ours: twice `OBSERVERS`. Beyond the limit, separate
/// answers are sent without asking for an acknowledgement.
pub const RELIABLE_PEERS: usize = 4096;

/// Maximum number of observations: enough for every screen and device of a site.
pub const OBSERVERS: usize = 2048;

/// From this number of observations on, a new observer is soon asked for an acknowledgement. So observers that have
/// disappeared are noticed before the table is full.
pub const UNPROVED_OBSERVERS: usize = 256;

/// Time in which an observer must answer its first request for an acknowledgement. While there are
/// `UNPROVED_OBSERVERS` or more observations, an observer that has not answered in this time loses its place when it
/// registers again.
pub const UNPROVED: Duration = Duration::from_secs(5);

/// Maximum number of observations of one peer: enough to observe each resource several times.
pub const OBSERVERS_OF_A_PEER: usize = 64;

/// Maximum number of observations from other machines. They count towards `OBSERVERS` too.
pub const OBSERVERS_BEYOND: usize = 1024;

/// Maximum number of observations from one network of other machines, so that no network takes all the places.
pub const OBSERVERS_OF_A_NETWORK: usize = 256;

/// Maximum length of the path and query of an observed resource together, in bytes. They are stored during the
/// observation.
pub(super) const TARGET: usize = 256;

/// Least time between two notifications of one observation: no observer needs more than fifty a second.
pub const PACE: Duration = Duration::from_millis(20);

/// Least time between two notifications to one peer, whatever it observes. Message ids have 16 bits and may not be
/// repeated within `EXCHANGE_LIFETIME`, which allows 265 messages a second.
pub(super) const PACE_OF_A_PEER: Duration = Duration::from_millis(5);

/// Replaces `PACE` for a peer on another machine while its round-trip time is unknown (RFC 7641, section 4.5.1).
pub(super) const PACE_UNKNOWN: Duration = Duration::from_secs(3);

/// Time for an observer to read the further blocks of a notification before it gets the next one. Otherwise a slow
/// reader would never read all blocks of a thing that changes all the time. An observer that has read all blocks does
/// not wait.
pub(super) const READING: Duration = Duration::from_secs(1);

/// Maximum number of notifications sent at once. The next group follows a millisecond later, so that no buffer
/// overflows on either side.
pub(super) const BURST: usize = 32;

/// A thing that was sent without asking for an acknowledgement is sent again with such a request, once it has not
/// changed for this time. The time is longer than a second, because many things change every second. If the
/// acknowledgement were lost, the next change would be delayed.
pub(super) const SETTLED: Duration = Duration::from_millis(1500);

/// When a thing has not changed for this time, it is sent again with a request for an acknowledgement. This happens
/// before the 60 seconds of Max-Age are over. So the observer knows that its state is current, and an observer that
/// is gone loses its place.
pub(super) const REFRESH: Duration = Duration::from_secs(50);

/// Longest time between two requests for an acknowledgement to one observer, even while things change all the time.
/// Observers that are gone are found in this way. RFC 7641, section 4.5, requires at least one request a day.
pub(super) const CONFIRM_EVERY: Duration = Duration::from_secs(30);

/// Maximum number of bytes sent to an unproved address for each byte that came from it.
pub const AMPLIFICATION: usize = 3;

/// Maximum number of addresses of other machines whose received bytes and proofs are stored. Beyond the limit, the
/// address that has sent nothing for longest is forgotten.
pub const PEERS: usize = 4096;

/// How long an address counts as proved. Each acknowledgement from the address renews this time.
pub(super) const PROVED: Duration = Duration::from_secs(3600);

/// Maximum age of an Echo value that proves an address (RFC 9175, section 2.4).
pub(super) const ECHO_AGE: Duration = Duration::from_secs(60);

/// Maximum size of the commands in the backlog, in bytes. Commands are handled before an urgent request that came
/// after them, so they must not take long.
pub(super) const COMMANDS_WAITING: usize = 128 * 1024;

/// Maximum size of the urgent requests in the backlog, in bytes. A request of 64 KiB leaves most of this room free.
/// When the room is full, further urgent requests are dropped, because the requests that wait take effect one after
/// the other.
pub(super) const URGENT_WAITING: usize = 256 * 1024;

/// Maximum size of the acknowledgements and resets in the backlog, in bytes: all observers may acknowledge at once.
pub(super) const SIGNS_WAITING: usize = 1024 * 1024;

/// Maximum size of all other datagrams in the backlog, in bytes.
pub(super) const READS_WAITING: usize = 2 * 1024 * 1024;

/// Approximate memory of a waiting datagram in addition to its bytes.
pub(super) const WAITING_HEAD: usize = 128;

/// Maximum number of refusals stored until the application fetches them for the record. It fetches them after each
/// datagram.
pub const REFUSED: usize = 1024;

/// Maximum number of requests per second from one network of other machines. At this rate a photo in the smallest
/// blocks takes half a minute.
pub(super) const RATE: f64 = 200.0;

/// Maximum number of requests that one network of other machines may send in a burst.
pub(super) const RATE_BURST: f64 = 400.0;
