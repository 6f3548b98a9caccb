//! A CoAP server endpoint without resources, sockets and clocks (RFC 7252, 7641, 7959, 7967, 9175). Datagrams go
//! in, and requests come out for an application. The application's answers go in, and datagrams to send come out. The
//! application decides which resource is at which path.
//!
//! ```text
//!   backlog (datagrams that wait)
//!             ▼
//!   handle_datagram ─► message ─► guard ─► exchange ─► options ─► block ─► poll_request ─► the application
//!   poll_transmit   ◄─ message ◄─ guard ◄─ exchange ◄─ reply ◄─ block ◄─ observe ◄─ handle_answer, handle_change
//!                                            reliable ◄─┘ (our messages that need an acknowledgement)
//! ```

#![warn(missing_docs)]

use std::collections::{BTreeMap, VecDeque};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use hashlink::LinkedHashMap;

mod backlog;
mod block;
mod chance;
mod code;
mod exchange;
mod format;
mod guard;
mod inward;
mod knowledge;
mod lenient;
pub mod limits;
mod links;
mod long_answers;
mod message;
mod network;
mod observe;
mod options;
mod outward;
mod queue;
mod reliable;
mod reply;
mod request;
mod response;
mod shares;
mod subject;

pub use backlog::Backlog;
pub use code::{Code, Method};
pub use format::Format;
pub use links::{Link, link_format};
pub use observe::SubjectId;
pub use queue::Datagram;
pub use request::{Conditions, Request};
pub use response::{Answer, ETag, Response};

use self::block::{Assemblies, Block, BodyKey};
use self::chance::{Chance, Purpose};
use self::exchange::Exchanges;
use self::guard::Guard;
use self::inward::ReplyTo;
use self::long_answers::LongAnswers;
use self::observe::Observers;
use self::reliable::Reliable;

/// Identifies a request that waits for the application's answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExchangeId(u64);

/// A datagram to be sent unchanged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transmit {
    /// Address and port of the receiver.
    pub peer: SocketAddr,
    /// The whole UDP payload.
    pub bytes: Vec<u8>,
}

/// A request for a change that was refused before the application saw it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedRequest {
    /// Address of the sender, which is on this machine.
    pub peer: SocketAddr,
    /// The request's method and path, such as `POST /commands/start`.
    pub asked: String,
    /// The reason, without the prefix `refused: ` that the answer has.
    pub words: String,
}

/// Sizes of the endpoint's tables. The limit of each table is in `limits`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Messages stored with their answers: at most twice `EXCHANGES`.
    pub exchanges: usize,
    /// Requests that wait for the application: at most `OPEN`.
    pub open: usize,
    /// Observations: at most `OBSERVERS`.
    pub observers: usize,
    /// Bodies of requests with missing blocks: at most twice `ASSEMBLIES`.
    pub assemblies: usize,
    /// Answers stored for reading in blocks: at most `ASSEMBLIES`.
    pub long_answers: usize,
    /// Our messages that wait for an acknowledgement, or for their turn to be sent.
    pub reliable: usize,
    /// Number of stored addresses of other machines, of networks of other machines, and of peers with a message id
    /// counter. At most `PEERS` of each are stored.
    pub peers: usize,
}

/// A CoAP server endpoint without sockets and clocks. It takes datagrams, answers and the time. It returns
/// requests and datagrams.
pub struct Endpoint {
    guard: Guard,
    exchanges: Exchanges,
    assemblies: Assemblies,
    long_answers: LongAnswers,
    reliable: Reliable,
    observers: Observers,
    open: BTreeMap<ExchangeId, Open>,
    /// Open requests whose senders get an empty acknowledgement if the answer takes too long, in the order of
    /// arrival. Each is stored with the time at which this acknowledgement is due.
    patience: BTreeMap<ExchangeId, Duration>,
    counted: u64,
    ids: LinkedHashMap<SocketAddr, u16>,
    chance: Chance,
    asked: VecDeque<(ExchangeId, Request)>,
    refused: VecDeque<RefusedRequest>,
    is_urgent: fn(&Request) -> bool,
    /// Text in the refusal of an urgent request. It says that the request took effect although it is refused.
    took_effect: &'static str,
    out: VecDeque<Transmit>,
}

#[derive(Debug)]
struct Open {
    reply_to: ReplyTo,
    /// Whether the sender was already told, by an empty acknowledgement, that the answer comes separately.
    is_acknowledged: bool,
    is_get: bool,
    observe: Option<u32>,
    /// The request. Stored only if it asks to observe, because the registration needs it.
    request: Option<Box<Request>>,
    /// The key under which the answer is stored if it does not fit into one message; `None` for a request that only
    /// reads.
    kept_as: Option<Box<BodyKey>>,
    /// The value of `Exchanges::undone` when this request arrived.
    undone: u64,
    etags: Vec<ETag>,
    block1: Option<Block>,
    block2: Option<Block>,
    wants_size: bool,
}

impl Endpoint {
    /// Creates an endpoint. All its random values are derived from this secret: message ids, the spread of
    /// retransmission times, and the Echo values that prove addresses.
    #[must_use]
    pub fn new(secret: [u8; 32]) -> Endpoint {
        let (seed, secret) = secret.split_at(8);
        let seed = seed.iter().fold(0, |seed, byte| (seed << 8) | u64::from(*byte));
        Endpoint {
            guard: Guard::new(secret),
            exchanges: Exchanges::default(),
            assemblies: Assemblies::default(),
            long_answers: LongAnswers::default(),
            reliable: Reliable::new(Chance::new(seed, Purpose::Spread)),
            observers: Observers::default(),
            open: BTreeMap::new(),
            patience: BTreeMap::new(),
            counted: 0,
            ids: LinkedHashMap::new(),
            chance: Chance::new(seed, Purpose::MessageIds),
            asked: VecDeque::new(),
            refused: VecDeque::new(),
            is_urgent: |_| false,
            took_effect: "",
            out: VecDeque::new(),
        }
    }

    /// Sets what the wall clock shows at `Duration::ZERO` of the endpoint's time, as the time since the beginning of
    /// 1970. The numbers of notifications follow the wall clock. So after a restart no observer mistakes a new
    /// notification for an old one (RFC 7641, section 4.4).
    #[must_use]
    pub fn started_at(self, since_1970: Duration) -> Endpoint {
        Endpoint { observers: Observers::new(since_1970), ..self }
    }

    /// Defines urgent requests, which take effect even if they are malformed. `is_urgent` recognises them by the
    /// sender, and by as much of the method, path and payload as can be read. Each urgent request is passed to the
    /// application once. If it is repeated after its effect was undone (`handle_undone`), it is passed on again. An
    /// urgent request that has to be refused is passed on too, but the application's answer is not sent. Its sender
    /// gets the refusal, which begins with `refused: ` and `took_effect`.
    #[must_use]
    pub fn with_urgent(self, is_urgent: fn(&Request) -> bool, took_effect: &'static str) -> Endpoint {
        Endpoint { is_urgent, took_effect, ..self }
    }

    /// Sets the number of events so far that may have undone the effect of urgent requests. Call this before each
    /// datagram. While the number is unchanged, a repeated urgent message gets the same answer as before. After a
    /// change, a repeated urgent message is passed to the application again.
    pub fn handle_undone(&mut self, count: u64) {
        self.exchanges.undone = count;
    }

    /// Takes the application's answer to a request, at once or at any later time.
    pub fn handle_answer(&mut self, exchange: ExchangeId, answer: Answer, now: Duration) {
        self.patience.remove(&exchange);
        if let Some(open) = self.open.remove(&exchange) {
            self.answer(open, answer, now);
        }
    }

    /// Takes the present state of the things that the observers of a subject see. Only changed things are sent.
    pub fn handle_change(&mut self, subject: SubjectId, things: Vec<Arc<Response>>, now: Duration) {
        self.observers.change(subject, things, now);
    }

    /// Sends this last message to all observers, and ends their observations.
    pub fn close(&mut self, farewell: &Response) {
        for (peer, token) in self.observers.clear() {
            self.bid_farewell(peer, token, farewell);
        }
    }

    /// Does the work that is due. Call this at the time that `poll_timeout` returned.
    pub fn handle_timeout(&mut self, now: Duration) {
        self.acknowledge_slow(now);
        self.repeat_late(now);
        self.notify_due(now);
    }

    /// The next request for the application. Pass its answer to `handle_answer`.
    pub fn poll_request(&mut self) -> Option<(ExchangeId, Request)> {
        self.asked.pop_front()
    }

    /// The next request that was refused before the application saw it. The application may record it.
    pub fn poll_refused(&mut self) -> Option<RefusedRequest> {
        self.refused.pop_front()
    }

    /// The next datagram for the network. Send all of them after each call of a `handle_…` function.
    pub fn poll_transmit(&mut self) -> Option<Transmit> {
        self.out.pop_front()
    }

    /// When to call `handle_timeout` next, on the endpoint's time.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        let slow = self.patience.first_key_value().map(|(_, due)| *due);
        [slow, self.reliable.timeout(), self.observers.timeout()].into_iter().flatten().min()
    }

    /// All observed subjects, each with the request of its first observer.
    #[must_use]
    pub fn subjects(&self) -> Vec<(SubjectId, Arc<Request>)> {
        self.observers.subjects()
    }

    /// Number of observations. Unlike `counts`, this does not look through the tables.
    #[must_use]
    pub fn observers(&self) -> usize {
        self.observers.count()
    }

    /// Sizes of the tables. Do not call this for every datagram: it looks through some of the tables.
    #[must_use]
    pub fn counts(&self) -> Counts {
        Counts {
            exchanges: self.exchanges.count(),
            open: self.open.len(),
            observers: self.observers(),
            assemblies: self.assemblies.count(),
            long_answers: self.long_answers.count(),
            reliable: self.reliable.count(),
            peers: self.guard.count() + self.ids.len(),
        }
    }
}

/// Compiles the example in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
