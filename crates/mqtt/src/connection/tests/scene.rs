//! A test scene: one client at a connection, and other clients at the same broker. Packets go in as bytes and come
//! out as text.

use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::{Buf, Bytes, BytesMut};

use crate::filter;
use crate::frame::{PacketKind, frame};
use crate::outbox::Outbox;
use crate::packet::connect::{Connect, FOR_EVER_S};
use crate::packet::{Qos, Version, ack, publish, write};
use crate::rights::{Rights, Scope, Tier};
use crate::{Broker, ClientConnection, CommandDecision, Ended, Epoch, Listener, Said, Session, Terms};

pub(super) const OPERATOR: Tier = Tier::Full;
pub(super) const VIEWER: Tier = Tier::Limited;
pub(super) const START: &str = "site/robot/command/start";
pub(super) const STOP: &str = "site/robot/command/stop";

/// Commands are accepted on `site/robot/command`, on the topics below it, and on the topics below `old`. All other
/// topics under `site/robot` and `directory/robot` belong to the program. The remaining topics are for clients with
/// full rights.
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

    fn may_share(&self, who: Tier, filter: &str) -> bool {
        who == OPERATOR && !filter::overlap(filter, "site/robot/#")
    }
}

/// Records commands, and forbids a command with the payload `forbidden`.
#[derive(Debug, Default)]
pub(super) struct TestListener(Mutex<Vec<String>>);

impl Listener for TestListener {
    fn epoch(&self) -> Epoch {
        Epoch(0)
    }

    fn hear(&self, topic: &str, said: Said<'_>, _: Option<Epoch>, is_again: bool) -> CommandDecision {
        let payload = String::from_utf8_lossy(said.payload);
        let again = if is_again { " again" } else { "" };
        self.0.lock().unwrap().push(format!("{topic} {payload}{again}"));
        if payload == "forbidden" { CommandDecision::Forbidden } else { CommandDecision::Pass }
    }

    fn hear_urgent(&self, said: Said<'_>) -> bool {
        let is_urgent = said.topic == STOP.as_bytes();
        if is_urgent {
            self.0.lock().unwrap().push(format!("{STOP} {}", String::from_utf8_lossy(said.payload)));
        }
        is_urgent
    }
}

pub(super) struct Scene {
    pub(super) connection: ClientConnection,
    pub(super) broker: Arc<Broker>,
    listener: Arc<TestListener>,
    pub(super) now: Duration,
}

pub(super) fn broker() -> Arc<Broker> {
    Arc::new(Broker::new(TestRights))
}

fn terms(tier: Tier, listener: Arc<TestListener>) -> Terms {
    Terms {
        tier,
        scope: Scope::default(),
        name: Arc::from("tests"),
        has_key: false,
        listener,
        connect: Connect { session_expiry_s: FOR_EVER_S, keep_alive_s: 60, ..Connect::default() },
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
        Scene { connection, broker: Arc::clone(broker), listener, now: Duration::from_secs(1) }
    }

    pub(super) fn reader(&self, filters: &[(&str, Qos)]) -> Scene {
        let mut reader = Scene::at_broker(&self.broker, OPERATOR, |_| {});
        reader.subscribe(filters);
        reader
    }

    /// Another client, which reads everything at the QoS at which it was published.
    pub(super) fn everybody(&self) -> Scene {
        self.reader(&[("#", Qos::Two)])
    }

    pub(super) fn client(&mut self, bytes: &[u8]) -> Result<(), Ended> {
        let mut bytes = BytesMut::from(bytes);
        self.connection.handle_client(&mut bytes, self.now)
    }

    pub(super) fn got(&mut self) -> Vec<String> {
        self.connection.handle_come(self.now);
        let got = in_words(&taken(self.connection.to_client()));
        self.connection.handle_drained(self.now);
        while self.connection.wants_turn() {
            self.connection.handle_drained(self.now);
        }
        got
    }

    /// Returns the messages that the client receives now, without packet ids.
    pub(super) fn read(&mut self) -> Vec<String> {
        let said = |words: String| Some(words.strip_prefix("Publish ")?.split(" #").next()?.to_owned());
        self.got().into_iter().filter_map(said).collect()
    }

    pub(super) fn heard(&self) -> Vec<String> {
        std::mem::take(&mut self.listener.0.lock().unwrap())
    }

    /// Sends a SUBSCRIBE, and returns what the client receives in answer.
    pub(super) fn subscribe(&mut self, filters: &[(&str, Qos)]) -> Vec<String> {
        self.client(&subscribe(1, filters)).unwrap();
        self.got()
    }

    pub(super) fn acknowledge(&mut self, kind: PacketKind, id: u16) {
        let mut out = BytesMut::new();
        write::ack(&mut out, kind, id);
        self.client(&out).unwrap();
    }
}

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

/// Returns packets as text: `Publish a=x q1 #7`, `Puback 7`, `Suback 7 [1, 128]`.
pub(super) fn in_words(mut bytes: &[u8]) -> Vec<String> {
    let mut words = Vec::new();
    while let Some(frame) = frame(bytes, usize::MAX).unwrap() {
        let (packet, rest) = bytes.split_at(frame.length);
        let body = &packet[frame.head..];
        words.push(match frame.kind {
            PacketKind::Publish => publish_in_words(&publish::read(&frame, packet, Version::Three).unwrap()),
            PacketKind::Suback => format!("Suback {:?}", ack::read_suback(body).unwrap()),
            PacketKind::Connect | PacketKind::Connack | PacketKind::Subscribe | PacketKind::Unsubscribe => {
                format!("{:?}", frame.kind)
            }
            PacketKind::Pingreq | PacketKind::Pingresp | PacketKind::Disconnect | PacketKind::Auth => format!("{:?}", frame.kind),
            PacketKind::Puback | PacketKind::Pubrec | PacketKind::Pubrel | PacketKind::Pubcomp | PacketKind::Unsuback => {
                format!("{:?} {}", frame.kind, ack::read(body, frame.kind, Version::Three).unwrap().id)
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

/// Packets of a client of MQTT 5, and the text of what it receives.
pub(super) mod five {
    use bytes::{BufMut, BytesMut};

    use super::{OPERATOR, Scene, taken};
    use crate::frame::{PacketKind, frame};
    use crate::packet::properties::{Properties, Property};
    use crate::packet::{PacketFields, Version, publish, write};
    use crate::{Broker, Terms};

    pub(in super::super) fn scene(broker: &std::sync::Arc<Broker>, change: impl FnOnce(&mut Terms)) -> Scene {
        Scene::at_broker(broker, OPERATOR, |terms| {
            terms.connect.credentials.version = Version::Five;
            change(terms);
        })
    }

    fn packet(first: u8, body: &[u8]) -> BytesMut {
        let mut out = BytesMut::from(&[first][..]);
        crate::packet::properties::put_variable(&mut out, u32::try_from(body.len()).unwrap());
        out.extend_from_slice(body);
        out
    }

    fn put(out: &mut BytesMut, properties: &[Property<'_>]) {
        let mut written = BytesMut::new();
        properties.iter().for_each(|property| property.write(&mut written));
        crate::packet::properties::put_variable(out, u32::try_from(written.len()).unwrap());
        out.extend_from_slice(&written);
    }

    pub(in super::super) fn publish_with(
        first: u8,
        topic: &str,
        payload: &str,
        id: u16,
        properties: &[Property<'_>],
    ) -> BytesMut {
        let mut body = BytesMut::new();
        body.put_u16(u16::try_from(topic.len()).unwrap());
        body.put_slice(topic.as_bytes());
        if first & 6 != 0 {
            body.put_u16(id);
        }
        put(&mut body, properties);
        body.put_slice(payload.as_bytes());
        packet(first, &body)
    }

    pub(in super::super) fn subscribe_with(filter: &str, options: u8, properties: &[Property<'_>]) -> BytesMut {
        let mut body = BytesMut::from(&[0, 7][..]);
        put(&mut body, properties);
        body.put_u16(u16::try_from(filter.len()).unwrap());
        body.put_slice(filter.as_bytes());
        body.put_u8(options);
        packet(0x82, &body)
    }

    pub(in super::super) fn unsubscribe_from(filter: &str) -> BytesMut {
        let mut body = BytesMut::from(&[0, 7, 0][..]);
        body.put_u16(u16::try_from(filter.len()).unwrap());
        body.put_slice(filter.as_bytes());
        packet(0xA2, &body)
    }

    pub(in super::super) fn disconnect_with(reason: u8, properties: &[Property<'_>]) -> BytesMut {
        let mut body = BytesMut::from(&[reason][..]);
        put(&mut body, properties);
        packet(0xE0, &body)
    }

    pub(in super::super) fn ack(kind: PacketKind, id: u16, reason: u8) -> BytesMut {
        let [high, low] = id.to_be_bytes();
        packet(kind.first_byte(), &[high, low, reason])
    }

    impl Scene {
        /// A client of MQTT 5 that connects at this time.
        pub(in super::super) fn later(
            broker: &std::sync::Arc<Broker>,
            now: std::time::Duration,
            change: impl FnOnce(&mut Terms),
        ) -> Scene {
            let mut scene = scene(broker, |_| {});
            let mut terms = super::terms(OPERATOR, std::sync::Arc::clone(&scene.listener));
            terms.connect.credentials.version = Version::Five;
            change(&mut terms);
            scene.connection = crate::ClientConnection::new(terms, std::sync::Arc::clone(broker), now);
            scene.now = now;
            scene
        }

        /// What a client of MQTT 5 receives now: `Publish a=x q1 #7 [User("a", "b")]`, `Puback 7 0x87`.
        pub(in super::super) fn told(&mut self) -> Vec<String> {
            self.connection.handle_come(self.now);
            let told = in_words(&taken(self.connection.to_client()));
            self.connection.handle_drained(self.now);
            told
        }
    }

    pub(in super::super) fn in_words(mut bytes: &[u8]) -> Vec<String> {
        let mut words = Vec::new();
        while let Some(frame) = frame(bytes, usize::MAX).unwrap() {
            let (packet, rest) = bytes.split_at(frame.length);
            let body = &packet[frame.head..];
            words.push(match frame.kind {
                PacketKind::Publish => publish_in_words(frame.flags, body),
                PacketKind::Suback | PacketKind::Unsuback => {
                    let mut fields = PacketFields::new(&body[2..]);
                    let why: Vec<_> = Properties::of_server(&mut fields).collect();
                    format!("{:?} {:02x?}{}", frame.kind, fields.rest(), in_brackets(&why))
                }
                PacketKind::Puback | PacketKind::Pubrec | PacketKind::Pubrel | PacketKind::Pubcomp => {
                    let reason =
                        body.get(2).filter(|reason| **reason > 0).map_or(String::new(), |reason| format!(" {reason:#04x}"));
                    format!("{:?} {}{reason}", frame.kind, u16::from_be_bytes([body[0], body[1]]))
                }
                PacketKind::Disconnect => format!("Disconnect {:#04x}", body[0]),
                PacketKind::Connect | PacketKind::Connack | PacketKind::Subscribe | PacketKind::Unsubscribe => {
                    format!("{:?}", frame.kind)
                }
                PacketKind::Pingreq | PacketKind::Pingresp | PacketKind::Auth => format!("{:?}", frame.kind),
            });
            bytes = rest;
        }
        assert!(bytes.is_empty(), "only whole packets come out");
        words
    }

    fn publish_in_words(flags: u8, body: &[u8]) -> String {
        let mut fields = PacketFields::new(body);
        let (topic, qos) = (fields.text("topic").unwrap(), flags >> 1 & 3);
        let id = if qos == 0 { String::new() } else { format!(" #{}", fields.id().unwrap()) };
        let properties: Vec<_> = Properties::of_server(&mut fields).collect();
        let payload = String::from_utf8_lossy(fields.rest());
        let kept = if flags & 1 != 0 { " kept" } else { "" };
        let again = if flags & 8 != 0 { " again" } else { "" };
        format!("Publish {topic}={payload} q{qos}{id}{kept}{again}{}", in_brackets(&properties))
    }

    fn in_brackets(properties: &[Property<'_>]) -> String {
        if properties.is_empty() { String::new() } else { format!(" {properties:?}") }
    }

    /// The packets of these tests have to be valid.
    #[test]
    fn packets_of_these_tests_are_good_ones() {
        let out = publish_with(0x32, "a", "x", 3, &[Property::TopicAlias(2)]);
        let frame = frame(&out, 100).unwrap().unwrap();
        assert_eq!(publish::read(&frame, &out, Version::Five).unwrap().payload, b"x");
        let mut plain = BytesMut::new();
        write::ack_with(&mut plain, PacketKind::Puback, 1, crate::packet::reason::Reason::Quota, None);
        assert_eq!(in_words(&plain), ["Puback 1 0x97"]);
    }
}
