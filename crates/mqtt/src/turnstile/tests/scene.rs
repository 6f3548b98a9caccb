//! A turnstile with somebody at each side: packets go in as bytes, and come out as words. The engine is played by a few lines here.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::{Buf, BytesMut};

use crate::frame::{Frame, Kind, frame};
use crate::outbox::Outbox;
use crate::packet::filters::Filters;
use crate::packet::{Qos, ack, publish, write};
use crate::rights::{Guest, Rights, Tier};
use crate::turnstile::{Ended, Epoch, Gatehouse, Heard, Listener, Session, Terms, Turnstile};

pub(super) const OPERATOR: Guest = Guest::Client(Tier::Full);
pub(super) const VIEWER: Guest = Guest::Client(Tier::Limited);
pub(super) const START: &str = "site/robot/command/start";
pub(super) const STOP: &str = "site/robot/command/stop";

/// What only the program reads.
pub(super) const PULSE: &str = "broker-pulse";

/// Commands are taken on `site/robot/command`, on the names below it, and on those below `old`; all else of `site/robot` and
/// `directory/robot` is the program's own, and what is left is for clients with full rights.
#[derive(Debug)]
pub(super) struct TestRights;

impl TestRights {
    fn is_own(topic: &str) -> bool {
        topic.starts_with("site/robot/") || ["site/robot", "directory/robot", PULSE].contains(&topic)
    }
}

impl Rights for TestRights {
    fn is_for_commands(&self, topic: &str) -> bool {
        let is_name_below = |above: &str| topic.strip_prefix(above).is_some_and(|name| !name.contains('/'));
        topic == "site/robot/command" || is_name_below("site/robot/command/") || is_name_below("old/")
    }

    fn may_publish(&self, who: Guest, topic: &str) -> bool {
        who == Guest::Program || self.is_for_commands(topic) || who == OPERATOR && !TestRights::is_own(topic)
    }

    fn may_subscribe(&self, who: Guest, filter: &str) -> bool {
        who == Guest::Program || filter != PULSE
    }

    fn may_see(&self, who: Guest, topic: &[u8]) -> bool {
        who == Guest::Program || topic != PULSE.as_bytes()
    }

    fn may_leave_will(&self, who: Guest, topic: &str) -> bool {
        !self.is_for_commands(topic) && self.may_publish(who, topic)
    }
}

/// Hears commands, and forbids those that say so.
#[derive(Debug, Default)]
pub(super) struct Ear(Mutex<Vec<String>>);

impl Listener for Ear {
    fn epoch(&self) -> Epoch {
        Epoch(0)
    }

    fn hear(&self, topic: &str, payload: &[u8], (_, is_again): (Option<Epoch>, bool)) -> Heard {
        let payload = String::from_utf8_lossy(payload);
        let again = if is_again { " again" } else { "" };
        self.0.lock().unwrap().push(format!("{topic} {payload}{again}"));
        if payload == "forbidden" { Heard::Forbidden } else { Heard::Pass }
    }

    fn halts(&self, topic: &[u8], payload: &[u8]) -> bool {
        let is_stop = topic == STOP.as_bytes();
        if is_stop {
            self.0.lock().unwrap().push(format!("{STOP} {}", String::from_utf8_lossy(payload)));
        }
        is_stop
    }
}

pub(super) struct Scene {
    pub(super) turnstile: Turnstile,
    pub(super) gatehouse: Arc<Gatehouse>,
    ear: Arc<Ear>,
}

pub(super) fn gatehouse() -> Arc<Gatehouse> {
    let gatehouse = Gatehouse::new(TestRights);
    // Somebody reads everything: what nobody reads goes nowhere.
    gatehouse.readers.enter(&Arc::from("#"), &Arc::default(), false);
    Arc::new(gatehouse)
}

pub(super) fn terms(guest: Guest, ear: Arc<Ear>) -> Terms {
    Terms {
        guest,
        name: Arc::from("tests"),
        has_key: false,
        listener: ear,
        keep_alive_s: 60,
        will: None,
        session: Session::default(),
    }
}

impl Scene {
    pub(super) fn of(guest: Guest) -> Scene {
        Scene::in_house(&gatehouse(), guest, |_| {})
    }

    pub(super) fn in_house(gatehouse: &Arc<Gatehouse>, guest: Guest, change: impl FnOnce(&mut Terms)) -> Scene {
        let ear = Arc::new(Ear::default());
        let mut terms = terms(guest, Arc::clone(&ear));
        change(&mut terms);
        let turnstile = Turnstile::new(terms, Arc::clone(gatehouse), Duration::ZERO);
        Scene { turnstile, gatehouse: Arc::clone(gatehouse), ear }
    }

    pub(super) fn client(&mut self, bytes: &[u8]) -> Result<(), Ended> {
        let mut bytes = BytesMut::from(bytes);
        self.turnstile.handle_client(&mut bytes, Duration::from_secs(1))
    }

    pub(super) fn engine(&mut self, bytes: &[u8]) -> Result<(), Ended> {
        self.turnstile.handle_engine(&mut BytesMut::from(bytes))
    }

    /// The engine answers all that it got.
    pub(super) fn engine_answers(&mut self) {
        let questions = std::mem::take(self.turnstile.to_engine());
        let mut answers = BytesMut::new();
        for (kind, body) in packets(&questions) {
            answer(kind, body, &mut answers);
        }
        self.turnstile.handle_engine(&mut answers).unwrap();
    }

    pub(super) fn engine_got(&mut self) -> Vec<String> {
        in_words(&std::mem::take(self.turnstile.to_engine()))
    }

    pub(super) fn client_got(&mut self) -> Vec<String> {
        let got = in_words(&taken(self.turnstile.to_client()));
        self.turnstile.handle_drained();
        while self.turnstile.wants_turn() {
            self.turnstile.handle_drained();
        }
        got
    }

    pub(super) fn heard(&self) -> Vec<String> {
        std::mem::take(&mut self.ear.0.lock().unwrap())
    }

    /// A SUBSCRIBE that the engine answers; what the client gets of it.
    pub(super) fn subscribe(&mut self, filters: &[(&str, Qos)]) -> Vec<String> {
        self.client(&subscribe(1, filters)).unwrap();
        self.engine_answers();
        self.client_got()
    }
}

/// All that waits for a client, which takes it.
pub(super) fn taken(outbox: &mut Outbox) -> Vec<u8> {
    outbox.copy_to_bytes(outbox.len()).into()
}

/// As the engine answers: an UNSUBACK for each filter.
fn answer(kind: Kind, body: &[u8], out: &mut BytesMut) {
    if kind == Kind::Subscribe {
        let filters = Filters::of_subscribe(body).unwrap();
        write::suback(out, filters.id, &filters.map(|(_, qos)| qos as u8).collect::<Vec<_>>());
    }
    if kind == Kind::Unsubscribe {
        let filters = Filters::of_unsubscribe(body).unwrap();
        filters.for_each(|_| write::ack(out, Kind::Unsuback, filters.id));
    }
    if kind == Kind::Pingreq {
        out.extend_from_slice(&write::PINGRESP);
    }
}

/// A PUBLISH; `first` is its first byte.
pub(super) fn publish(first: u8, topic: &str, payload: &str, id: u16) -> BytesMut {
    let mut out = BytesMut::new();
    write::publish(&mut out, topic.as_bytes(), payload.as_bytes(), Qos::of(first >> 1 & 3).unwrap(), id, first & 1 != 0);
    out[0] |= first & 8;
    out
}

pub(super) fn subscribe(id: u16, filters: &[(&str, Qos)]) -> BytesMut {
    let mut out = BytesMut::new();
    write::subscribe(&mut out, id, filters);
    out
}

pub(super) fn unsubscribe(id: u16, filters: &[&str]) -> BytesMut {
    let mut out = BytesMut::new();
    write::unsubscribe(&mut out, id, filters);
    out
}

pub(super) fn packets(mut bytes: &[u8]) -> Vec<(Kind, &[u8])> {
    let mut packets = Vec::new();
    while let Some(frame) = frame(bytes, usize::MAX).unwrap() {
        packets.push((frame.kind, &bytes[frame.head..frame.length]));
        bytes = &bytes[frame.length..];
    }
    assert!(bytes.is_empty(), "only whole packets come out");
    packets
}

/// Packets as `Publish a=x q1 #7`, `Puback 7`, `Suback 7 [1, 128]`.
pub(super) fn in_words(mut bytes: &[u8]) -> Vec<String> {
    let mut words = Vec::new();
    while let Some(frame) = frame(bytes, usize::MAX).unwrap() {
        let (packet, rest) = bytes.split_at(frame.length);
        let body = &packet[frame.head..];
        words.push(match frame.kind {
            Kind::Publish => publish_in_words(&read(&frame, packet)),
            Kind::Subscribe => format!("Subscribe {:?}", Filters::of_subscribe(body).unwrap().collect::<Vec<_>>()),
            Kind::Unsubscribe => {
                format!("Unsubscribe {:?}", Filters::of_unsubscribe(body).unwrap().map(|of| of.0).collect::<Vec<_>>())
            }
            Kind::Suback => format!("Suback {:?}", ack::read_suback(body).unwrap()),
            Kind::Pingreq | Kind::Pingresp => format!("{:?}", frame.kind),
            Kind::Connect | Kind::Connack | Kind::Disconnect => format!("{:?}", frame.kind),
            Kind::Puback | Kind::Pubrec | Kind::Pubrel | Kind::Pubcomp | Kind::Unsuback => {
                format!("{:?} {}", frame.kind, ack::read(body).unwrap())
            }
        });
        bytes = rest;
    }
    assert!(bytes.is_empty(), "only whole packets come out");
    words
}

/// As the engine gets it or as the client does.
fn read<'a>(frame: &Frame, packet: &'a [u8]) -> publish::Publish<'a> {
    publish::read(frame, packet).or_else(|_| publish::read_padded(frame, packet).map(|(publish, _)| publish)).unwrap()
}

fn publish_in_words(publish: &publish::Publish<'_>) -> String {
    let topic = String::from_utf8_lossy(publish.topic);
    let payload = String::from_utf8_lossy(publish.payload);
    let id = if publish.id == 0 { String::new() } else { format!(" #{}", publish.id) };
    let kept = if publish.retain { " kept" } else { "" };
    let again = if publish.is_duplicate { " again" } else { "" };
    format!("Publish {topic}={payload} q{}{id}{kept}{again}", publish.qos as u8)
}
