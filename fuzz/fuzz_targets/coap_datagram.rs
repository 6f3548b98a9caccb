//! A CoAP endpoint, an application that answers in every possible way, at once or late, and two peers that send
//! anything at any time: one on this machine, one remote. The properties: nothing panics; every datagram sent is a
//! valid message of bounded length; an unproved address gets at most three times the bytes that it sent; the
//! endpoint's state stays bounded; a STOP from this machine is handed over once, and once more after its effect was
//! undone, whatever else is wrong with it; a STOP from elsewhere is never handed over (safety S1, S8).
//! Other tests check whether the answers are right.
#![no_main]

use std::collections::HashMap;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use coap_endpoint::limits::{AMPLIFICATION, ASSEMBLIES, BLOCK, EXCHANGE_LIFETIME, HEAD, OBSERVERS_OF_A_PEER, WAITING};
use coap_endpoint::{Answer, Code, ETag, Endpoint, ExchangeId, Format, Request, Response};
use coap_lite::{CoapOption, Packet};
use libfuzzer_sys::fuzz_target;

/// Number of peers, the remote peer, whose traffic is counted, and the local peer.
const PEERS: usize = 2;
const BEYOND: usize = 1;
const HERE: usize = 0;

const STOP: &str = "stop";

/// Option Echo, with which a peer proves its address (RFC 9175).
const ECHO: u16 = 252;

/// Maximum number of steps, so that one input does not take long.
const STEPS: usize = 512;

/// Maximum number of timeouts handled within one step; more would mean an endless loop.
const TURNS: usize = 100_000;

fuzz_target!(|bytes: &[u8]| {
    let mut play = Play::new();
    let mut rest = bytes;
    for _ in 0..STEPS {
        let Some(after) = play.step(rest) else { break };
        rest = after;
    }
    // After three hours, no message waits for an acknowledgement any more.
    play.pass(Duration::from_secs(3 * 3600));
    assert_eq!(play.endpoint.counts().reliable, 0, "whoever never answers is given up");
});

struct Play {
    endpoint: Endpoint,
    now: Duration,
    /// Requests that the application has not answered yet.
    waiting: Vec<ExchangeId>,
    /// Kind of the answer that each new request gets at once; `None` if requests wait.
    at_once: Option<u8>,
    /// Counter that stands for the state of the application.
    state: u8,
    /// Bytes received from and sent to the remote peer, until it may have proved its address.
    received: usize,
    sent: usize,
    may_be_proved: bool,
    /// Latest Echo value sent to each peer.
    echoes: [Vec<u8>; PEERS],
    /// STOPs from this machine since the last undoing, with the time when each was first received.
    stops: HashMap<Vec<u8>, Duration>,
    undone: u64,
    /// Number of STOPs handed over to the application.
    pressed: usize,
}

impl Play {
    fn new() -> Play {
        Play {
            endpoint: Endpoint::new([7; 32])
                .started_at(Duration::from_secs(1_770_000_000))
                .with_urgent(is_urgent, "it took effect all the same"),
            now: Duration::from_secs(1000),
            waiting: Vec::new(),
            at_once: Some(0),
            state: 0,
            received: 0,
            sent: 0,
            may_be_proved: false,
            echoes: Default::default(),
            stops: HashMap::new(),
            undone: 0,
            pressed: 0,
        }
    }

    /// Executes one step; returns the rest of the input, or `None` at its end.
    fn step<'a>(&mut self, input: &'a [u8]) -> Option<&'a [u8]> {
        let [what, how, rest @ ..] = input else { return None };
        match what % 8 {
            0..3 => {
                let (datagram, rest) = datagram(*how, rest)?;
                self.receive(usize::from(what % 8 == 2), datagram);
                return Some(rest);
            }
            3 => self.pass(Duration::from_millis(1 << (how % 20))),
            4 if how & 0x80 > 0 => self.undo(),
            4 => self.answer_late(*how),
            5 => self.change(*how),
            6 => self.at_once = (how & 0x80 == 0).then_some(*how),
            _ => self.echo(usize::from(how % 2)),
        }
        self.settle();
        Some(rest)
    }

    fn receive(&mut self, peer: usize, datagram: &[u8]) {
        if peer == BEYOND {
            self.received += datagram.len();
            let echo =
                Packet::from_bytes(datagram).ok().and_then(|packet| packet.get_first_option(CoapOption::from(ECHO)).cloned());
            self.may_be_proved |= echo.is_some_and(|echo| echo == self.echoes[BEYOND]);
        }
        let is_new = self.stops.get(datagram).is_none_or(|since| self.now > *since + EXCHANGE_LIFETIME);
        let is_press = peer != BEYOND && is_new && names_stop(datagram);
        if is_press {
            self.stops.insert(datagram.to_vec(), self.now);
        }
        let before = self.pressed;
        self.endpoint.handle_datagram(address(peer), datagram, self.now);
        self.settle();
        let pressed = self.pressed - before;
        assert!(pressed <= 1, "one press is one STOP");
        // A STOP may also be handed over from a path that only a lenient parser finds. A request for a later block of
        // an answer is not a press.
        assert!(pressed == 1 || !is_press, "{datagram:?} must halt");
        assert!(pressed == 0 || may_stop(peer, datagram), "{datagram:?} must not halt");
    }

    /// A peer returns the Echo value that it received, in a request to observe.
    fn echo(&mut self, peer: usize) {
        let mut packet = Packet::new();
        packet.header.message_id = u16::from(self.state) << 8 | 0x55;
        packet.header.code = coap_lite::MessageClass::from(1);
        packet.add_option(CoapOption::Observe, Vec::new());
        packet.add_option(CoapOption::UriPath, b"state".to_vec());
        packet.add_option(CoapOption::from(ECHO), self.echoes[peer].clone());
        self.receive(peer, &packet.to_bytes().expect("it is short"));
    }

    /// Advances the time and handles each timeout when it is due.
    fn pass(&mut self, time: Duration) {
        let until = self.now + time;
        for turn in 0.. {
            let Some(due) = self.endpoint.poll_timeout().filter(|due| *due <= until) else { break };
            assert!(turn < TURNS, "it is never done: due at {due:?}, now {:?}", self.now);
            self.now = self.now.max(due);
            self.endpoint.handle_timeout(self.now);
            assert!(self.endpoint.poll_timeout().is_none_or(|next| next > self.now), "what was due is done");
            self.settle();
        }
        self.now = until;
    }

    /// Undoes the effect of all STOPs, so that each of them counts as new when it comes again.
    fn undo(&mut self) {
        self.undone += 1;
        self.endpoint.handle_undone(self.undone);
        self.stops.clear();
    }

    fn answer_late(&mut self, how: u8) {
        if !self.waiting.is_empty() {
            let exchange = self.waiting.remove(usize::from(how >> 3) % self.waiting.len());
            self.endpoint.handle_answer(exchange, answer(how, self.state), self.now);
        }
    }

    /// Changes the state, and with it the way in which observers are notified.
    fn change(&mut self, how: u8) {
        self.state = self.state.wrapping_add(1);
        for (subject, _) in self.endpoint.subjects() {
            self.endpoint.handle_change(subject, answer(how, self.state).observed, self.now);
        }
        // The endpoint may be polled between a change and its notifications.
        let _ = self.endpoint.poll_timeout();
    }

    /// Answers the requests that are to be answered at once, and checks every datagram sent.
    fn settle(&mut self) {
        while let Some((exchange, request)) = self.endpoint.poll_request() {
            self.pressed += usize::from(is_urgent(&request));
            assert!(request.payload.len() <= 16 * 1024, "no body is larger than a command may be");
            match self.at_once {
                Some(how) => self.endpoint.handle_answer(exchange, answer(how, self.state), self.now),
                None => self.waiting.push(exchange),
            }
        }
        while let Some(transmit) = self.endpoint.poll_transmit() {
            self.look(transmit.peer, &transmit.bytes);
        }
        self.check_bounds();
    }

    fn look(&mut self, to: SocketAddr, datagram: &[u8]) {
        assert!(datagram.len() <= BLOCK + HEAD, "{} bytes are too many", datagram.len());
        let packet = Packet::from_bytes(datagram).expect("what goes out is a message");
        let peer = (0..PEERS).find(|peer| address(*peer) == to).expect("nobody is sent anything who sent nothing");
        if let Some(echo) = packet.get_first_option(CoapOption::from(ECHO)) {
            self.echoes[peer].clone_from(echo);
        }
        if peer == BEYOND && !self.may_be_proved {
            self.sent += datagram.len();
            let most = AMPLIFICATION * self.received;
            assert!(self.sent <= most, "{} bytes went out for {} that came in", self.sent, self.received);
        }
    }

    /// `STEPS` bounds the tables that grow with the requests; the limits for two peers bound the others.
    fn check_bounds(&self) {
        let counts = self.endpoint.counts();
        assert!(counts.open <= STEPS && counts.exchanges <= STEPS, "{counts:?}");
        assert!(counts.observers <= PEERS * OBSERVERS_OF_A_PEER, "{counts:?}");
        assert!(counts.assemblies <= ASSEMBLIES && counts.reliable <= PEERS * (WAITING + 1), "{counts:?}");
        assert!(counts.peers <= PEERS + 2, "two that were given ids, and one beyond with its network: {counts:?}");
    }
}

/// Whether the application treats a request as a STOP.
fn is_urgent(request: &Request) -> bool {
    request.path == [STOP] && request.peer == address(HERE) && !request.method.is_safe()
}

/// Whether the codec can parse the datagram as a STOP that does not continue a block-wise answer.
fn names_stop(datagram: &[u8]) -> bool {
    let Ok(packet) = Packet::from_bytes(datagram) else { return false };
    let path = packet.get_option(CoapOption::UriPath);
    let is_named = path.is_some_and(|path| path.len() == 1 && path.front().is_some_and(|word| word == STOP.as_bytes()));
    is_named && packet.get_option(CoapOption::Block2).is_none() && may_stop(HERE, datagram)
}

/// Whether a datagram may cause a STOP at all.
fn may_stop(peer: usize, datagram: &[u8]) -> bool {
    let [first, code, ..] = datagram else { return false };
    let is_request = first >> 6 == 1 && first >> 4 & 3 <= 1 && *code < 32;
    peer == HERE && is_request && *code != 1 && *code != 5
}

/// Takes the next datagram from the input; its length is in the next bytes, limited to the rest.
fn datagram(high: u8, rest: &[u8]) -> Option<(&[u8], &[u8])> {
    let (low, rest) = rest.split_first()?;
    let length = (usize::from(high % 8) << 8 | usize::from(*low)).min(rest.len());
    Some(rest.split_at(length))
}

fn address(peer: usize) -> SocketAddr {
    SocketAddr::from(if peer == BEYOND { ([192, 0, 2, 7], 5683) } else { ([127, 0, 0, 1], 40_000) })
}

/// Answer of one of eight kinds.
fn answer(how: u8, state: u8) -> Answer {
    let body = |length: usize| vec![state; length];
    let tagged = |length| Response { tag: ETag::new(&[b't', state]), ..Response::content(Format::JSON, body(length)) };
    match how % 8 {
        0 => Answer::observable(tagged(usize::from(how))),
        1 => Answer::observable(tagged(100_000)),
        2 => Answer::once(Response::refusal(Code::NOT_FOUND, "there is no such piece of luggage".to_owned())),
        3 => {
            let location = vec!["luggage".to_owned(), state.to_string()];
            Answer::once(Response { location, location_query: vec!["a=b".to_owned()], ..Response::new(Code::CREATED) })
        }
        4 => {
            let things: Vec<Arc<Response>> = [3, 1500, 40].map(|length| Arc::new(tagged(length))).into();
            Answer { response: Arc::clone(&things[0]), observed: things }
        }
        5 => Answer::observable(Response { max_age: Some(0), ..Response::content(Format::TEXT, body(0)) }),
        6 => Answer::observable(tagged(BLOCK + usize::from(how >> 3))),
        _ => Answer::observable(Response::refusal(Code::NOT_FOUND, "it is gone".to_owned())),
    }
}
