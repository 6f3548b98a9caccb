//! A connection with somebody at each side: packets go in as bytes, and come out as words. The router is played by a few lines here.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::{Buf, BytesMut};

use crate::frame::{Frame, Kind, frame};
use crate::outbox::Outbox;
use crate::packet::filters::Filters;
use crate::packet::{Qos, ack, publish, write};
use crate::rights::{Principal, Rights, Tier};
use crate::{Broker, ClientConnection, CommandDecision, Ended, Epoch, Listener, Session, Terms};

pub(super) const OPERATOR: Principal = Principal::Client(Tier::Full);
pub(super) const VIEWER: Principal = Principal::Client(Tier::Limited);
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

    fn may_publish(&self, who: Principal, topic: &str) -> bool {
        who == Principal::Program || self.is_for_commands(topic) || who == OPERATOR && !TestRights::is_own(topic)
    }

    fn may_subscribe(&self, who: Principal, filter: &str) -> bool {
        who == Principal::Program || filter != PULSE
    }

    fn may_see(&self, who: Principal, topic: &[u8]) -> bool {
        who == Principal::Program || topic != PULSE.as_bytes()
    }
}

/// Hears commands, and forbids those that say so.
#[derive(Debug, Default)]
pub(super) struct TestListener(Mutex<Vec<String>>);

impl Listener for TestListener {
    fn epoch(&self) -> Epoch {
        Epoch(0)
    }

    fn hear(&self, topic: &str, payload: &[u8], (_, is_again): (Option<Epoch>, bool)) -> CommandDecision {
        let payload = String::from_utf8_lossy(payload);
        let again = if is_again { " again" } else { "" };
        self.0.lock().unwrap().push(format!("{topic} {payload}{again}"));
        if payload == "forbidden" { CommandDecision::Forbidden } else { CommandDecision::Pass }
    }

    fn hear_urgent(&self, topic: &[u8], payload: &[u8]) -> bool {
        let is_urgent = topic == STOP.as_bytes();
        if is_urgent {
            self.0.lock().unwrap().push(format!("{STOP} {}", String::from_utf8_lossy(payload)));
        }
        is_urgent
    }
}

pub(super) struct Scene {
    pub(super) connection: ClientConnection,
    pub(super) broker: Arc<Broker>,
    listener: Arc<TestListener>,
}

pub(super) fn broker() -> Arc<Broker> {
    let broker = Broker::new(TestRights);
    // Somebody reads everything: what nobody reads goes nowhere.
    broker.readers.enter(&Arc::from("#"), &Arc::default(), false);
    Arc::new(broker)
}

pub(super) fn terms(principal: Principal, listener: Arc<TestListener>) -> Terms {
    Terms {
        principal,
        name: Arc::from("tests"),
        has_key: false,
        listener,
        keep_alive_s: 60,
        will: None,
        session: Session::default(),
    }
}

impl Scene {
    pub(super) fn of(principal: Principal) -> Scene {
        Scene::at_broker(&broker(), principal, |_| {})
    }

    pub(super) fn at_broker(broker: &Arc<Broker>, principal: Principal, change: impl FnOnce(&mut Terms)) -> Scene {
        let listener = Arc::new(TestListener::default());
        let mut terms = terms(principal, Arc::clone(&listener));
        change(&mut terms);
        let connection = ClientConnection::new(terms, Arc::clone(broker), Duration::ZERO);
        Scene { connection, broker: Arc::clone(broker), listener }
    }

    pub(super) fn client(&mut self, bytes: &[u8]) -> Result<(), Ended> {
        let mut bytes = BytesMut::from(bytes);
        self.connection.handle_client(&mut bytes, Duration::from_secs(1))
    }

    pub(super) fn router(&mut self, bytes: &[u8]) -> Result<(), Ended> {
        self.connection.handle_router(&mut BytesMut::from(bytes))
    }

    /// The router answers all that it got.
    pub(super) fn router_answers(&mut self) {
        let questions = std::mem::take(self.connection.to_router());
        let mut answers = BytesMut::new();
        for (kind, body) in packets(&questions) {
            answer(kind, body, &mut answers);
        }
        self.connection.handle_router(&mut answers).unwrap();
    }

    pub(super) fn router_got(&mut self) -> Vec<String> {
        in_words(&std::mem::take(self.connection.to_router()))
    }

    pub(super) fn client_got(&mut self) -> Vec<String> {
        let got = in_words(&taken(self.connection.to_client()));
        self.connection.handle_drained();
        while self.connection.wants_turn() {
            self.connection.handle_drained();
        }
        got
    }

    pub(super) fn heard(&self) -> Vec<String> {
        std::mem::take(&mut self.listener.0.lock().unwrap())
    }

    /// A SUBSCRIBE that the router answers; what the client gets of it.
    pub(super) fn subscribe(&mut self, filters: &[(&str, Qos)]) -> Vec<String> {
        self.client(&subscribe(1, filters)).unwrap();
        self.router_answers();
        self.client_got()
    }
}

/// All that waits for a client, which takes it.
pub(super) fn taken(outbox: &mut Outbox) -> Vec<u8> {
    outbox.copy_to_bytes(outbox.len()).into()
}

/// As the router answers: an UNSUBACK for each filter.
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

/// As the router gets it or as the client does.
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
