//! One connection after its CONNECT was accepted: bytes of the client go in and bytes for the router come out, and the other way
//! round. It reads no clock and no socket; whoever pumps the bytes does, and keeps each side from piling up.
//!
//! Clients are acknowledged here, at QoS 1 and 2; the router gets their messages at QoS 0, which neither piles up acknowledgements
//! in it nor ends the connection over a wrong one. A message is not safer in the router's memory than on the way to it.

mod duplicates;
mod ended;
mod flood;
mod keeping;
mod listener;
mod outstanding;
mod publishing;
mod refusals;
mod room;
mod router;
mod routes;
mod subscribing;
#[cfg(test)]
mod tests;

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use bytes::{Buf, BytesMut};

pub use self::ended::Ended;
pub use self::subscribing::Session;
pub use listener::{CommandDecision, Epoch, Listener, Mark};

use self::duplicates::Duplicates;
use self::flood::Flood;
use self::keeping::Deliveries;
use self::outstanding::Outstanding;
use self::refusals::Refusals;
use self::routes::Routes;
use self::subscribing::Subscriptions;
use crate::broker::Broker;
use crate::budget::Payer;
use crate::frame::{Frame, Kind, Malformed, frame};
use crate::limits::{CLIENT_PACKET, CLIENT_ROOM, KEPT_ROOM, PROGRAM_PACKET, QUIET, SILENCE, TURN};
use crate::outbox::Outbox;
use crate::packet::connect::Will;
use crate::packet::{ack, write};
use crate::rights::Principal;
use crate::subscriber_lag::{LagGuard, SubscriberLag};

/// With whom, and on what terms.
pub struct Terms {
    /// Who it is.
    pub principal: Principal,
    /// Who that is, for the log,
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
}

/// One connection.
pub struct ClientConnection {
    principal: Principal,
    payer: Payer,
    listener: Arc<dyn Listener>,
    broker: Arc<Broker>,
    will: Option<Will>,
    silence: Duration,
    heard_at: Duration,
    /// Messages are owed to the client; when none has come until then, none will.
    quiet_at: Option<Duration>,
    to_router: BytesMut,
    to_client: Outbox,
    routes: Routes,
    flood: Flood,
    /// It publishes in a flood, and did so then.
    flooding: Option<Duration>,
    /// How many bytes of the client were taken since its CONNECT,
    taken: u64,
    /// what is known of some packets to come, in order,
    marks: VecDeque<Mark>,
    /// and in which epoch the one came that is taken just now.
    arrived: Option<Epoch>,
    lag_guard: LagGuard,
    duplicates: Duplicates,
    subscriptions: Subscriptions,
    outstanding: Outstanding,
    deliveries: Deliveries,
    /// Whether the router is to answer a PINGREQ.
    is_pinged: bool,
    refusals: Refusals,
}

impl ClientConnection {
    /// A connection that was just accepted, `now` on the clock of all later calls. A remembered session is subscribed again at once:
    /// a new router does not know of it, and the old one would not end such a subscription otherwise.
    #[must_use]
    pub fn new(terms: Terms, broker: Arc<Broker>, now: Duration) -> ClientConnection {
        let one_and_a_half = Duration::from_millis(1500 * u64::from(terms.keep_alive_s));
        let lag_guard = LagGuard::open(&broker.readers);
        let payer = match terms.principal {
            Principal::Program => Payer::Program,
            Principal::Client(tier) if terms.has_key => Payer::Key { name: Arc::clone(&terms.name), tier },
            Principal::Client(_) => Payer::Anybody,
        };
        let mut connection = ClientConnection {
            lag_guard,
            flood: Flood::default(),
            flooding: None,
            taken: 0,
            marks: VecDeque::new(),
            arrived: None,
            principal: terms.principal,
            payer,
            listener: terms.listener,
            broker,
            will: terms.will,
            silence: if one_and_a_half.is_zero() { SILENCE } else { one_and_a_half.min(SILENCE) },
            heard_at: now,
            quiet_at: None,
            to_router: BytesMut::new(),
            to_client: Outbox::default(),
            routes: Routes::default(),
            duplicates: Duplicates::default(),
            subscriptions: Subscriptions::default(),
            outstanding: Outstanding::default(),
            deliveries: Deliveries::default(),
            is_pinged: false,
            refusals: Refusals::new(terms.name),
        };
        connection.resume(terms.session);
        connection
    }

    /// To be told in order, before the packet is taken that begins there.
    pub fn handle_mark(&mut self, mark: Mark) {
        // Those of packets that were taken are needed no more: a client may say for ever what nobody looks them up for.
        while self.next_mark(|begins, taken| begins < taken).is_some() {}
        self.marks.push_back(mark);
    }

    /// Takes all whole packets from the head of what the client sent, until the router is asked more than it has answered.
    ///
    /// # Errors
    /// When the connection has come to its end; what was before that is done.
    pub fn handle_client(&mut self, bytes: &mut BytesMut, now: Duration) -> Result<(), Ended> {
        while self.handle_turn(bytes, now)? && !self.subscriptions.has_asked_much() {}
        Ok(())
    }

    /// Takes some whole packets from the head of what the client sent, no more than are taken at once; whether there may be more.
    ///
    /// # Errors
    /// When the connection has come to its end; what was before that is done.
    pub fn handle_turn(&mut self, bytes: &mut BytesMut, now: Duration) -> Result<bool, Ended> {
        let limit = if self.principal == Principal::Program { PROGRAM_PACKET } else { CLIENT_PACKET };
        let (mut read, mut packets) = (0, 0);
        let outcome = loop {
            if packets == TURN || self.routes.take_piece() || self.subscriptions.has_asked_much() {
                break Ok(true);
            }
            match frame(&bytes[read..], limit) {
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

    /// Takes all whole packets from the head of what the router sent.
    ///
    /// # Errors
    /// When the router is not itself.
    pub fn handle_router(&mut self, bytes: &mut BytesMut) -> Result<(), Ended> {
        let outcome = self.router_packets(bytes);
        self.deliver();
        outcome
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
        if self.quiet_at.is_some_and(|quiet_at| now >= quiet_at) {
            self.catch_up();
        }
        if now >= self.heard_at + self.silence { Err(Ended::Idle) } else { Ok(()) }
    }

    /// The connection has ended: a will that was left is put before the router, if it still can be. When the program ends, nobody is
    /// to read it, and the client is not the one who has gone.
    pub fn handle_end(&mut self, why: Ended) {
        if let Some(will) = self.will.take().filter(|_| !matches!(why, Ended::Left | Ended::Closing)) {
            self.publish_will(&will);
        }
    }

    /// What is for the router.
    pub const fn to_router(&mut self) -> &mut BytesMut {
        &mut self.to_router
    }

    /// What is for the client.
    pub const fn to_client(&mut self) -> &mut Outbox {
        &mut self.to_client
    }

    /// What is for the router, and what is for the client. All that is for the router is to be sent before the connection to it is
    /// closed, with nothing in front of that: a DISCONNECT could end the router.
    pub const fn outgoing(&mut self) -> (&mut BytesMut, &mut Outbox) {
        (&mut self.to_router, &mut self.to_client)
    }

    /// To be asked whenever something has happened, with the time: the subscribers whom this client has to wait for before anything
    /// more of it is taken; none, when it has not published in a flood. The program itself waits for nobody.
    pub fn poll_behind(&mut self, now: Duration) -> Vec<Arc<SubscriberLag>> {
        self.note_room(now);
        let is_owed = !self.lag_guard.lag().is_even() && self.wants_router() && self.outstanding.has_room();
        self.quiet_at = is_owed.then(|| self.quiet_at.unwrap_or(now + QUIET));
        let passed = self.routes.take_passed();
        let is_flood = self.flood.handle_passed(passed, now) && self.principal != Principal::Program;
        self.flooding = is_flood.then_some(now);
        if !is_flood {
            return Vec::new();
        }
        let still = self.flood.still(now);
        let mut behind = self.routes.behind(now);
        if still.is_zero() {
            behind.retain(|reader| !reader.forgive(now, still));
        }
        behind
    }

    /// What was published for this client and has not come yet.
    #[must_use]
    pub fn lag(&self) -> Arc<SubscriberLag> {
        self.lag_guard.lag()
    }

    /// When the client was silent for too long, or the router for so long that nothing more will come, if they stay so.
    #[must_use]
    pub fn poll_timeout(&self) -> Duration {
        let idle_at = self.heard_at + self.silence;
        self.quiet_at.map_or(idle_at, |quiet_at| quiet_at.min(idle_at))
    }

    /// What is to be remembered of it, when it wants to be remembered.
    #[must_use]
    pub fn into_session(self) -> Session {
        self.subscriptions.into_session(self.duplicates, self.outstanding, self.lag_guard)
    }

    fn client_packet(&mut self, frame: &Frame, packet: &[u8]) -> Result<(), Ended> {
        let body = &packet[frame.head..];
        match frame.kind {
            Kind::Publish => self.publish(frame, packet)?,
            Kind::Puback => self.acknowledged(ack::read(body)?),
            Kind::Pubrel => self.released(ack::read(body)?),
            // Nothing goes out at QoS 2, so that these answer nothing.
            Kind::Pubrec | Kind::Pubcomp => drop(ack::read(body)?),
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

    /// The client is answered here, at once; the router gets one at a time, that it may know that somebody is there.
    fn ping(&mut self, body: &[u8]) -> Result<(), Ended> {
        empty(body)?;
        // Whoever reads none of many answers does not miss one.
        if self.to_client.len() < CLIENT_ROOM {
            self.to_client.end().extend_from_slice(&write::PINGRESP);
        }
        if !self.is_pinged {
            self.to_router.extend_from_slice(&write::PINGREQ);
            self.is_pinged = true;
        }
        Ok(())
    }

    /// What of its messages was lost is known now: of each topic it gets the newest that is kept, as somebody who was here all the time.
    fn catch_up(&mut self) {
        self.quiet_at = None;
        let Some(since) = self.lag_guard.lag().settle() else { return };
        for (filter, qos) in self.subscriptions.held() {
            self.deliveries.repeat(Arc::clone(filter), qos, since);
        }
        self.deliver();
    }

    fn deliver(&mut self) {
        self.deliveries.fill(&self.broker.retained, &mut self.to_client);
    }
}

fn empty(body: &[u8]) -> Result<(), Ended> {
    if body.is_empty() { Ok(()) } else { Err(Malformed::Trailing(body.len()).into()) }
}
