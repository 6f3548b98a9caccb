//! One connection after its CONNECT was accepted: bytes of the client go in, and bytes for it come out. It reads no clock and no socket;
//! whoever pumps the bytes does, and keeps them from piling up.

mod duplicates;
mod ended;
mod flood;
mod keeping;
mod listener;
mod publishing;
mod refusals;
mod room;
mod routes;
mod sending;
mod subscribing;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use bytes::{Buf, Bytes, BytesMut};

pub use self::ended::Ended;
pub use self::subscribing::Session;
pub use listener::{CommandDecision, Epoch, Listener, Mark};

use self::duplicates::Duplicates;
use self::flood::Flood;
use self::keeping::Deliveries;
use self::refusals::Refusals;
use self::routes::Routes;
use self::sending::{Unacknowledged, Why};
use crate::broker::Broker;
use crate::frame::{Frame, Kind, Malformed, frame};
use crate::limits::{CLIENT_PACKET, CLIENT_ROOM, KEPT_ROOM, SILENCE, TURN};
use crate::outbox::Outbox;
use crate::packet::connect::Will;
use crate::packet::{ack, write};
use crate::rights::{Payer, Tier};
use crate::subscriber::{Subscriber, Subscription};

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
    /// From its CONNECT, in seconds; 0: as long as is allowed.
    pub keep_alive_s: u16,
    /// From its CONNECT, when [`Broker::may_leave_will`] allows it.
    pub will: Option<Will>,
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
    silence: Duration,
    heard_at: Duration,
    to_client: Outbox,
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
        let one_and_a_half = Duration::from_millis(1500 * u64::from(terms.keep_alive_s));
        let Session { subscription, unreleased, unacknowledged } = terms.session;
        let subscription = subscription.unwrap_or_else(|| Subscription::new(&broker.readers));
        subscription.come_back();
        let mut to_client = Outbox::default();
        to_client.end().extend_from_slice(&terms.greeting);
        unacknowledged.resend(&mut to_client);
        ClientConnection {
            tier: terms.tier,
            payer: if terms.has_key { Payer::Key(Arc::clone(&terms.name)) } else { Payer::Anybody },
            listener: terms.listener,
            broker,
            will: terms.will,
            silence: if one_and_a_half.is_zero() { SILENCE } else { one_and_a_half.min(SILENCE) },
            heard_at: now,
            to_client,
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
    pub fn handle_come(&mut self) {
        self.deliver();
    }

    /// Something of [`ClientConnection::to_client`] was taken: there may be more for it now.
    pub fn handle_drained(&mut self) {
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

    /// The connection has ended: a will that was left is published. When the program ends, nobody is to read it, and the client is not
    /// the one who has gone.
    pub fn handle_end(&mut self, why: Ended) {
        if let Some(will) = self.will.take().filter(|_| !matches!(why, Ended::Left | Ended::Closing)) {
            self.publish_will(&will);
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

    /// What is to be remembered of it, when it wants to be remembered.
    #[must_use]
    pub fn into_session(mut self) -> Session {
        let has_room = self.broker.has_room_for_away();
        self.subscription.leave(has_room);
        if !has_room && let Some(stamp) = self.unacknowledged.clear() {
            self.subscription.subscriber().miss(stamp);
        }
        let unreleased = self.duplicates.into_unreleased();
        Session { subscription: Some(self.subscription), unreleased, unacknowledged: self.unacknowledged }
    }

    fn client_packet(&mut self, frame: &Frame, packet: &[u8]) -> Result<(), Ended> {
        let body = &packet[frame.head..];
        match frame.kind {
            Kind::Publish => self.publish(frame, packet)?,
            Kind::Puback | Kind::Pubcomp => self.unacknowledged.acknowledged(ack::read(body)?, frame.kind),
            Kind::Pubrec => self.unacknowledged.received(ack::read(body)?, &mut self.to_client),
            Kind::Pubrel => self.released(ack::read(body)?),
            Kind::Subscribe => self.subscribe(body)?,
            Kind::Unsubscribe => self.unsubscribe(body)?,
            Kind::Pingreq => self.ping(body)?,
            Kind::Disconnect => return empty(body).and(Err(Ended::Left)),
            Kind::Connect | Kind::Connack | Kind::Suback | Kind::Unsuback | Kind::Pingresp => {
                return Err(Ended::Unexpected(frame.kind));
            }
        }
        Ok(())
    }

    fn ping(&mut self, body: &[u8]) -> Result<(), Ended> {
        empty(body)?;
        // Whoever reads none of many answers does not miss one.
        if self.to_client.len() < CLIENT_ROOM {
            self.to_client.end().extend_from_slice(&write::PINGRESP);
        }
        Ok(())
    }

    /// Puts before the client what there is room for: first what is kept and was asked for, then what was published, and when nothing of
    /// that is left, of what he has missed the newest that is kept.
    fn deliver(&mut self) {
        self.deliveries.fill(&self.broker.retained, &mut self.unacknowledged, &mut self.to_client);
        while self.to_client.len() < CLIENT_ROOM {
            let Some(next) = self.subscription.subscriber().next(self.unacknowledged.has_window()) else { break };
            self.unacknowledged.send(&next.message, next.qos, Why::Published, &mut self.to_client);
        }
        self.catch_up();
    }

    /// Whoever has got all that waited gets of each topic on which he has missed something the newest that is kept, as somebody who was
    /// here all the time.
    fn catch_up(&mut self) {
        let subscriber = self.subscription.subscriber();
        if !subscriber.is_empty() {
            return;
        }
        let Some(since) = subscriber.take_missed() else { return };
        for (filter, qos) in self.subscription.held() {
            self.deliveries.repeat(Arc::clone(filter), *qos, since);
        }
        self.deliveries.fill(&self.broker.retained, &mut self.unacknowledged, &mut self.to_client);
    }
}

fn empty(body: &[u8]) -> Result<(), Ended> {
    if body.is_empty() { Ok(()) } else { Err(Malformed::Trailing(body.len()).into()) }
}
