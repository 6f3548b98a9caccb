//! A connection with a client at one side and others at the same broker: packets go in as bytes, and come out as words.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::{Buf, Bytes, BytesMut};

use crate::frame::{Kind, frame};
use crate::outbox::Outbox;
use crate::packet::filters::Filters;
use crate::packet::{Qos, ack, publish, write};
use crate::rights::{Rights, Tier};
use crate::{Broker, ClientConnection, CommandDecision, Ended, Epoch, Listener, Session, Terms};

pub(super) const OPERATOR: Tier = Tier::Full;
pub(super) const VIEWER: Tier = Tier::Limited;
pub(super) const START: &str = "site/robot/command/start";
pub(super) const STOP: &str = "site/robot/command/stop";

/// Commands are taken on `site/robot/command`, on the names below it, and on those below `old`; all else of `site/robot` and
/// `directory/robot` is the program's own, and what is left is for clients with full rights.
#[derive(Debug)]
pub(super) struct TestRights;

impl TestRights {
    fn is_own(topic: &str) -> bool {
        topic.starts_with("site/robot/") || ["site/robot", "directory/robot"].contains(&topic)
    }
}

impl Rights for TestRights {
    fn is_for_commands(&self, topic: &str) -> bool {
        let is_name_below = |above: &str| topic.strip_prefix(above).is_some_and(|name| !name.contains('/'));
        topic == "site/robot/command" || is_name_below("site/robot/command/") || is_name_below("old/")
    }

    fn may_publish(&self, who: Tier, topic: &str) -> bool {
        self.is_for_commands(topic) || who == OPERATOR && !TestRights::is_own(topic)
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
    Arc::new(Broker::new(TestRights))
}

fn terms(tier: Tier, listener: Arc<TestListener>) -> Terms {
    Terms {
        tier,
        name: Arc::from("tests"),
        has_key: false,
        listener,
        keep_alive_s: 60,
        will: None,
        session: Session::default(),
        greeting: Bytes::new(),
    }
}

impl Scene {
    pub(super) fn of(tier: Tier) -> Scene {
        Scene::at_broker(&broker(), tier, |_| {})
    }

    pub(super) fn at_broker(broker: &Arc<Broker>, tier: Tier, change: impl FnOnce(&mut Terms)) -> Scene {
        let listener = Arc::new(TestListener::default());
        let mut terms = terms(tier, Arc::clone(&listener));
        change(&mut terms);
        let connection = ClientConnection::new(terms, Arc::clone(broker), Duration::ZERO);
        Scene { connection, broker: Arc::clone(broker), listener }
    }

    /// Somebody else at the same broker, who holds these filters.
    pub(super) fn reader(&self, filters: &[(&str, Qos)]) -> Scene {
        let mut reader = Scene::at_broker(&self.broker, OPERATOR, |_| {});
        reader.subscribe(filters);
        reader
    }

    /// Somebody who reads everything, as it was published.
    pub(super) fn everybody(&self) -> Scene {
        self.reader(&[("#", Qos::Two)])
    }

    pub(super) fn client(&mut self, bytes: &[u8]) -> Result<(), Ended> {
        let mut bytes = BytesMut::from(bytes);
        self.connection.handle_client(&mut bytes, Duration::from_secs(1))
    }

    /// What the client gets now, and takes.
    pub(super) fn got(&mut self) -> Vec<String> {
        self.connection.handle_come();
        let got = in_words(&taken(self.connection.to_client()));
        self.connection.handle_drained();
        while self.connection.wants_turn() {
            self.connection.handle_drained();
        }
        got
    }

    /// What was published for it now, without ids.
    pub(super) fn read(&mut self) -> Vec<String> {
        let said = |words: String| Some(words.strip_prefix("Publish ")?.split(" #").next()?.to_owned());
        self.got().into_iter().filter_map(said).collect()
    }

    pub(super) fn heard(&self) -> Vec<String> {
        std::mem::take(&mut self.listener.0.lock().unwrap())
    }

    /// A SUBSCRIBE; what the client gets of it.
    pub(super) fn subscribe(&mut self, filters: &[(&str, Qos)]) -> Vec<String> {
        self.client(&subscribe(1, filters)).unwrap();
        self.got()
    }

    /// The client acknowledges this.
    pub(super) fn acknowledge(&mut self, kind: Kind, id: u16) {
        let mut out = BytesMut::new();
        write::ack(&mut out, kind, id);
        self.client(&out).unwrap();
    }
}

/// All that waits for a client, which takes it.
pub(super) fn taken(outbox: &mut Outbox) -> Vec<u8> {
    outbox.copy_to_bytes(outbox.len()).into()
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

/// Packets as `Publish a=x q1 #7`, `Puback 7`, `Suback 7 [1, 128]`.
pub(super) fn in_words(mut bytes: &[u8]) -> Vec<String> {
    let mut words = Vec::new();
    while let Some(frame) = frame(bytes, usize::MAX).unwrap() {
        let (packet, rest) = bytes.split_at(frame.length);
        let body = &packet[frame.head..];
        words.push(match frame.kind {
            Kind::Publish => publish_in_words(&publish::read(&frame, packet).unwrap()),
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

fn publish_in_words(publish: &publish::Publish<'_>) -> String {
    let topic = String::from_utf8_lossy(publish.topic);
    let payload = String::from_utf8_lossy(publish.payload);
    let id = if publish.id == 0 { String::new() } else { format!(" #{}", publish.id) };
    let kept = if publish.retain { " kept" } else { "" };
    let again = if publish.is_duplicate { " again" } else { "" };
    format!("Publish {topic}={payload} q{}{id}{kept}{again}", publish.qos as u8)
}
