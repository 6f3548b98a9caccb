//! One connection after its CONNECT was accepted: bytes of the client go in, and bytes for it come out. It reads no clock and no socket;
//! whoever pumps the bytes does, and keeps them from piling up.

mod client_writer;
mod duplicates;
mod ended;
mod flood;
mod keeping;
mod listener;
mod publishing;
pub(crate) mod refusals;
mod room;
mod routes;
mod sending;
mod session;
mod subscribing;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use bytes::{Buf, Bytes, BytesMut};

pub use self::ended::Ended;
pub use self::session::{LateWill, Session};
pub use listener::{AnswerTo, CommandDecision, Epoch, Listener, Mark, Said};

use self::client_writer::ClientWriter;
use self::duplicates::Duplicates;
use self::flood::Flood;
use self::keeping::Deliveries;
use self::refusals::Refusals;
use self::routes::Routes;
use self::sending::{Cause, Unacknowledged};
use crate::broker::Broker;
use crate::filter;
use crate::frame::{Frame, Malformed, PacketKind, frame};
use crate::limits::{CLIENT_PACKET, CLIENT_ROOM, KEPT_ROOM, SILENCE, TURN};
use crate::outbox::Outbox;
use crate::packet::ack::{self, Ack};
use crate::packet::connect::{Connect, FOR_EVER_S, Will};
use crate::packet::{disconnect, write};
use crate::rights::{Payer, Tier};
use crate::subscriber::Subscriber;
use crate::subscription::Subscription;

/// With whom, and on what terms.
pub struct Terms {
    /// What it may do.
    pub tier: Tier,
    /// Who it is, for the log,
    pub name: Arc<str>,
    /// and whether that is the name of a key, which has its shares.
    pub has_key: bool,
    /// Who hears its commands.
    pub listener: Arc<dyn Listener>,
    /// How it came; its will only when [`Broker::may_leave_will`] allows it.
    pub connect: Connect,
    /// What is remembered of it from earlier connections.
    pub session: Session,
    /// What it is told first: the CONNACK, or the rest of it.
    pub greeting: Bytes,
}

/// One connection.
pub struct ClientConnection {
    tier: Tier,
    payer: Payer,
    listener: Arc<dyn Listener>,
    broker: Arc<Broker>,
    will: Option<Will>,
    late_will: Option<LateWill>,
    session_expiry_s: u32,
    silence: Duration,
    heard_at: Duration,
    /// When it was last told what time it is.
    now: Duration,
    writer: ClientWriter,
    to_client: Outbox,
    /// The topics to which the client gave a number.
    aliases: HashMap<u16, Arc<[u8]>>,
    routes: Routes,
    flood: Flood,
    /// How many bytes of the client were taken since its CONNECT,
    taken: u64,
    /// what is known of some packets to come, in order,
    marks: VecDeque<Mark>,
    /// and in which epoch the one came that is taken just now.
    arrived: Option<Epoch>,
    duplicates: Duplicates,
    subscription: Subscription,
    unacknowledged: Unacknowledged,
    deliveries: Deliveries,
    refusals: Refusals,
}

impl ClientConnection {
    /// A connection that was just accepted, `now` on the clock of all later calls. What waited for a remembered session comes at once.
    #[must_use]
    pub fn new(terms: Terms, broker: Arc<Broker>, now: Duration) -> ClientConnection {
        let version = terms.connect.version();
        let Connect { reception, session_expiry_s, keep_alive_s, will: left, .. } = terms.connect;
        let one_and_a_half = Duration::from_millis(1500 * u64::from(keep_alive_s));
        // A will that waits is not published any more.
        let Session { subscription, unreleased, mut unacknowledged, .. } = terms.session;
        let subscription = subscription.unwrap_or_else(|| Subscription::new(&broker.readers));
        subscription.subscriber().come_back();
        let mut writer = ClientWriter::new(version, reception);
        let mut to_client = Outbox::default();
        to_client.end().extend_from_slice(&terms.greeting);
        unacknowledged.begin(reception.receive_maximum);
        unacknowledged.resend(&mut writer, &mut to_client, now);
        ClientConnection {
            tier: terms.tier,
            payer: if terms.has_key { Payer::Key(Arc::clone(&terms.name)) } else { Payer::Anybody },
            listener: terms.listener,
            broker,
            will: left,
            late_will: None,
            silence: if one_and_a_half.is_zero() { SILENCE } else { one_and_a_half.min(SILENCE) },
            session_expiry_s,
            heard_at: now,
            now,
            writer,
            to_client,
            aliases: HashMap::new(),
            routes: Routes::default(),
            flood: Flood::default(),
            taken: 0,
            marks: VecDeque::new(),
            arrived: None,
            duplicates: Duplicates::resumed(unreleased),
            subscription,
            unacknowledged,
            deliveries: Deliveries::default(),
            refusals: Refusals::new(terms.name),
        }
    }

    /// To be told in order, before the packet is taken that begins there.
    pub fn handle_mark(&mut self, mark: Mark) {
        // Those of packets that were taken are needed no more: a client may say for ever what nobody looks them up for.
        while self.next_mark(|begins, taken| begins < taken).is_some() {}
        self.marks.push_back(mark);
    }

    /// Takes all whole packets from the head of what the client sent.
    ///
    /// # Errors
    /// When the connection has come to its end; what was before that is done.
    pub fn handle_client(&mut self, bytes: &mut BytesMut, now: Duration) -> Result<(), Ended> {
        while self.handle_turn(bytes, now)? {}
        Ok(())
    }

    /// Takes some whole packets from the head of what the client sent, no more than are taken at once; whether there may be more.
    ///
    /// # Errors
    /// When the connection has come to its end; what was before that is done.
    pub fn handle_turn(&mut self, bytes: &mut BytesMut, now: Duration) -> Result<bool, Ended> {
        self.now = now;
        let (mut read, mut packets) = (0, 0);
        let outcome = loop {
            if packets == TURN || self.routes.take_piece() {
                break Ok(true);
            }
            match frame(&bytes[read..], CLIENT_PACKET) {
                Ok(None) => break Ok(false),
                Err(wrong) => break Err(wrong.into()),
                Ok(Some(frame)) => {
                    let packet = &bytes[read..read + frame.length];
                    let outcome = self.client_packet(&frame, packet);
                    (read, packets) = (read + frame.length, packets + 1);
                    self.taken += frame.length as u64;
                    if let Err(ended) = outcome {
                        break Err(ended);
                    }
                }
            }
        };
        if read > 0 {
            bytes.advance(read);
            self.heard_at = now;
        }
        self.routes.settle();
        self.deliver();
        outcome
    }

    /// Something has come for the client: [`Subscriber::poll_come`].
    pub fn handle_come(&mut self, now: Duration) {
        self.now = now;
        self.deliver();
    }

    /// Something of [`ClientConnection::to_client`] was taken: there may be more for it now.
    pub fn handle_drained(&mut self, now: Duration) {
        self.now = now;
        self.deliver();
    }

    /// Whether [`ClientConnection::handle_drained`] has more to do now, though nothing was taken: the rest waits for its turn.
    #[must_use]
    pub fn wants_turn(&self) -> bool {
        self.to_client.len() < KEPT_ROOM && self.deliveries.goes_on()
    }

    /// The time of [`ClientConnection::poll_timeout`] may have come.
    ///
    /// # Errors
    /// `Ended::Idle` when the client was silent for too long.
    pub fn handle_timeout(&mut self, now: Duration) -> Result<(), Ended> {
        if now >= self.heard_at + self.silence { Err(Ended::Idle) } else { Ok(()) }
    }

    /// The connection has ended: one of MQTT 5 is told why, and a will that was left is published, at once or when its time has come. When
    /// the program ends, nobody is to read it, and the client is not the one who has gone.
    pub fn handle_end(&mut self, why: Ended, now: Duration) {
        self.now = now;
        if why == Ended::NotKnown {
            // Nobody is remembered whose key is gone.
            self.session_expiry_s = 0;
        }
        if why == Ended::GaveWay && !self.to_client.is_empty() {
            // What waited for it may be why; and behind half a message nothing can be said.
            self.to_client.clear();
        } else if let Some(reason) = why.reason() {
            self.writer.disconnect(reason, &why.to_string(), &mut self.to_client);
        }
        let will = self.will.take().filter(|_| !matches!(why, Ended::Left | Ended::Closing));
        let Some(will) = will else { return };
        if !self.may_publish(&will) {
            return;
        }
        let delay_s = will.delay_s.min(self.session_expiry_s);
        let due = now + Duration::from_secs(u64::from(delay_s));
        let late = LateWill { due, will, payer: self.payer.clone(), broker: Arc::clone(&self.broker) };
        if delay_s > 0 {
            self.late_will = Some(late);
        } else {
            late.publish(now);
        }
    }

    /// What is for the client.
    pub const fn to_client(&mut self) -> &mut Outbox {
        &mut self.to_client
    }

    /// To be asked whenever something has happened, with the time: the subscribers whom this client has to wait for before anything
    /// more of it is taken; none, when it has not published in a flood.
    pub fn poll_behind(&mut self, now: Duration) -> Vec<Arc<Subscriber>> {
        self.note_room(now);
        let passed = self.routes.take_passed();
        if !self.flood.handle_passed(passed, now) {
            return Vec::new();
        }
        let still = self.flood.still(now);
        let mut behind = self.routes.behind(now);
        if still.is_zero() {
            behind.retain(|reader| !reader.forgive(now, still));
        }
        behind
    }

    /// What was published for this client and has not gone out yet.
    #[must_use]
    pub fn subscriber(&self) -> Arc<Subscriber> {
        Arc::clone(self.subscription.subscriber())
    }

    /// When the client was silent for too long, if it stays so.
    #[must_use]
    pub fn poll_timeout(&self) -> Duration {
        self.heard_at + self.silence
    }

    /// What is to be remembered of it; `None`: nothing.
    #[must_use]
    pub fn into_session(mut self) -> Option<Session> {
        if self.session_expiry_s == 0 {
            return None;
        }
        let has_room = self.broker.has_room_for_away();
        self.subscription.subscriber().go_away(has_room);
        if !has_room && let Some(stamp) = self.unacknowledged.clear() {
            self.subscription.subscriber().miss(stamp);
        }
        let lasts = Duration::from_secs(u64::from(self.session_expiry_s));
        Some(Session {
            subscription: Some(self.subscription),
            unreleased: self.duplicates.into_unreleased(),
            unacknowledged: self.unacknowledged,
            expires_at: (self.session_expiry_s != FOR_EVER_S).then_some(self.now + lasts),
            will: self.late_will,
        })
    }

    fn client_packet(&mut self, frame: &Frame, packet: &[u8]) -> Result<(), Ended> {
        let body = &packet[frame.head..];
        match frame.kind {
            PacketKind::Publish => self.publish(frame, packet)?,
            PacketKind::Puback | PacketKind::Pubcomp => {
                self.unacknowledged.acknowledged(self.ack(frame.kind, body)?.id, frame.kind)
            }
            PacketKind::Pubrec => {
                let ack = self.ack(frame.kind, body)?;
                self.unacknowledged.received(ack.id, ack.is_refusal(), (&mut self.writer, &mut self.to_client));
            }
            PacketKind::Pubrel => self.released(self.ack(frame.kind, body)?.id),
            PacketKind::Subscribe => self.subscribe(body)?,
            PacketKind::Unsubscribe => self.unsubscribe(body)?,
            PacketKind::Pingreq => self.ping(body)?,
            PacketKind::Disconnect => return Err(self.leave(body)),
            PacketKind::Connect
            | PacketKind::Connack
            | PacketKind::Suback
            | PacketKind::Unsuback
            | PacketKind::Pingresp
            | PacketKind::Auth => {
                return Err(Ended::Unexpected(frame.kind));
            }
        }
        Ok(())
    }

    fn ack(&self, kind: PacketKind, body: &[u8]) -> Result<Ack, Malformed> {
        ack::read(body, kind, self.writer.version())
    }

    /// A DISCONNECT: why the connection ends.
    fn leave(&mut self, body: &[u8]) -> Ended {
        let disconnect = match disconnect::read(body, self.writer.version()) {
            Ok(disconnect) => disconnect,
            Err(wrong) => return wrong.into(),
        };
        if let Some(expiry_s) = disconnect.session_expiry_s {
            if self.session_expiry_s == 0 && expiry_s > 0 {
                return Malformed::SessionExpiry.into();
            }
            self.session_expiry_s = expiry_s;
        }
        if disconnect.reason == 0 { Ended::Left } else { Ended::LeftWithWill }
    }

    fn ping(&mut self, body: &[u8]) -> Result<(), Ended> {
        empty(body)?;
        // Whoever reads none of many answers does not miss one.
        if self.to_client.len() < CLIENT_ROOM {
            self.to_client.end().extend_from_slice(&write::PINGRESP);
        }
        Ok(())
    }

    /// Puts before the client what there is room for: first what it did not acknowledge before, and what is kept and was asked for, then
    /// what was published, and when nothing of that is left, of what he has missed the newest that is kept.
    fn deliver(&mut self) {
        self.unacknowledged.resend(&mut self.writer, &mut self.to_client, self.now);
        self.fill();
        while self.to_client.len() < CLIENT_ROOM {
            let Some(next) = self.subscription.subscriber().next(self.unacknowledged.has_window()) else { break };
            if !next.message.is_over(self.now) {
                self.unacknowledged.send(next, Cause::Published, (&mut self.writer, &mut self.to_client), self.now);
            }
        }
        self.catch_up();
    }

    fn fill(&mut self) {
        let client = (&mut self.writer, &mut self.to_client);
        let whose = self.subscription.subscriber().id();
        self.deliveries.fill(&self.broker.retained, &mut self.unacknowledged, client, (whose, self.now));
    }

    /// Whoever has got all that waited gets of each topic on which he has missed something the newest that is kept, as somebody who was
    /// here all the time.
    fn catch_up(&mut self) {
        let subscriber = self.subscription.subscriber();
        if !subscriber.is_empty() {
            return;
        }
        let Some(since) = subscriber.take_missed() else { return };
        for (filter, grant) in self.subscription.held().iter().filter(|(filter, _)| filter::shared(filter).is_none()) {
            self.deliveries.repeat(Arc::clone(filter), *grant, since);
        }
        self.fill();
    }
}

fn empty(body: &[u8]) -> Result<(), Ended> {
    if body.is_empty() { Ok(()) } else { Err(Malformed::Trailing(body.len()).into()) }
}
