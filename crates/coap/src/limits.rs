//! Every limit and every time of the endpoint, each with its reason. Nothing is decided here.

use std::time::Duration;

/// Largest payload of one message, in bytes. With header and options it fits into one unfragmented packet (RFC 7252,
/// section 4.6).
pub const BLOCK: usize = 1024;

/// Largest size of a message without its payload, in bytes: header, token and the longest options that are sent.
pub const HEAD: usize = 128;

/// Largest body of a request, in bytes, in blocks or in one message: a command has a few dozen bytes.
pub const BODY: usize = 16 * 1024;

/// Bodies of requests that are being put together, and answers that are being read block by block. The oldest gives
/// way. Bodies from beyond this machine have separate room for as many.
pub const ASSEMBLIES: usize = 64;

/// How long a message id of a peer stands for the same message (RFC 7252, section 4.8.2).
pub const EXCHANGE_LIFETIME: Duration = Duration::from_secs(247);

/// Messages stored with their answers, of at most some 1.2 kB each. The oldest gives way. Commands from this machine
/// have a table of their own, so that no flood of reads, or of other machines, pushes out their answers.
pub const EXCHANGES: usize = 8192;

/// Requests that wait for the application. Beyond this limit the oldest request is carried out without an answer.
pub const OPEN: usize = 4096;

/// Time after which an empty acknowledgement is sent and the answer follows separately: well before the sender repeats
/// the request after two seconds.
pub(super) const PATIENCE: Duration = Duration::from_millis(500);

/// Shortest time before a message that needs an acknowledgement is sent again (RFC 7252, section 4.8).
pub const ACK_TIMEOUT: Duration = Duration::from_secs(2);

/// Random extension of `ACK_TIMEOUT`, as a fraction of it, so that peers that lost messages at the same time do not
/// repeat them at the same time.
pub(super) const ACK_SPREAD: f64 = 0.5;

/// Retransmissions of a message. The time before each is twice as long as the one before.
pub(super) const MAX_RETRANSMIT: u32 = 4;

/// Separate answers for one peer that wait until the answer before them is acknowledged. Further answers are sent
/// without acknowledgement.
pub const WAITING: usize = 32;

/// Peers with an unacknowledged message of ours: twice `OBSERVERS`. Beyond this limit late answers are sent without
/// acknowledgement.
pub const RELIABLE_PEERS: usize = 4096;

/// Observations in all: every screen and device of a site.
pub const OBSERVERS: usize = 2048;

/// With this many observations, a new observer is soon asked for an acknowledgement, so that observers that are gone
/// are known when there is no more room.
pub const UNPROVED_OBSERVERS: usize = 256;

/// Time in which an observer must answer its first request for an acknowledgement. With `UNPROVED_OBSERVERS` or more,
/// an observer that has not done so loses its place when it registers again.
pub const UNPROVED: Duration = Duration::from_secs(5);

/// Observations of one peer, enough for each resource several times over.
pub const OBSERVERS_OF_A_PEER: usize = 64;

/// Observations of peers beyond this machine, a part of `OBSERVERS`.
pub const OBSERVERS_BEYOND: usize = 1024;

/// Observations of one network beyond this machine, so that no network takes all the places.
pub const OBSERVERS_OF_A_NETWORK: usize = 256;

/// Longest path and query of an observed resource, in bytes, since they are stored while it is observed.
pub(super) const TARGET: usize = 256;

/// Least time between two notifications of one observation: no observer needs more than fifty a second.
pub const PACE: Duration = Duration::from_millis(20);

/// Least time between two notifications to one peer, whatever it observes. Message ids have 16 bits and may not be
/// repeated within `EXCHANGE_LIFETIME`, which allows 265 messages a second.
pub(super) const PACE_OF_A_PEER: Duration = Duration::from_millis(5);

/// `PACE` for a peer beyond this machine while its round-trip time is unknown (RFC 7641, section 4.5.1).
pub(super) const PACE_UNKNOWN: Duration = Duration::from_secs(3);

/// Time in which an observer may read the further blocks of a notification before it is told of later changes.
/// Otherwise a slow reader would never read all blocks of a thing that changes all the time. An observer that has read
/// all blocks is told at once.
pub(super) const READING: Duration = Duration::from_secs(1);

/// Notifications sent at once. The next group follows a millisecond later, so that no buffer overflows on either side.
pub(super) const BURST: usize = 32;

/// Time without change after which a thing that was told without acknowledgement is told again with one. Many things
/// change every second, and a lost acknowledgement would then delay the news after it. So this time is longer than a
/// second.
pub(super) const SETTLED: Duration = Duration::from_millis(1500);

/// Time after which an unchanged thing is told again with a request for an acknowledgement, before the 60 seconds of
/// Max-Age are over. So the observer knows that the state is current, and an observer that is gone loses its place.
pub(super) const REFRESH: Duration = Duration::from_secs(50);

/// Longest time without a request for an acknowledgement to an observer of a thing that changes all the time, so that
/// observers that are gone are found. RFC 7641, section 4.5, asks for at least one request a day.
pub(super) const CONFIRM_EVERY: Duration = Duration::from_secs(30);

/// Most bytes sent to an unproved address for each byte that came from it.
pub const AMPLIFICATION: usize = 3;

/// Addresses beyond this machine whose received bytes and proofs are stored. The oldest gives way.
pub const PEERS: usize = 4096;

/// How long an address counts as proved. Each acknowledgement from the address renews this time.
pub(super) const PROVED: Duration = Duration::from_secs(3600);

/// Greatest age of an Echo that proves an address (RFC 9175, section 2.4).
pub(super) const ECHO_AGE: Duration = Duration::from_secs(60);

/// Size of the commands in the backlog, in bytes. All of them are handled before an urgent request that came after
/// them, so they must not take long.
pub(super) const COMMANDS_WAITING: usize = 128 * 1024;

/// Size of the urgent requests in the backlog, in bytes: a request of 64 KiB leaves more room to others than it takes.
/// When the backlog is full of urgent requests, they take effect one after the other, so a further one can be dropped.
pub(super) const URGENT_WAITING: usize = 256 * 1024;

/// Size of the acknowledgements and resets in the backlog, in bytes: all observers may acknowledge at once.
pub(super) const SIGNS_WAITING: usize = 1024 * 1024;

/// Size of all other datagrams in the backlog, in bytes.
pub(super) const READS_WAITING: usize = 2 * 1024 * 1024;

/// Approximate memory of a waiting datagram in addition to its bytes.
pub(super) const WAITING_HEAD: usize = 128;

/// Refusals stored until the application fetches them for the record, which it does after each datagram.
pub const REFUSED: usize = 1024;

/// Requests per second from one network beyond this machine. At this rate a photo in the smallest blocks takes half a
/// minute.
pub(super) const RATE: f64 = 200.0;

/// Requests that one network beyond this machine may send in a burst.
pub(super) const RATE_BURST: f64 = 400.0;
