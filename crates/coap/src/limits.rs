//! Every bound and every time of the endpoint, each with its reason. Nothing is decided here.

use std::time::Duration;

/// Largest payload of one message, in bytes: with header and options it fits into one unfragmented packet (RFC 7252,
/// section 4.6).
pub const BLOCK: usize = 1024;

/// Largest size of a message without its payload, in bytes: header, token and the longest options that are sent.
pub const HEAD: usize = 128;

/// Largest body of a request, in bytes, in blocks or whole: a command is a few dozen bytes.
pub const BODY: usize = 16 * 1024;

/// Bodies of requests being put together, and answers being read block by block; the oldest gives way. Peers beyond
/// this machine have as many places of their own.
pub const ASSEMBLIES: usize = 64;

/// How long a message id of a peer stands for the same message (RFC 7252, section 4.8.2).
pub const EXCHANGE_LIFETIME: Duration = Duration::from_secs(247);

/// Messages stored with their answers, of at most some 1.2 kB each; the oldest gives way. Commands from this machine
/// have a table of their own, so that no flood of reads, or of strangers, pushes out their answers.
pub const EXCHANGES: usize = 8192;

/// Requests that wait for the application. Beyond this, the oldest is carried out without an answer.
pub const OPEN: usize = 4096;

/// Time after which an answer comes separately, behind an empty acknowledgement: well before the sender asks again
/// after two seconds.
pub(super) const PATIENCE: Duration = Duration::from_millis(500);

/// Shortest time before a message that needs an acknowledgement is sent again (RFC 7252, section 4.8).
pub const ACK_TIMEOUT: Duration = Duration::from_secs(2);

/// Random extension of `ACK_TIMEOUT`, as a fraction of it, so that peers that lost something together do not repeat it
/// together.
pub(super) const ACK_SPREAD: f64 = 0.5;

/// Retransmissions of a message, each after twice the time of the one before.
pub(super) const MAX_RETRANSMIT: u32 = 4;

/// Separate answers for one peer that wait for the one before to be acknowledged; more are sent without
/// acknowledgement.
pub const WAITING: usize = 32;

/// Peers with an unacknowledged message of ours, twice as many as can observe. Beyond this, late answers are sent
/// without acknowledgement.
pub const RELIABLE_PEERS: usize = 4096;

/// Observations in all: every screen and device of a site.
pub const OBSERVERS: usize = 2048;

/// Number of observations from which on a new observer is soon asked for an acknowledgement, so that observers that are
/// gone are known when places run out.
pub const UNPROVED_OBSERVERS: usize = 256;

/// Time after the first request for an acknowledgement in which one must come. Later, among `UNPROVED_OBSERVERS` or
/// more, an observer that never sent one loses its place when it registers again.
pub const UNPROVED: Duration = Duration::from_secs(5);

/// Observations of one peer: each resource several times over.
pub const OBSERVERS_OF_A_PEER: usize = 64;

/// Observations of peers beyond this machine, a part of `OBSERVERS`.
pub const OBSERVERS_BEYOND: usize = 1024;

/// Observations of one network beyond this machine, so that nobody takes all the places.
pub const OBSERVERS_OF_A_NETWORK: usize = 256;

/// Longest path and query of an observed resource, in bytes, since they are stored for as long as it is observed.
pub(super) const TARGET: usize = 256;

/// Least time between two notifications of one observation: nobody who watches needs more than fifty a second.
pub const PACE: Duration = Duration::from_millis(20);

/// Least time between two notifications of one peer, whatever it observes: message ids have 16 bits and may not come
/// again within `EXCHANGE_LIFETIME`, which leaves 265 a second.
pub(super) const PACE_OF_A_PEER: Duration = Duration::from_millis(5);

/// `PACE` for a peer beyond this machine while its round-trip time is unknown (RFC 7641, section 4.5.1).
pub(super) const PACE_UNKNOWN: Duration = Duration::from_secs(3);

/// How long an observer may read the further blocks of a notification before it is told what changed since: otherwise a
/// slow reader of something that changes all the time would never read anything to its end. An observer that has read
/// it is told at once.
pub(super) const READING: Duration = Duration::from_secs(1);

/// Notifications sent at once; the next follow a millisecond later, so that neither our buffers nor a reader's
/// overflow.
pub(super) const BURST: usize = 32;

/// Time without change after which a thing that was told without acknowledgement is told again with one. It is longer
/// than a second because much changes every second, and an acknowledgement that is lost then delays what comes after
/// it.
pub(super) const SETTLED: Duration = Duration::from_millis(1500);

/// Time after which an unchanged thing is told again with a request for an acknowledgement, before the 60 seconds of
/// Max-Age are over: its observer knows that the state is current, and one that is gone loses its place.
pub(super) const REFRESH: Duration = Duration::from_secs(50);

/// Longest time without a request for an acknowledgement to an observer of something that changes all the time, so that
/// observers that are gone are found. RFC 7641, section 4.5, asks for one a day.
pub(super) const CONFIRM_EVERY: Duration = Duration::from_secs(30);

/// Most bytes sent to an unproved address for each byte that came from it.
pub const AMPLIFICATION: usize = 3;

/// Addresses beyond this machine of which received bytes and proofs are stored; the oldest gives way.
pub const PEERS: usize = 4096;

/// How long an address counts as proved; each acknowledgement from there renews it.
pub(super) const PROVED: Duration = Duration::from_secs(3600);

/// Greatest age of an Echo that proves an address (RFC 9175, section 2.4).
pub(super) const ECHO_AGE: Duration = Duration::from_secs(60);

/// Bytes of commands in the backlog: all of them are handled before an urgent request that came after them, and that
/// must not take long.
pub(super) const COMMANDS_WAITING: usize = 128 * 1024;

/// Bytes of urgent requests in the backlog, so that one of 64 KiB leaves more than it takes to others. When the backlog
/// is full of them, one takes effect all the time, and a further one can be dropped.
pub(super) const URGENT_WAITING: usize = 256 * 1024;

/// Bytes of acknowledgements and resets in the backlog: all observers may acknowledge at once.
pub(super) const SIGNS_WAITING: usize = 1024 * 1024;

/// Bytes of all other datagrams in the backlog.
pub(super) const READS_WAITING: usize = 2 * 1024 * 1024;

/// Approximate memory of a waiting datagram beside its bytes.
pub(super) const WAITING_HEAD: usize = 128;

/// Refusals stored until the application fetches them for the record, which it does after each datagram.
pub const REFUSED: usize = 1024;

/// Requests per second from one network beyond this machine: a photo in the smallest blocks takes half a minute.
pub(super) const RATE: f64 = 200.0;

/// Requests that one network beyond this machine may send in a burst.
pub(super) const RATE_BURST: f64 = 400.0;
