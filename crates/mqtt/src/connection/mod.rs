//! One connection after its CONNECT was accepted: the client's bytes go in, and bytes for the client come out. The
//! connection reads no clock and no socket. The program moves the bytes, and limits how many wait.

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
use crate::rights::{Payer, Scope, Tier};
use crate::subscriber::Subscriber;
use crate::subscription::Subscription;

/// What the program has decided about a client before it accepts the CONNECT.
pub struct Terms {
    /// The tier for which the broker's `Rights` are checked.
    pub tier: Tier,
    /// The topics that exist for the client.
    pub scope: Scope,
    /// The client's name in the log. If the client has a key, also the account for its retained messages.
    pub name: Arc<str>,
    /// Whether `name` is the name of a key, which has its own share of the retained messages.
    pub has_key: bool,
    /// Receives the client's commands before any subscriber gets them.
    pub listener: Arc<dyn Listener>,
    /// The client's CONNECT. Remove the will unless [`Broker::may_leave_will`] allows it.
    pub connect: Connect,
    /// The client's session from earlier connections. The default value if there is no such session, or if the client
    /// does not continue it.
    pub session: Session,
    /// The bytes to send to the client first: the CONNACK, or the part of the CONNACK that was not sent yet.
    pub greeting: Bytes,
}

/// One client's connection. After each event, the owner of the socket calls a `handle_…` function and then every
/// `poll_…` function.
pub struct ClientConnection {
    tier: Tier,
    scope: Scope,
    payer: Payer,
    listener: Arc<dyn Listener>,
    broker: Arc<Broker>,
    will: Option<Will>,
    late_will: Option<LateWill>,
    session_expiry_s: u32,
    silence: Duration,
    heard_at: Duration,
    /// The time at the last call: the connection reads no clock.
    now: Duration,
    writer: ClientWriter,
    to_client: Outbox,
    aliases: HashMap<u16, Arc<[u8]>>,
    routes: Routes,
    flood: Flood,
    /// Number of the client's bytes that were handled since its CONNECT.
    taken: u64,
    /// Marks of packets that were not handled yet, in the order of these packets.
    marks: VecDeque<Mark>,
    /// The epoch in which the packet being handled arrived; `None` before the first mark.
    arrived: Option<Epoch>,
    duplicates: Duplicates,
    subscription: Subscription,
    unacknowledged: Unacknowledged,
    deliveries: Deliveries,
    refusals: Refusals,
}

impl ClientConnection {
    /// Creates the connection of a client that was just accepted. `now` is on the clock of all later calls. Messages
    /// that waited in the client's session go out at once.
    #[must_use]
    pub fn new(terms: Terms, broker: Arc<Broker>, now: Duration) -> ClientConnection {
        let version = terms.connect.version();
        let Connect { reception, session_expiry_s, keep_alive_s, will: left, .. } = terms.connect;
        let one_and_a_half = Duration::from_millis(1500 * u64::from(keep_alive_s));
        // The client is back, so a delayed will is not published any more.
        let Session { subscription, unreleased, mut unacknowledged, .. } = terms.session;
        let subscription = subscription.unwrap_or_else(|| Subscription::new(&broker.readers));
        subscription.set_scope(terms.scope.clone());
        subscription.subscriber().come_back();
        let mut writer = ClientWriter::new(version, reception, terms.scope.clone());
        let mut to_client = Outbox::default();
        to_client.end().extend_from_slice(&terms.greeting);
        unacknowledged.begin(reception.receive_maximum);
        unacknowledged.resend(&mut writer, &mut to_client, now);
        ClientConnection {
            tier: terms.tier,
            scope: terms.scope,
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

    /// Stores a mark for a packet. Call this in the order of the packets, before the marked packet is handled.
    pub fn handle_mark(&mut self, mark: Mark) {
        // Drops the marks of handled packets. Otherwise they could pile up for ever, because the marks of some
        // packets are never looked up.
        while self.next_mark(|begins, taken| begins < taken).is_some() {}
        self.marks.push_back(mark);
    }

    /// Handles all complete packets at the head of the client's bytes, however many. Use
    /// [`ClientConnection::handle_turn`] to be fair to other clients.
    ///
    /// # Errors
    /// When the connection has ended; the packets before the error were handled.
    pub fn handle_client(&mut self, bytes: &mut BytesMut, now: Duration) -> Result<(), Ended> {
        while self.handle_turn(bytes, now)? {}
        Ok(())
    }

    /// Handles a limited number of complete packets at the head of the client's bytes. Returns whether there may be
    /// more packets.
    ///
    /// # Errors
    /// When the connection has ended; the packets before the error were handled.
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

    /// Sends waiting messages. Call this when [`Subscriber::poll_come`] is ready.
    pub fn handle_come(&mut self, now: Duration) {
        self.now = now;
        self.deliver();
    }

    /// Sends waiting messages. Call this when bytes of [`ClientConnection::to_client`] were sent, because there may
    /// be room for more.
    pub fn handle_drained(&mut self, now: Duration) {
        self.now = now;
        self.deliver();
    }

    /// Whether to call [`ClientConnection::handle_drained`] again now, although nothing was sent. True if the last
    /// call stopped because it had done all the work that is allowed in one turn.
    #[must_use]
    pub fn wants_turn(&self) -> bool {
        self.to_client.len() < KEPT_ROOM && self.deliveries.goes_on()
    }

    /// Checks how long the client was silent. Call this at the time of [`ClientConnection::poll_timeout`].
    ///
    /// # Errors
    /// `Ended::Idle` when the client was silent for too long.
    pub fn handle_timeout(&mut self, now: Duration) -> Result<(), Ended> {
        if now >= self.heard_at + self.silence { Err(Ended::Idle) } else { Ok(()) }
    }

    /// Ends the connection. Tells a client of MQTT 5 why, and publishes the client's will, at once or after its
    /// delay. When the program ends, no will is published: no client would receive it, and the client of the will has
    /// not left.
    pub fn handle_end(&mut self, why: Ended, now: Duration) {
        self.now = now;
        if why == Ended::NotKnown {
            // A client whose key was removed keeps no session.
            self.session_expiry_s = 0;
        }
        if why == Ended::GaveWay && !self.to_client.is_empty() {
            // The waiting bytes may be the reason for the end, so they are dropped. No DISCONNECT is sent after that,
            // because the client may have received only a part of the last packet.
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

    /// The bytes for the client. Call [`ClientConnection::handle_drained`] each time after sending some of them.
    pub const fn to_client(&mut self) -> &mut Outbox {
        &mut self.to_client
    }

    /// The subscribers that lag behind. Wait for them before handling more packets of this client. Empty unless the
    /// client publishes in a flood. Call this after every event.
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

    /// The queue of messages for this client that have not gone out yet. Call `handle_come` when the queue's
    /// `poll_come` is ready.
    #[must_use]
    pub fn subscriber(&self) -> Arc<Subscriber> {
        Arc::clone(self.subscription.subscriber())
    }

    /// When to call [`ClientConnection::handle_timeout`]. If no packet arrives before this time, the client was
    /// silent for too long.
    #[must_use]
    pub fn poll_timeout(&self) -> Duration {
        self.heard_at + self.silence
    }

    /// The session to store; `None` if it ends with the connection. Call this after [`ClientConnection::handle_end`],
    /// which may add a delayed will to the session.
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
                self.unacknowledged.received(ack.id, ack.is_refusal(), &mut self.writer, &mut self.to_client);
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

    /// Handles a DISCONNECT. It may change how long the session lasts, but cannot begin a session (MQTT 5, section
    /// 3.14.2.2.2).
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
        // A client that leaves many answers unread gets no PINGRESP: the client would not notice that a PINGRESP is
        // missing.
        if self.to_client.len() < CLIENT_ROOM {
            self.to_client.end().extend_from_slice(&write::PINGRESP);
        }
        Ok(())
    }

    /// Fills the outbox while there is room. First come unacknowledged messages of earlier connections, and retained
    /// messages for new subscriptions. The queue comes next. Last come the newest retained messages on topics where
    /// the client missed something.
    fn deliver(&mut self) {
        self.unacknowledged.resend(&mut self.writer, &mut self.to_client, self.now);
        self.fill();
        while self.to_client.len() < CLIENT_ROOM {
            let Some(next) = self.subscription.subscriber().next(self.unacknowledged.has_window()) else { break };
            if !next.message.is_over(self.now) {
                self.unacknowledged.send(next, Cause::Published, &mut self.writer, &mut self.to_client, self.now);
            }
        }
        self.catch_up();
    }

    fn fill(&mut self) {
        let whose = self.subscription.subscriber().id();
        let (writer, out) = (&mut self.writer, &mut self.to_client);
        self.deliveries.fill(&self.broker.retained, &mut self.unacknowledged, writer, out, whose, self.now);
    }

    /// Sends the newest retained message of each topic on which the client missed something, once its queue is empty.
    /// The client was subscribed all the time, so these are sent like new messages.
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
