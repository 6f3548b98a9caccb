//! A turnstile between a client that sends anything, in pieces of any size, and an engine that is itself or not. Whatever they do:
//! nothing breaks, and what reaches the engine are whole packets of the few kinds that cannot hurt it, on topics and filters that
//! cannot, with acknowledgements of what it waits for in its order. Whether what reaches the client is right is tested elsewhere.
#![no_main]

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use bytes::{Buf, BytesMut};
use hallsweep_fuzz::access::Role;
use hallsweep_fuzz::inbound::mqtt::gate::budget::Payer;
use hallsweep_fuzz::inbound::mqtt::gate::filter;
use hallsweep_fuzz::inbound::mqtt::gate::frame::{Kind, frame};
use hallsweep_fuzz::inbound::mqtt::gate::limits::{CLIENT_ROOM, FILTERS, GUEST_PACKET, UNRELEASED};
use hallsweep_fuzz::inbound::mqtt::gate::packet::connect::{self, Connect};
use hallsweep_fuzz::inbound::mqtt::gate::packet::filters::Filters;
use hallsweep_fuzz::inbound::mqtt::gate::packet::{Qos, ack, publish, write};
use hallsweep_fuzz::inbound::mqtt::gate::rights::Guest;
use hallsweep_fuzz::core::units::Epoch;
use hallsweep_fuzz::inbound::mqtt::gate::turnstile::{Ended, Gatehouse, Heard, Listener, Session, Terms, Turnstile};
use hallsweep_fuzz::inbound::mqtt::topics::Topics;
use libfuzzer_sys::fuzz_target;

/// The ids that the engine gives, one after the other, and no more at once.
const ENGINE_IDS: u16 = 100;

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
struct Ear;

impl Listener for Ear {
    fn epoch(&self) -> Epoch {
        Epoch(0)
    }

    fn hear(&self, topic: &str, payload: &[u8], _: (Option<Epoch>, bool)) -> Heard {
        assert!(topic.starts_with("h/d/command") || topic.starts_with("q/"), "{topic} is no place for commands");
        if payload.first() == Some(&b'f') { Heard::Forbidden } else { Heard::Pass }
    }

    fn halts(&self, _: &[u8], payload: &[u8]) -> bool {
        payload.first() == Some(&b's')
    }
}

struct Play {
    turnstile: Turnstile,
    gatehouse: Arc<Gatehouse>,
    /// Reads everything: what nobody reads does not reach the engine.
    _reader: Turnstile,
    now: Duration,
    from_client: BytesMut,
    from_engine: BytesMut,
    /// What the engine waits for; `None` when it was not itself.
    outstanding: Option<VecDeque<u16>>,
    last_id: u16,
    /// What the engine was asked and has not answered.
    answers: BytesMut,
    ended: Option<Ended>,
}

impl Play {
    fn new(first: u8, connect: Option<Connect>) -> Play {
        let guest = [Guest::House, Guest::Somebody(Role::Operator), Guest::Somebody(Role::Viewer)][usize::from(first) % 3];
        let topics = Topics::new("h", "d", "q");
        let gatehouse = Arc::new(Gatehouse::new(topics));
        for n in 0..200_u8 {
            gatehouse.retained.keep(&Payer::Anybody, &format!("k/{n}"), &vec![n; usize::from(first) * 16 + 1], Qos::One);
        }
        let keep_alive_s = connect.as_ref().map_or(0, |connect| connect.keep_alive_s);
        let will = connect.and_then(|connect| connect.will);
        let terms = Terms {
            guest,
            name: "fuzz".into(),
            has_key: first & 4 != 0,
            listener: Arc::new(Ear),
            keep_alive_s,
            will,
            session: Session::default(),
        };
        let mut reader = Turnstile::new(
            Terms {
                guest: Guest::House,
                name: "reader".into(),
                has_key: false,
                listener: Arc::new(Ear),
                keep_alive_s: 0,
                will: None,
                session: Session::default(),
            },
            Arc::clone(&gatehouse),
            Duration::ZERO,
        );
        let mut everything = BytesMut::new();
        write::subscribe(&mut everything, 1, &[("#", Qos::Zero)]);
        reader.handle_client(&mut everything, Duration::ZERO).expect("it may");
        Play {
            _reader: reader,
            turnstile: Turnstile::new(terms, Arc::clone(&gatehouse), Duration::ZERO),
            gatehouse,
            now: Duration::ZERO,
            from_client: BytesMut::new(),
            from_engine: BytesMut::new(),
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
                self.from_engine.extend_from_slice(piece);
                self.outstanding = None;
                self.engine();
                rest = after;
            }
            5 => self.message(*how),
            6 => {
                self.from_engine.unsplit(self.answers.split());
                self.engine();
            }
            _ => self.pass(*how),
        }
        self.look();
        self.ended.is_none().then_some(rest)
    }

    fn client(&mut self) {
        let outcome = self.turnstile.handle_client(&mut self.from_client, self.now);
        self.ended = outcome.err();
        assert!(self.ended.is_some() || self.from_client.len() < 16 * GUEST_PACKET, "what is there whole is taken");
    }

    fn engine(&mut self) {
        let outcome = self.turnstile.handle_engine(&mut self.from_engine);
        let is_itself = self.outstanding.is_some();
        assert!(!is_itself || outcome.is_ok(), "an engine that is itself was sent away: {outcome:?}");
        self.ended = outcome.err();
    }

    /// The engine sends a message.
    fn message(&mut self, how: u8) {
        let Some(outstanding) = &mut self.outstanding else { return };
        let is_full = outstanding.len() >= usize::from(ENGINE_IDS);
        let qos = if how & 1 == 0 || is_full { Qos::Zero } else { Qos::One };
        if qos == Qos::One {
            self.last_id = self.last_id % ENGINE_IDS + 1;
            outstanding.push_back(self.last_id);
        }
        let topic: &[u8] = if how & 2 == 0 { b"a" } else { b"hallsweep-pulse" };
        write::publish(&mut self.from_engine, topic, &[how; 3], qos, self.last_id, false);
        self.engine();
    }

    /// Time goes on, and the client takes some of what is for it.
    fn pass(&mut self, how: u8) {
        self.now += Duration::from_secs(u64::from(how));
        self.ended = self.turnstile.handle_timeout(self.now).err();
        let out = self.turnstile.to_client();
        let taken = out.len() * usize::from(how % 5) / 4;
        out.advance(taken.min(out.len()));
        self.turnstile.handle_drained();
    }

    fn end(mut self, why: Ended) {
        self.turnstile.handle_end(self.ended.unwrap_or(why));
        self.look();
        let session = self.turnstile.into_session();
        assert!(session.filters.len() <= FILTERS && session.unreleased.len() <= UNRELEASED);
    }

    /// Looks at everything that reaches the engine.
    fn look(&mut self) {
        let out = std::mem::take(self.turnstile.to_engine());
        let mut rest = &out[..];
        while let Some(frame) = frame(rest, usize::MAX).expect("only packets reach the engine") {
            let (packet, after) = rest.split_at(frame.length);
            let body = &packet[frame.head..];
            match frame.kind {
                Kind::Publish => {
                    assert!(matches!(packet[0], 0x30 | 0x38), "only QoS 0, padded or not, and nothing to be kept");
                    let (publish, _) = publish::read_padded(&frame, packet).expect("it is a PUBLISH");
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
                kind => panic!("a {kind:?} reaches the engine"),
            }
            rest = after;
        }
        assert!(rest.is_empty(), "only whole packets reach the engine");
        assert!(self.turnstile.to_client().len() < CLIENT_ROOM + 16 * GUEST_PACKET);
        assert!(!self.gatehouse.budget.is_exhausted());
    }

    /// The engine is asked something, and will answer as it does.
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
