//! Every bound and every time of the endpoint, each with its reason. Nothing is decided here.

use std::time::Duration;

/// The most bytes of a body in one message: with header and options it fits into one unfragmented packet (RFC 7252, section 4.6).
pub const BLOCK: usize = 1024;

/// The most bytes that a message may have beside its payload: header, token and the longest options that are sent.
pub const HEAD: usize = 128;

/// The largest body that is put together from blocks, or taken whole: a command is a few dozen bytes.
pub const BODY: usize = 16 * 1024;

/// Bodies that are being put together at once, and answers that are read on block by block; the oldest gives way. Others than
/// this machine have so many places of their own.
pub const ASSEMBLIES: usize = 64;

/// How long a message id of a peer stands for the same message (RFC 7252, section 4.8.2).
pub const EXCHANGE_LIFETIME: Duration = Duration::from_secs(247);

/// Messages remembered with their answers, at most some 1.2 kB each; the oldest gives way. What this machine asks to be done has
/// a table of its own, so that no flood of reads, or of strangers, drives out what was done.
pub const EXCHANGES: usize = 8192;

/// Requests that wait for the application at once; the answer to the oldest is given up, not what it asked for.
pub const OPEN: usize = 4096;

/// An answer that takes longer than this comes separately, after an empty acknowledgement: well before the sender asks again
/// after two seconds.
pub(super) const PATIENCE: Duration = Duration::from_millis(500);

/// A message that wants an acknowledgement is sent again after this,
pub const ACK_TIMEOUT: Duration = Duration::from_secs(2);

/// or up to half as much longer, by chance, so that not all who lost something repeat it at once,
pub(super) const ACK_SPREAD: f64 = 0.5;

/// then after twice as long, and so on, so many times.
pub(super) const MAX_RETRANSMIT: u32 = 4;

/// Separate answers that wait for the one before to be acknowledged, for one peer; more are sent without.
pub const WAITING: usize = 32;

/// Peers to whom something is on its way that they have not acknowledged, twice as many as can observe; what others are answered
/// late goes out without a wish for an acknowledgement.
pub const RELIABLE_PEERS: usize = 4096;

/// Observations in all: every screen and device of a site.
pub const OBSERVERS: usize = 2048;

/// When there are this many, a new observer is asked for an acknowledgement soon after it has registered, so that those who are not there
/// are known when places run out.
pub const UNPROVED_OBSERVERS: usize = 256;

/// Time after the first wish for an acknowledgement in which one must come: later, among so many, an observer that never sent one
/// loses its place when it registers again.
pub const UNPROVED: Duration = Duration::from_secs(5);

/// Observations of one peer: each resource several times over.
pub const OBSERVERS_OF_A_PEER: usize = 64;

/// Of those so many may be held by others than this machine,
pub const OBSERVERS_BEYOND: usize = 1024;

/// and so many of these from one network, so that nobody takes all the places.
pub const OBSERVERS_OF_A_NETWORK: usize = 256;

/// The most bytes of path and query of something that is observed, which are kept as long as it is.
pub(super) const TARGET: usize = 256;

/// The least time between two notifications of one observation: nobody who watches needs more than fifty a second.
pub const PACE: Duration = Duration::from_millis(20);

/// And between two notifications of one peer, whatever it observes: message ids have 16 bits and may not come again within
/// `EXCHANGE_LIFETIME`, which leaves 265 a second.
pub(super) const PACE_OF_A_PEER: Duration = Duration::from_millis(5);

/// The same as `PACE` for a peer that is not on this machine, as long as nobody knows how far away it is (RFC 7641, section 4.5.1).
pub(super) const PACE_UNKNOWN: Duration = Duration::from_secs(3);

/// So long an observer is left to read on what came to it in several blocks, before it is told what has become of it since: else
/// a slow reader of what changes all the time would never come to an end of anything. Who has read it is told at once.
pub(super) const READING: Duration = Duration::from_secs(1);

/// Notifications that go out at once; the next ones follow a millisecond later, so that neither our buffers nor a reader's
/// overflow.
pub(super) const BURST: usize = 32;

/// When a thing has not changed for so long since it was told without acknowledgement, it is told with one. It is longer than a
/// second because much changes every second, and an acknowledgement that is lost then holds up what comes after it.
pub(super) const SETTLED: Duration = Duration::from_millis(1500);

/// Who observes what does not change is told it again, with a wish for an acknowledgement, before the 60 seconds of Max-Age are
/// over: so it knows that it is not out of date, and who is gone does not keep a place.
pub(super) const REFRESH: Duration = Duration::from_secs(50);

/// While it changes all the time, so often an acknowledgement is asked for all the same, and those who are gone are found out.
/// RFC 7641, section 4.5, asks for one a day.
pub(super) const CONFIRM_EVERY: Duration = Duration::from_secs(30);

/// To an address that has not proved to be the sender's go at most so many times the bytes that came from it.
pub const AMPLIFICATION: usize = 3;

/// Addresses beyond this machine that are remembered with what they sent and whether they are proved; the oldest gives way.
pub const PEERS: usize = 4096;

/// How long a proved address counts as proved.
pub(super) const PROVED: Duration = Duration::from_secs(3600);

/// How old the Echo may be that proves an address (RFC 9175, section 2.4).
pub(super) const ECHO_AGE: Duration = Duration::from_secs(60);

/// When more comes than is answered, so many bytes of commands wait for their turn: all of them are taken before an urgent request
/// that came after them, and that must not take long.
pub(super) const COMMANDS_WAITING: usize = 128 * 1024;

/// And so many bytes of urgent requests, so that one of 64 KiB leaves more than it takes to others: when these are full one takes
/// effect all the time, and a further one is lost.
pub(super) const URGENT_WAITING: usize = 256 * 1024;

/// And so many bytes of acknowledgements and rejections: every observer there may be acknowledges at once.
pub(super) const SIGNS_WAITING: usize = 1024 * 1024;

/// And so many bytes of all else.
pub(super) const READS_WAITING: usize = 2 * 1024 * 1024;

/// So many bytes does a datagram that waits take beside its own, about.
pub(super) const WAITING_HEAD: usize = 128;

/// Refusals that wait until the application takes them for the record, which it does after each datagram.
pub const REFUSED: usize = 1024;

/// Requests a second from one network beyond this machine: a photo in the smallest blocks takes half a minute.
pub(super) const RATE: f64 = 200.0;

/// Requests at once from there.
pub(super) const RATE_BURST: f64 = 400.0;
