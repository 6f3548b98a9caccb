//! From a newcomer to a client. On the thread that hears, a client says who it is, and is heard for a STOP from then on, before anything
//! else is decided; elsewhere it is let in or told why not, and is served by the pump. What a client may do is the gate's business.

use std::net::IpAddr;
use std::pin::{Pin, pin};
use std::sync::Arc;
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use bytes::{Bytes, BytesMut};
use tokio::io::{AsyncWrite, AsyncWriteExt};
use tokio::runtime::Handle;
use tokio::sync::oneshot;

use super::client_ids::{ClientIds, Name};
use super::commands::Commands;
use super::embedded::Running;
use super::hearing::Hearing;
use super::identity::{Identity, Unknown};
use super::incoming::{IncomingConnection, Origin, Reader, Writer};
use super::introduction::{SentAway, introduction};
use super::limits::{CONNECT_TIME, LEAVING, WAITING};
use super::pump::{self, Ends};
use super::read_ahead::{Left, Pool, Taker, read_ahead};
use super::seats::Seats;
use crate::access::{Attempts, Network};
use crate::api::door;
use crate::doors::room::Room;
use crate::doors::vestibule::{Vestibule, Waiting};
use crate::runtime::clock::Clock;
use mqtt_gate::limits::CONNECT;
use mqtt_gate::packet::connect::{self, Connect};
use mqtt_gate::packet::write::{self, Welcome};
use mqtt_gate::{Broker, ClientConnection, Ended, Listener, Terms};
use mqtt_gate::{Kind, frame};

/// So long a client that is sent away may take to read why.
const FAREWELL: Duration = Duration::from_secs(1);

/// The longest name of a client, in bytes; the standard asks for 23.
const CLIENT_ID: usize = 256;

/// What all connections to our own broker have in common. Cheap to clone.
#[derive(Clone)]
pub struct Clients(Arc<Rooms>);

struct Rooms {
    broker: Arc<Broker>,
    commands: Commands,
    /// Of those who have not said yet who they are.
    vestibule: Vestibule,
    /// Of those who are on their way out.
    leaving: Vestibule,
    seats: Seats,
    pool: Pool,
    ids: ClientIds,
    attempts: Attempts,
    clock: Clock,
}

/// Who hears its commands, and who is told when it has a seat.
type Heeded = (Arc<dyn Listener>, oneshot::Sender<()>);

struct IdentifiedClient {
    connect: Connect,
    identity: Identity,
    origin: Origin,
}

impl Clients {
    /// Nobody is here yet. Commands go to `commands`.
    pub fn new(broker: Arc<Broker>, commands: Commands) -> Clients {
        Clients::with_room(broker, commands, Room::default())
    }

    pub fn with_room(broker: Arc<Broker>, commands: Commands, room: Room) -> Clients {
        Clients(Arc::new(Rooms {
            broker,
            commands,
            vestibule: Vestibule::new(room.part(WAITING)),
            leaving: Vestibule::new(room.part(LEAVING)),
            seats: Seats::new(room),
            pool: Pool::default(),
            ids: ClientIds::default(),
            attempts: Attempts::default(),
            clock: Clock::default(),
        }))
    }

    /// Lets a connection from there wait until it has said who it is; another one may have to make room.
    pub(super) fn let_wait(&self, from: IpAddr) -> Waiting {
        self.0.vestibule.enter(from, Arc::default())
    }

    /// Cuts some connections of strangers, when the system has no more descriptors; how many.
    pub(super) fn relieve(&self) -> usize {
        self.0.vestibule.relieve()
    }

    /// Listens to a newcomer to the end, on the thread that hears, while it is served on `work`.
    pub(super) async fn attend(self, incoming: IncomingConnection, waiting: Waiting, (running, work): (Running, Handle)) {
        let from = incoming.origin.from;
        let sent = self.converse(incoming, waiting, (running, work)).await;
        tracing::debug!(%from, why = %sent, "an MQTT connection has ended");
    }

    /// Why it ended.
    async fn converse(&self, incoming: IncomingConnection, waiting: Waiting, (running, work): (Running, Handle)) -> SentAway {
        let IncomingConnection { mut reader, mut writer, origin } = incoming;
        let (from, mut heard) = (origin.from, BytesMut::new());
        let introduced = tokio::select! {
            biased;
            // What has come already is read before room is made.
            introduced = self.introduced(&mut reader, &mut heard, &origin) => introduced,
            () = waiting.cut() => Err(SentAway::GaveWay),
        };
        let (connect, identity) = match introduced {
            Ok(known) => known,
            Err(sent) => {
                return self.send_away(IncomingConnection { reader, writer, origin }, &heard, waiting, (sent, work)).await;
            }
        };
        let known = IdentifiedClient { connect, identity, origin };
        let (feeder, taker) = read_ahead(&self.0.pool);
        let listener = known.identity.listener(&self.0.commands, from);
        let mut hearing = Hearing::new(Arc::clone(&listener), feeder, self.0.clock, work.clone());
        hearing.begin(&heard).await;
        drop(heard);
        let greeted = self.greet(&mut writer, &known);
        // Only now, when its STOP has halted, it is asked what else is wrong. Until that is done it waits with the others.
        let (seated, has_seat) = oneshot::channel();
        let served = work.spawn(self.clone().serve((writer, taker), (known, greeted), (listener, seated), running));
        let aborted = served.abort_handle();
        let mut sent = pin!(async {
            hearing.run(reader).await;
            served.await.unwrap_or(SentAway::GaveWay)
        });
        tokio::select! {
            sent = &mut sent => return sent,
            _ = has_seat => {}
            () = waiting.cut() => aborted.abort(),
        }
        drop(waiting);
        sent.await
    }

    /// Greets whoever will be let in whatever is remembered of it, and says how many bytes of that it was told. Most clients say nothing
    /// before, not even STOP, and where all else is done many may be before this one (safety S7).
    fn greet(&self, writer: &mut Writer, known: &IdentifiedClient) -> usize {
        if !known.connect.clean_session || self.refusal(known).is_some() {
            return 0;
        }
        let mut cx = Context::from_waker(Waker::noop());
        match Pin::new(writer).poll_write(&mut cx, &write::connack(Welcome::Accepted, false)) {
            Poll::Ready(Ok(told)) => told,
            // It is told later, or found to be gone.
            Poll::Ready(Err(_)) | Poll::Pending => 0,
        }
    }

    /// Tells a newcomer why it is sent away. Whoever may stop all the same is heard before that, and for a while yet (safety S8).
    async fn send_away(
        &self,
        incoming: IncomingConnection,
        heard: &[u8],
        waiting: Waiting,
        (sent, work): (SentAway, Handle),
    ) -> SentAway {
        let IncomingConnection { reader, writer, origin } = incoming;
        let from = origin.from;
        let stranger = tokio::select! {
            biased;
            stranger = self.stranger(&sent, heard, &origin) => stranger,
            // Whoever shows a wrong password makes room while he waits for his answer.
            () = waiting.cut() => return work.spawn(self.clone().tell(from, writer, SentAway::GaveWay)).await.unwrap_or(SentAway::GaveWay),
        };
        let Some((identity, is_five)) = stranger else {
            return work.spawn(self.clone().tell(from, writer, sent)).await.unwrap_or(SentAway::Ended(Ended::Gone));
        };
        let (feeder, taker) = read_ahead(&self.0.pool);
        taker.leave(Left::HearsOn);
        let hearing = Hearing::new(identity.listener(&self.0.commands, from), feeder, self.0.clock, work.clone());
        let mut hearing = if is_five { hearing.for_mqtt5() } else { hearing };
        hearing.begin(heard).await;
        let told = work.spawn(self.clone().tell(from, writer, sent));
        tokio::select! {
            () = hearing.run(reader) => {}
            () = waiting.cut() => {}
        }
        told.await.unwrap_or(SentAway::Ended(Ended::Gone))
    }

    /// Who somebody is whose first words are no CONNECT to go on with, and whether he speaks MQTT 5; `None`: nobody who is let in.
    async fn stranger(&self, sent: &SentAway, heard: &[u8], origin: &Origin) -> Option<(Identity, bool)> {
        let (SentAway::Unfit(_) | SentAway::Malformed(_) | SentAway::First(_)) = sent else { return None };
        let connect = frame(heard, CONNECT).ok().flatten().filter(|frame| frame.kind == Kind::Connect);
        let credentials = connect.map(|frame| connect::credentials(&heard[frame.head..frame.length])).unwrap_or_default();
        let is_five = credentials.is_five;
        self.identity(&credentials, origin).await.ok().map(|identity| (identity, is_five))
    }

    /// Who a newcomer says it is, if that is so. Whoever shows a wrong password waits for his answer, the longer the more often.
    async fn introduced(
        &self,
        reader: &mut Reader,
        heard: &mut BytesMut,
        origin: &Origin,
    ) -> Result<(Connect, Identity), SentAway> {
        let introduced = tokio::time::timeout(CONNECT_TIME, introduction(reader, heard)).await;
        let connect = introduced.map_err(|_| SentAway::Slow)??;
        let identity = self.identity(&connect.credentials, origin).await?;
        Ok((connect, identity))
    }

    async fn identity(&self, credentials: &connect::Credentials, origin: &Origin) -> Result<Identity, SentAway> {
        match Identity::of(credentials, origin) {
            Ok(identity) => Ok(identity),
            Err(Unknown::Nothing) => Err(SentAway::Refused(Welcome::NotAllowed)),
            Err(Unknown::Wrong) => {
                let delay = self.0.attempts.wrong(Network::of(origin.from), self.0.clock.since_start());
                tracing::warn!(from = %origin.from, delay_ms = delay.as_millis(), "a wrong name or password was shown over MQTT");
                tokio::time::sleep(delay).await;
                Err(SentAway::Refused(Welcome::Login))
            }
        }
    }

    /// What is wrong with the CONNECT of somebody who is known.
    fn refusal(&self, IdentifiedClient { connect, identity, .. }: &IdentifiedClient) -> Option<Welcome> {
        let is_nameless = connect.client_id.is_empty() && !connect.clean_session;
        if is_nameless || connect.client_id.len() > CLIENT_ID {
            return Some(Welcome::ClientId);
        }
        let is_allowed = |topic: &str| self.0.broker.may_leave_will(identity.tier(), topic);
        connect.will.as_ref().filter(|will| !is_allowed(&will.topic)).map(|_| Welcome::NotAllowed)
    }

    /// Serves a client to its end, and says why that came; of its greeting it was told so much already.
    async fn serve(
        self,
        (writer, ahead): (Writer, Taker),
        (known, greeted): (IdentifiedClient, usize),
        (listener, seated): Heeded,
        running: Running,
    ) -> SentAway {
        if let Some(welcome) = self.refusal(&known) {
            ahead.leave(Left::HearsRest);
            return self.tell(known.origin.from, writer, SentAway::Refused(welcome)).await;
        }
        let IdentifiedClient { connect, identity, origin } = known;
        let now = self.0.clock.since_start();
        let seat = Arc::new(self.0.seats.take(identity.holder(), now));
        let _connected = self.0.commands.figures().connected(door::MQTT);
        drop(seated);
        let name = Name { who: identity.name(), client: connect.client_id.clone() };
        // What is remembered of it is said with the greeting.
        let (id, session) = tokio::select! {
            biased;
            taken = self.0.ids.take(name.clone(), !connect.clean_session) => taken,
            () = seat.given_up() => return self.tell(origin.from, writer, SentAway::Ended(Ended::GaveWay)).await,
        };
        tracing::debug!(from = %origin.from, who = %name.who, client = connect.client_id, "an MQTT client has come");
        let greeting = write::connack(Welcome::Accepted, session.is_some());
        let terms = Terms {
            tier: identity.tier(),
            name: identity.name(),
            has_key: identity.has_key(),
            listener,
            keep_alive_s: connect.keep_alive_s,
            will: connect.will,
            session: session.unwrap_or_default(),
            greeting: Bytes::copy_from_slice(&greeting[greeted..]),
        };
        let connection = ClientConnection::new(terms, Arc::clone(&self.0.broker), now);
        let ends = Ends { client: writer, ahead, seat, id, leaving: (self.0.leaving.clone(), origin.from) };
        SentAway::Ended(pump::run(connection, ends, running, (&identity, &origin.access, self.0.clock)).await)
    }

    /// Tells a client why it is sent away. Whether it listens is its own matter.
    async fn tell(self, from: IpAddr, mut writer: Writer, sent: SentAway) -> SentAway {
        let answer = match &sent {
            SentAway::Refused(welcome) => write::connack(*welcome, false).to_vec(),
            SentAway::Unfit(unfit) => unfit.answer().to_vec(),
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

#[cfg(test)]
#[path = "clients_tests.rs"]
mod tests;
