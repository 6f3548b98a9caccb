//! A connection between a client that sends anything, in pieces of any size, and a router that is itself or not. Whatever they do:
//! nothing breaks, and what reaches the router are whole packets of the few kinds that cannot hurt it, on topics and filters that
//! cannot, with acknowledgements of what it waits for in its order. Whether what reaches the client is right is tested elsewhere.
#![no_main]

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use bytes::{Buf, BytesMut};
use libfuzzer_sys::fuzz_target;
use mqtt_gate::limits::{CLIENT_PACKET, CLIENT_ROOM, FILTERS, UNRELEASED};
use mqtt_gate::packet::connect::{self, Connect};
use mqtt_gate::packet::filters::Filters;
use mqtt_gate::packet::{Qos, ack, publish, write};
use mqtt_gate::{
    Broker, ClientConnection, CommandDecision, Ended, Epoch, Frame, Kind, Listener, Principal, Rights, Session, Terms, Tier,
    filter, frame,
};

/// The ids that the router gives, one after the other, and no more at once.
const ROUTER_IDS: u16 = 100;

fuzz_target!(|bytes: &[u8]| {
    let [first, length, bytes @ ..] = bytes else { return };
    let (body, mut rest) = bytes.split_at(usize::from(*length).min(bytes.len()));
    let mut play = Play::new(*first, connect::read(body).ok());
    while let Some(after) = play.step(rest) {
        rest = after;
    }
    play.end(Ended::Gone);
});

/// Hears everything, and forbids what begins with an `f`.
struct TestListener;

impl Listener for TestListener {
    fn epoch(&self) -> Epoch {
        Epoch(0)
    }

    fn hear(&self, topic: &str, payload: &[u8], _: (Option<Epoch>, bool)) -> CommandDecision {
        assert!(topic.starts_with("h/d/command") || topic.starts_with("q/"), "{topic} is no place for commands");
        if payload.first() == Some(&b'f') { CommandDecision::Forbidden } else { CommandDecision::Pass }
    }

    fn hear_urgent(&self, _: &[u8], payload: &[u8]) -> bool {
        payload.first() == Some(&b's')
    }
}

/// As a robot's topics may be: commands on `h/d/command`, on names below it, and on those below `q`; the rest of `h/d` is the program's
/// own, and nobody but the program sees the pulse.
#[derive(Debug)]
struct TestRights;

const PULSE: &str = "broker-pulse";

impl Rights for TestRights {
    fn is_for_commands(&self, topic: &str) -> bool {
        let is_name_below = |above: &str| topic.strip_prefix(above).is_some_and(|name| !name.contains('/'));
        topic == "h/d/command" || is_name_below("h/d/command/") || is_name_below("q/")
    }

    fn may_publish(&self, who: Principal, topic: &str) -> bool {
        let is_own = topic == "h/d" || topic.starts_with("h/d/") || topic == PULSE;
        who == Principal::Program || self.is_for_commands(topic) || who == Principal::Client(Tier::Full) && !is_own
    }

    fn may_subscribe(&self, who: Principal, filter: &str) -> bool {
        who == Principal::Program || filter != PULSE
    }

    fn may_see(&self, who: Principal, topic: &[u8]) -> bool {
        who == Principal::Program || topic != PULSE.as_bytes()
    }
}

struct Play {
    connection: ClientConnection,
    broker: Arc<Broker>,
    /// Reads everything: what nobody reads does not reach the router.
    _reader: ClientConnection,
    now: Duration,
    from_client: BytesMut,
    from_router: BytesMut,
    /// What the router waits for; `None` when it was not itself.
    outstanding: Option<VecDeque<u16>>,
    last_id: u16,
    /// What the router was asked and has not answered.
    answers: BytesMut,
    ended: Option<Ended>,
}

impl Play {
    fn new(first: u8, connect: Option<Connect>) -> Play {
        let principal =
            [Principal::Program, Principal::Client(Tier::Full), Principal::Client(Tier::Limited)][usize::from(first) % 3];
        let broker = Arc::new(Broker::new(TestRights));
        let keep_alive_s = connect.as_ref().map_or(0, |connect| connect.keep_alive_s);
        let will = connect.and_then(|connect| connect.will);
        let terms = Terms {
            principal,
            name: "fuzz".into(),
            has_key: first & 4 != 0,
            listener: Arc::new(TestListener),
            keep_alive_s,
            will,
            session: Session::default(),
        };
        let mut reader = ClientConnection::new(
            Terms {
                principal: Principal::Program,
                name: "reader".into(),
                has_key: false,
                listener: Arc::new(TestListener),
                keep_alive_s: 0,
                will: None,
                session: Session::default(),
            },
            Arc::clone(&broker),
            Duration::ZERO,
        );
        let mut everything = BytesMut::new();
        for n in 0..200_u8 {
            write::publish(
                &mut everything,
                format!("k/{n}").as_bytes(),
                &vec![n; usize::from(first) * 16 + 1],
                Qos::One,
                1,
                true,
            );
        }
        write::subscribe(&mut everything, 1, &[("#", Qos::Zero)]);
        reader.handle_client(&mut everything, Duration::ZERO).expect("it may");
        Play {
            _reader: reader,
            connection: ClientConnection::new(terms, Arc::clone(&broker), Duration::ZERO),
            broker,
            now: Duration::ZERO,
            from_client: BytesMut::new(),
            from_router: BytesMut::new(),
            outstanding: Some(VecDeque::new()),
            last_id: 0,
            answers: BytesMut::new(),
            ended: None,
        }
    }

    /// One step, and what follows it in the input; `None` at its end.
    fn step<'a>(&mut self, input: &'a [u8]) -> Option<&'a [u8]> {
        let [what, how, rest @ ..] = input else { return None };
        let mut rest = rest;
        match what % 8 {
            0..4 => {
                let (piece, after) = rest.split_at(usize::from(*how).min(rest.len()));
                self.from_client.extend_from_slice(piece);
                self.client();
                rest = after;
            }
            4 => {
                let (piece, after) = rest.split_at(usize::from(*how).min(rest.len()));
                self.from_router.extend_from_slice(piece);
                self.outstanding = None;
                self.router();
                rest = after;
            }
            5 => self.message(*how),
            6 => {
                self.from_router.unsplit(self.answers.split());
                self.router();
            }
            _ => self.pass(*how),
        }
        self.look();
        self.ended.is_none().then_some(rest)
    }

    fn client(&mut self) {
        let outcome = self.connection.handle_client(&mut self.from_client, self.now);
        self.ended = outcome.err();
        assert!(self.ended.is_some() || self.from_client.len() < 16 * CLIENT_PACKET, "what is there whole is taken");
    }

    fn router(&mut self) {
        let outcome = self.connection.handle_router(&mut self.from_router);
        let is_itself = self.outstanding.is_some();
        assert!(!is_itself || outcome.is_ok(), "a router that is itself was sent away: {outcome:?}");
        self.ended = outcome.err();
    }

    /// The router sends a message.
    fn message(&mut self, how: u8) {
        let Some(outstanding) = &mut self.outstanding else { return };
        let is_full = outstanding.len() >= usize::from(ROUTER_IDS);
        let qos = if how & 1 == 0 || is_full { Qos::Zero } else { Qos::One };
        if qos == Qos::One {
            self.last_id = self.last_id % ROUTER_IDS + 1;
            outstanding.push_back(self.last_id);
        }
        let topic: &[u8] = if how & 2 == 0 { b"a" } else { b"broker-pulse" };
        write::publish(&mut self.from_router, topic, &[how; 3], qos, self.last_id, false);
        self.router();
    }

    /// Time goes on, and the client takes some of what is for it.
    fn pass(&mut self, how: u8) {
        self.now += Duration::from_secs(u64::from(how));
        self.ended = self.connection.handle_timeout(self.now).err();
        let out = self.connection.to_client();
        let taken = out.len() * usize::from(how % 5) / 4;
        out.advance(taken.min(out.len()));
        self.connection.handle_drained();
    }

    fn end(mut self, why: Ended) {
        self.connection.handle_end(self.ended.unwrap_or(why));
        self.look();
        let session = self.connection.into_session();
        assert!(session.filters().count() <= FILTERS && session.unreleased() <= UNRELEASED);
    }

    /// Looks at everything that reaches the router.
    fn look(&mut self) {
        let out = std::mem::take(self.connection.to_router());
        let mut rest = &out[..];
        while let Some(frame) = frame(rest, usize::MAX).expect("only packets reach the router") {
            let (packet, after) = rest.split_at(frame.length);
            let body = &packet[frame.head..];
            match frame.kind {
                Kind::Publish => {
                    assert!(matches!(packet[0], 0x30 | 0x38), "only QoS 0, padded or not, and nothing to be kept");
                    // The flag of a duplicate marks what is padded.
                    let publish = publish::read(&Frame { flags: frame.flags & 7, ..frame }, packet).expect("it is a PUBLISH");
                    let topic = std::str::from_utf8(publish.topic).expect("topics are UTF-8");
                    assert!(!topic.is_empty() && !topic.contains(['+', '#', '\0']), "{topic:?}");
                    assert_eq!(filter::topic(topic), Ok(()), "{topic:?}");
                }
                Kind::Subscribe | Kind::Unsubscribe => self.asked(frame.kind, body),
                Kind::Puback => {
                    let id = ack::read(body).expect("it is a PUBACK");
                    let expected = self.outstanding.as_mut().map(|outstanding| outstanding.pop_front());
                    assert!(expected.is_none_or(|expected| expected == Some(id)), "{id} is acknowledged, not {expected:?}");
                }
                Kind::Pingreq => self.answers.extend_from_slice(&write::PINGRESP),
                kind => panic!("a {kind:?} reaches the router"),
            }
            rest = after;
        }
        assert!(rest.is_empty(), "only whole packets reach the router");
        assert!(self.connection.to_client().len() < CLIENT_ROOM + 16 * CLIENT_PACKET);
        assert!(!self.broker.is_exhausted());
    }

    /// The router is asked something, and will answer as it does.
    fn asked(&mut self, kind: Kind, body: &[u8]) {
        let is_subscribe = kind == Kind::Subscribe;
        let read = if is_subscribe { Filters::of_subscribe(body) } else { Filters::of_unsubscribe(body) };
        let filters = read.expect("it is a packet of its kind");
        for (name, qos) in filters {
            assert!(filter::filter(name) == Ok(()) && qos < Qos::Two, "{name:?}");
        }
        if is_subscribe {
            write::suback(&mut self.answers, filters.id, &filters.map(|(_, qos)| qos as u8).collect::<Vec<_>>());
        } else {
            filters.for_each(|_| write::ack(&mut self.answers, Kind::Unsuback, filters.id));
        }
    }
}
