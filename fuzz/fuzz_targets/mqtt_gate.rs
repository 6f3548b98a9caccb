//! A connection with a client that sends anything in pieces of any size, reads at any time, and reconnects at times.
//! The properties: nothing panics; the client gets whole packets; the number of packets it must acknowledge is
//! bounded; other clients get messages on valid topics. Other tests check whether the client gets the right messages.
#![no_main]

use std::sync::Arc;
use std::time::Duration;

use bytes::{Buf, Bytes, BytesMut};
use libfuzzer_sys::fuzz_target;
use mqtt_gate::limits::{ANSWER_ROOM, CLIENT_PACKET, FILTERS, UNRELEASED};
use mqtt_gate::packet::connect::{self, Connect};
use mqtt_gate::packet::{Qos, Version, publish, write};
use mqtt_gate::{
    Announcement, Broker, ClientConnection, CommandDecision, Ended, Epoch, Listener, PacketKind, Rights, Said, Scope, Session,
    Terms, Tier, filter, frame,
};

fuzz_target!(|bytes: &[u8]| {
    let [first, length, bytes @ ..] = bytes else { return };
    let (body, mut rest) = bytes.split_at(usize::from(*length).min(bytes.len()));
    let mut play = Play::new(*first, connect::read(body).ok());
    while let Some(after) = play.step(rest) {
        rest = after;
    }
    play.end(Ended::Gone);
});

/// Accepts every command, except that a payload beginning with `f` is forbidden and one beginning with `s` is urgent.
struct TestListener;

impl Listener for TestListener {
    fn epoch(&self) -> Epoch {
        Epoch(0)
    }

    fn hear(&self, topic: &str, Said { payload, .. }: Said<'_>, _: Option<Epoch>, _: bool) -> CommandDecision {
        assert!(topic.starts_with("h/d/command") || topic.starts_with("q/"), "{topic} is no place for commands");
        if payload.first() == Some(&b'f') { CommandDecision::Forbidden } else { CommandDecision::Pass }
    }

    fn hear_urgent(&self, said: Said<'_>) -> bool {
        said.payload.first() == Some(&b's')
    }
}

/// Rights like those on a robot's topics: commands on `h/d/command` and on the names below it and below `q`; only the
/// program publishes on the rest of `h/d`.
#[derive(Debug)]
struct TestRights;

impl Rights for TestRights {
    fn is_for_commands(&self, topic: &str) -> bool {
        let is_name_below = |above: &str| topic.strip_prefix(above).is_some_and(|name| !name.contains('/'));
        topic == "h/d/command" || is_name_below("h/d/command/") || is_name_below("q/")
    }

    fn may_publish(&self, who: Tier, topic: &str) -> bool {
        let is_own = topic == "h/d" || topic.starts_with("h/d/");
        self.is_for_commands(topic) || who == Tier::Full && !is_own
    }

    fn may_share(&self, who: Tier, filter: &str) -> bool {
        who == Tier::Full && !filter::overlap(filter, "h/d/#")
    }
}

struct Play {
    connection: ClientConnection,
    broker: Arc<Broker>,
    tier: Tier,
    /// CONNECT that the client sends each time.
    connect: Connect,
    /// Another client that subscribes to all topics and reads at once.
    reader: ClientConnection,
    now: Duration,
    from_client: BytesMut,
    /// Bytes that the client has read and that are not a whole packet yet.
    taken: BytesMut,
    ended: Option<Ended>,
}

impl Play {
    fn new(first: u8, connect: Option<Connect>) -> Play {
        let tier = [Tier::Full, Tier::Limited][usize::from(first) % 2];
        let broker = Arc::new(Broker::new(TestRights));
        for n in 0..200_u8 {
            let (topic, payload) = (format!("k/{n}"), vec![n; usize::from(first) * 16 + 1]);
            broker.publish(&Announcement { retain: true, ..Announcement::passing(&topic, &payload) });
        }
        let connect = connect.unwrap_or_default();
        let terms = Terms { has_key: first & 4 != 0, ..terms(tier, connect.clone(), Session::default()) };
        let mut reader = ClientConnection::new(
            self::terms(Tier::Full, Connect::default(), Session::default()),
            Arc::clone(&broker),
            Duration::ZERO,
        );
        let mut everything = BytesMut::new();
        write::subscribe(&mut everything, 1, &[("#", Qos::Two)]);
        reader.handle_client(&mut everything, Duration::ZERO).expect("it may");
        Play {
            connection: ClientConnection::new(terms, Arc::clone(&broker), Duration::ZERO),
            reader,
            broker,
            tier,
            connect,
            now: Duration::ZERO,
            from_client: BytesMut::new(),
            taken: BytesMut::new(),
            ended: None,
        }
    }

    /// Executes one step; returns the rest of the input, or `None` at its end.
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
                let payload = [*how; 3];
                let said = Announcement { retain: how & 1 != 0, ..Announcement::passing("a", &payload) };
                self.broker.publish(&said);
            }
            5 => self.connection.handle_come(self.now),
            6 => self.come_back(),
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

    /// Breaks the connection and reconnects the client.
    fn come_back(&mut self) {
        let new =
            |session| ClientConnection::new(terms(self.tier, self.connect.clone(), session), Arc::clone(&self.broker), self.now);
        let mut gone = std::mem::replace(&mut self.connection, new(Session::default()));
        gone.handle_end(Ended::Gone, self.now);
        let session = gone.into_session().unwrap_or_default();
        assert!(session.filters().count() <= FILTERS && session.unreleased() <= UNRELEASED);
        self.connection = new(session);
        self.from_client.clear();
        self.taken.clear();
    }

    /// Advances the time; the client reads a part of the bytes sent to it.
    fn pass(&mut self, how: u8) {
        self.now += Duration::from_secs(u64::from(how));
        self.ended = self.connection.handle_timeout(self.now).err();
        let out = self.connection.to_client();
        let length = out.len() * usize::from(how % 5) / 4;
        self.taken.extend_from_slice(&out.copy_to_bytes(length));
        self.connection.handle_drained(self.now);
        while let Some(frame) = frame(&self.taken, usize::MAX).expect("only packets reach the client") {
            if frame.kind == PacketKind::Publish {
                publish::read(&frame, &self.taken[..frame.length], Version::Three).expect("it is a PUBLISH");
            }
            self.taken.advance(frame.length);
        }
    }

    fn end(mut self, why: Ended) {
        self.connection.handle_end(self.ended.unwrap_or(why), self.now);
        self.look();
        drop(self.connection.into_session());
    }

    /// Checks everything that the other client gets.
    fn look(&mut self) {
        assert!(self.connection.to_client().len() < ANSWER_ROOM + 16 * CLIENT_PACKET);
        self.reader.handle_come(self.now);
        let waiting = self.reader.to_client().len();
        let got = self.reader.to_client().copy_to_bytes(waiting);
        self.reader.handle_drained(self.now);
        let (mut rest, mut answers) = (&got[..], BytesMut::new());
        while let Some(frame) = frame(rest, usize::MAX).expect("only packets reach others") {
            let (packet, after) = rest.split_at(frame.length);
            if frame.kind == PacketKind::Publish {
                let publish = publish::read(&frame, packet, Version::Three).expect("it is a PUBLISH");
                let topic = std::str::from_utf8(publish.topic).expect("topics are UTF-8");
                assert!(!topic.is_empty() && !topic.contains(['+', '#', '\0']), "{topic:?}");
                assert_eq!(filter::topic(topic), Ok(()), "{topic:?}");
                match publish.qos {
                    Qos::Zero => {}
                    Qos::One => write::ack(&mut answers, PacketKind::Puback, publish.id),
                    Qos::Two => write::ack(&mut answers, PacketKind::Pubrec, publish.id),
                }
            } else if frame.kind == PacketKind::Pubrel {
                answers.extend_from_slice(&[PacketKind::Pubcomp.first_byte(), 2, packet[2], packet[3]]);
            }
            rest = after;
        }
        assert!(rest.is_empty(), "only whole packets reach others");
        self.reader.handle_client(&mut answers, Duration::ZERO).expect("it may");
    }
}

fn terms(tier: Tier, connect: Connect, session: Session) -> Terms {
    Terms {
        tier,
        name: "fuzz".into(),
        has_key: false,
        listener: Arc::new(TestListener),
        connect,
        session,
        greeting: Bytes::new(),
        scope: Scope::default(),
    }
}
