//! Turns a new connection into a client. On the hearing thread, the client introduces itself, and its input is
//! searched for a STOP before anything else is decided. On other threads, the client is admitted and served by
//! `client_io`, or is told why it is refused. The gate decides what a client may do.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::net::IpAddr;
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use bytes::{Bytes, BytesMut};
use tokio::io::{AsyncWrite, AsyncWriteExt};
use tokio::runtime::Handle;
use tokio::sync::oneshot;

use super::client_ids::{ClientIds, Memory, Name};
use super::client_io::{self, ClientEnds, Running};
use super::halls::Halls;
use super::hearing::Hearing;
use super::identity::{Identity, Unknown};
use super::incoming::{ClientReader, IncomingConnection, Origin, Writer};
use super::introduction::{SentAway, introduction};
use super::limits::{CONNECT_TIME, LEAVING, WAITING};
use super::read_ahead::{Left, Pool, Taker, read_ahead};
use crate::access::{Attempts, Network};
use crate::api::door;
use crate::doors::connection_limits::{ConnectionBudget, PendingConnection, PendingConnections, SessionLimits};
use crate::doors::log_throttle::LogThrottle;
use crate::runtime::clock::Clock;
use mqtt_gate::limits::{CONNECT, KEEP_ALIVE_S};
use mqtt_gate::packet::Version;
use mqtt_gate::packet::connect::{self, Connect};
use mqtt_gate::packet::write::{self, Connack, Welcome};
use mqtt_gate::{Broker, ClientConnection, Ended, Listener, Terms};
use mqtt_gate::{PacketKind, frame};

/// Maximum time for a refused client to read the reason.
const FAREWELL: Duration = Duration::from_secs(1);

/// Maximum length of a client id in bytes. The standard requires at least 23.
const CLIENT_ID: usize = 256;

#[derive(Clone)]
pub struct Clients(Arc<Rooms>);

struct Rooms {
    broker: Arc<Broker>,
    halls: Halls,
    pending: PendingConnections,
    leaving: PendingConnections,
    sessions: SessionLimits,
    pool: Pool,
    ids: ClientIds,
    attempts: Attempts,
    /// Limits how often wrong passwords are logged.
    wrong: LogThrottle,
    clock: Clock,
}

struct IdentifiedClient {
    connect: Connect,
    has_new_id: bool,
    identity: Identity,
    origin: Origin,
}

impl Clients {
    pub fn new(broker: Arc<Broker>, halls: impl Into<Halls>) -> Clients {
        Clients::with_budget(broker, halls, ConnectionBudget::default())
    }

    pub fn with_budget(broker: Arc<Broker>, halls: impl Into<Halls>, budget: ConnectionBudget) -> Clients {
        Clients(Arc::new(Rooms {
            broker,
            halls: halls.into(),
            pending: PendingConnections::new(budget.scaled(WAITING)),
            leaving: PendingConnections::new(budget.scaled(LEAVING)),
            sessions: SessionLimits::new(budget),
            pool: Pool::default(),
            ids: ClientIds::default(),
            attempts: Attempts::default(),
            wrong: LogThrottle::default(),
            clock: Clock::default(),
        }))
    }

    /// Counts a connection from this address as pending until the client is admitted or refused. Another pending
    /// connection may be evicted for it.
    pub(super) fn admit_pending(&self, from: IpAddr) -> PendingConnection {
        self.0.pending.admit(from, Arc::default())
    }

    /// Evicts some pending connections when the system has no more descriptors. Returns how many were evicted.
    pub(super) fn evict_some(&self) -> usize {
        self.0.pending.evict_some()
    }

    /// Forgets absent clients when their remembered time is over, and publishes their last wills. Never returns.
    pub(super) async fn keep(&self) {
        self.0.ids.keep().await;
    }

    /// Reads from a new client on the hearing thread until the connection ends. Meanwhile the client is served on
    /// `work`.
    pub(super) async fn attend(self, incoming: IncomingConnection, waiting: PendingConnection, running: Running, work: Handle) {
        let from = incoming.origin.from;
        let sent = self.converse(incoming, waiting, running, work).await;
        tracing::debug!(%from, why = %sent, "an MQTT connection has ended");
    }

    async fn converse(
        &self,
        incoming: IncomingConnection,
        waiting: PendingConnection,
        running: Running,
        work: Handle,
    ) -> SentAway {
        let IncomingConnection { mut reader, mut writer, origin } = incoming;
        let (from, mut heard) = (origin.from, BytesMut::new());
        let introduced = tokio::select! {
            biased;
            // `biased`: bytes that have arrived already are read before the connection can be evicted.
            introduced = self.introduced(&mut reader, &mut heard, &origin) => introduced,
            () = waiting.evicted() => Err(SentAway::GaveWay),
        };
        let (mut connect, identity) = match introduced {
            Ok(known) => known,
            Err(sent) => {
                return self.send_away(IncomingConnection { reader, writer, origin }, &heard, waiting, sent, work).await;
            }
        };
        let version = connect.version();
        let has_new_id = version == Version::Five && connect.client_id.is_empty();
        if has_new_id {
            connect.client_id = format!("hallsweep-{:016x}", RandomState::new().build_hasher().finish());
        }
        let known = IdentifiedClient { connect, has_new_id, identity, origin };
        let (feeder, taker) = read_ahead(&self.0.pool);
        let listener = known.identity.listener(&self.0.halls, from);
        let mut hearing = Hearing::new(version, Arc::clone(&listener), feeder, self.0.clock, work.clone());
        hearing.begin(&heard).await;
        drop(heard);
        let greeted = self.greet(&mut writer, &known);
        // A STOP in the bytes so far has halted the robot by now. Only now are other faults checked. Until then the
        // connection counts as pending.
        let (admitted, is_admitted) = oneshot::channel();
        let served = work.spawn(self.clone().serve(writer, taker, known, greeted, listener, admitted, running));
        let aborted = served.abort_handle();
        let mut sent = pin!(async {
            hearing.run(reader).await;
            served.await.unwrap_or(SentAway::GaveWay)
        });
        tokio::select! {
            sent = &mut sent => return sent,
            _ = is_admitted => {}
            () = waiting.evicted() => aborted.abort(),
        }
        drop(waiting);
        sent.await
    }

    /// Sends the greeting now if the client will certainly be admitted; returns the number of bytes sent. The
    /// greeting does not wait for the other threads, where many clients may be ahead of this one. Most clients send
    /// nothing before the greeting, not even STOP (safety S7).
    fn greet(&self, writer: &mut Writer, known: &IdentifiedClient) -> usize {
        // The greeting depends on what is remembered if the client resumes a session, or wants to be remembered over
        // MQTT 5. Such a client cannot be greeted yet.
        let is_known =
            known.connect.clean_start && (known.connect.version() == Version::Three || known.connect.session_expiry_s == 0);
        if !is_known || self.refusal(known).is_some() {
            return 0;
        }
        let mut cx = Context::from_waker(Waker::noop());
        match Pin::new(writer).poll_write(&mut cx, &known.greeting(false, true)) {
            Poll::Ready(Ok(told)) => told,
            // The greeting is sent later, unless the client has left.
            Poll::Ready(Err(_)) | Poll::Pending => 0,
        }
    }

    /// Tells a new client why it is refused. If the client has the right to stop, its input is searched for a STOP
    /// before and for a while afterwards (safety S8).
    async fn send_away(
        &self,
        incoming: IncomingConnection,
        heard: &[u8],
        waiting: PendingConnection,
        sent: SentAway,
        work: Handle,
    ) -> SentAway {
        let IncomingConnection { reader, writer, origin } = incoming;
        let from = origin.from;
        let stranger = tokio::select! {
            biased;
            stranger = self.stranger(&sent, heard, &origin) => stranger,
            // A client that waits for the answer to a wrong password may be evicted.
            () = waiting.evicted() => return work.spawn(self.clone().tell(from, writer, SentAway::GaveWay)).await.unwrap_or(SentAway::GaveWay),
        };
        let Some((identity, version)) = stranger else {
            return work.spawn(self.clone().tell(from, writer, sent)).await.unwrap_or(SentAway::Ended(Ended::Gone));
        };
        let (feeder, taker) = read_ahead(&self.0.pool);
        taker.leave(Left::HearsOn);
        let listener = identity.listener(&self.0.halls, from);
        let mut hearing = Hearing::new(version, listener, feeder, self.0.clock, work.clone());
        hearing.begin(heard).await;
        let told = work.spawn(self.clone().tell(from, writer, sent));
        tokio::select! {
            () = hearing.run(reader) => {}
            () = waiting.evicted() => {}
        }
        told.await.unwrap_or(SentAway::Ended(Ended::Gone))
    }

    /// Returns the identity and protocol version of a sender whose CONNECT cannot be accepted. Returns `None` if the
    /// credentials are not valid either, or if the refusal has another reason.
    async fn stranger(&self, sent: &SentAway, heard: &[u8], origin: &Origin) -> Option<(Identity, Version)> {
        let (SentAway::Unfit(_) | SentAway::Malformed(_) | SentAway::First(_)) = sent else { return None };
        let connect = frame(heard, CONNECT).ok().flatten().filter(|frame| frame.kind == PacketKind::Connect);
        let credentials = connect.map(|frame| connect::credentials(&heard[frame.head..frame.length])).unwrap_or_default();
        self.identity(&credentials, origin).await.ok().map(|identity| (identity, credentials.version))
    }

    /// Reads the CONNECT of a new client; returns it with the identity if the credentials are valid. After a wrong
    /// password the refusal is delayed, each time longer.
    async fn introduced(
        &self,
        reader: &mut ClientReader,
        heard: &mut BytesMut,
        origin: &Origin,
    ) -> Result<(Connect, Identity), SentAway> {
        let introduced = tokio::time::timeout(CONNECT_TIME, introduction(reader, heard)).await;
        let connect = introduced.map_err(|_| SentAway::Slow)??;
        let identity = self.identity(&connect.credentials, origin).await?;
        Ok((connect, identity))
    }

    async fn identity(&self, credentials: &connect::Credentials, origin: &Origin) -> Result<Identity, SentAway> {
        let version = credentials.version;
        match Identity::of(credentials, origin) {
            Ok(identity) => Ok(identity),
            Err(Unknown::Nothing) => Err(SentAway::Refused(version, Welcome::NotAllowed)),
            Err(Unknown::Wrong) => {
                let delay = self.0.attempts.wrong(Network::of(origin.from), self.0.clock.since_start());
                if let Some(shown) = self.0.wrong.one_more() {
                    let (from, delay_ms) = (origin.from, delay.as_millis());
                    tracing::warn!(%from, delay_ms, shown, "MQTT clients sent a wrong name or password; this is the latest");
                }
                tokio::time::sleep(delay).await;
                Err(SentAway::Refused(version, Welcome::Login))
            }
        }
    }

    fn refusal(&self, IdentifiedClient { connect, identity, .. }: &IdentifiedClient) -> Option<Welcome> {
        let is_nameless = connect.client_id.is_empty() && !connect.clean_start;
        if is_nameless || connect.client_id.len() > CLIENT_ID {
            return Some(Welcome::ClientId);
        }
        let scope = identity.scope(self.0.halls.topics());
        let is_allowed = |topic: &str| scope.contains(topic) && self.0.broker.may_leave_will(identity.tier(), topic);
        connect.will.as_ref().filter(|will| !is_allowed(&will.topic)).map(|_| Welcome::NotAllowed)
    }

    /// Serves a client until its connection ends, and returns the reason. `greeted` is the number of bytes of the
    /// greeting that were sent already. `admitted` is dropped when the client has a session.
    async fn serve(
        self,
        writer: Writer,
        ahead: Taker,
        known: IdentifiedClient,
        greeted: usize,
        listener: Arc<dyn Listener>,
        admitted: oneshot::Sender<()>,
        running: Running,
    ) -> SentAway {
        if let Some(welcome) = self.refusal(&known) {
            ahead.leave(Left::HearsRest);
            return self.tell(known.origin.from, writer, SentAway::Refused(known.connect.version(), welcome)).await;
        }
        let now = self.0.clock.since_start();
        let permit = Arc::new(self.0.sessions.take(known.identity.owner(), now));
        let _connected = self.0.halls.figures().connected(door::MQTT);
        drop(admitted);
        let name = Name { who: known.identity.name(), client: known.connect.client_id.clone() };
        let memory = Memory { resumes: !known.connect.clean_start, wants: known.connect.session_expiry_s > 0 };
        // The greeting must say whether the session will be remembered, so the id is taken first.
        let (id, session) = tokio::select! {
            biased;
            taken = self.0.ids.take(name.clone(), memory) => taken,
            () = permit.evicted() => return self.tell(known.origin.from, writer, SentAway::Ended(Ended::GaveWay)).await,
        };
        tracing::debug!(from = %known.origin.from, who = %name.who, client = name.client, "an MQTT client has connected");
        let greeting = known.greeting(session.is_some(), id.is_remembered());
        let keep_alive_s = known.keep_alive_s().unwrap_or(known.connect.keep_alive_s);
        let IdentifiedClient { connect, identity, origin, .. } = known;
        let terms = Terms {
            tier: identity.tier(),
            scope: identity.scope(self.0.halls.topics()),
            name: identity.name(),
            has_key: identity.has_key(),
            listener,
            connect: Connect { keep_alive_s, ..connect },
            session: session.unwrap_or_default(),
            greeting: Bytes::copy_from_slice(&greeting[greeted..]),
        };
        let connection = ClientConnection::new(terms, Arc::clone(&self.0.broker), now);
        let ends = ClientEnds { client: writer, ahead, permit, id, leaving: self.0.leaving.clone(), from: origin.from };
        SentAway::Ended(client_io::run(connection, ends, running, &identity, &origin.access, self.0.clock).await)
    }

    /// Tells a client why it is refused. Sending takes at most `FAREWELL`, because the client may not read.
    async fn tell(self, from: IpAddr, mut writer: Writer, sent: SentAway) -> SentAway {
        let answer = match &sent {
            SentAway::Refused(Version::Three, welcome) => write::connack(*welcome, false).to_vec(),
            SentAway::Refused(Version::Five, welcome) => {
                Connack { words: Some(welcome.in_words()), ..Connack::of(welcome.reason()) }.written(u32::MAX)
            }
            SentAway::Unfit(unfit) => unfit.answer(),
            SentAway::Slow
            | SentAway::GaveWay
            | SentAway::First(_)
            | SentAway::Malformed(_)
            | SentAway::Broken(_)
            | SentAway::Ended(_) => Vec::new(),
        };
        let farewell = async {
            let _ = writer.write_all(&answer).await;
            let _ = writer.shutdown().await;
        };
        let _ = tokio::time::timeout(FAREWELL, self.0.leaving.linger(from, farewell)).await;
        sent
    }
}

impl IdentifiedClient {
    /// Returns the greeting of an admitted client. `is_remembered` says whether the client will be remembered after
    /// it has left; it matters only for a client that asked for that.
    fn greeting(&self, session_present: bool, is_remembered: bool) -> Vec<u8> {
        let Connect { client_id, reception, session_expiry_s, .. } = &self.connect;
        if self.connect.version() == Version::Three {
            return write::connack(Welcome::Accepted, session_present).to_vec();
        }
        let connack = Connack {
            session_present,
            session_expiry_s: (*session_expiry_s > 0 && !is_remembered).then_some(0),
            assigned_id: self.has_new_id.then_some(&**client_id),
            keep_alive_s: self.keep_alive_s(),
            ..Connack::of(Welcome::Accepted.reason())
        };
        connack.written(reception.largest)
    }

    /// Returns the keep alive in seconds that is imposed on a client of MQTT 5. It is imposed if the client asks for
    /// no keep alive, or for more than `KEEP_ALIVE_S`.
    const fn keep_alive_s(&self) -> Option<u16> {
        let keep_alive_s = self.connect.keep_alive_s;
        match self.connect.version() {
            Version::Five if keep_alive_s == 0 || keep_alive_s > KEEP_ALIVE_S => Some(KEEP_ALIVE_S),
            Version::Five | Version::Three => None,
        }
    }
}

#[cfg(test)]
#[path = "clients_tests.rs"]
mod tests;
