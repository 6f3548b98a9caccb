//! Moves bytes between a client and the gate until one of them ends the connection. The bytes are not interpreted
//! here: the gate decides what is passed on, and how much may wait. Nothing here is urgent, because the input was
//! searched for a STOP before. The work is done in short turns, between which other clients are served.
//! `client_service` decides which thread polls.

use std::net::IpAddr;
use std::pin::pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use bytes::BytesMut;
use tokio::io::AsyncWriteExt;
use tokio::sync::watch;
use tokio::task::unconstrained;

use super::client_ids::ClientId;
use super::client_service::ClientService;
use super::identity::Identity;
use super::incoming::Writer;
use super::read_ahead::{Left, READ, Taker};
use crate::access::Access;
use crate::doors::connection_limits::{PendingConnections, SessionPermit, UnreadBytes};
use crate::runtime::clock::Clock;
use mqtt_gate::limits::ANSWER_ROOM;
use mqtt_gate::{ClientConnection, Ended, Outbox, Subscriber};

/// Maximum time spent on one client before other clients get their turns.
const TURN: Duration = Duration::from_millis(1);

/// Maximum number of waiting bytes with which the hearing thread serves a client itself. With more bytes, the
/// client's own task serves.
const LITTLE: usize = 2 * 1024;

/// Interval at which a client's key is checked again. A removed key stays usable no longer than this.
const GLANCE: Duration = Duration::from_millis(500);

/// Maximum time for sending the last bytes to a client.
const FAREWELL: Duration = Duration::from_secs(1);

/// While the program ends: interval for checking whether a client has received everything.
const BREATH: Duration = Duration::from_millis(2);

/// Number of bytes that a client must accept to count as reading.
const MUCH: usize = 64 * 1024;

/// Changes or closes when the program ends.
pub(super) type Running = watch::Receiver<()>;

pub(super) struct ClientEnds {
    pub(super) client: Writer,
    pub(super) ahead: Taker,
    pub(super) permit: Arc<SessionPermit>,
    pub(super) id: ClientId,
    /// Limits the number of closing connections of all clients.
    pub(super) leaving: PendingConnections,
    pub(super) from: IpAddr,
}

pub(super) struct ClientIo {
    connection: ClientConnection,
    subscriber: Arc<Subscriber>,
    client: Writer,
    ahead: Taker,
    permit: Arc<SessionPermit>,
    clock: Clock,
    from_client: BytesMut,
    /// Whether complete packets may be left over from the last turn.
    is_cut: bool,
    /// Whether there is more work, to be done after other clients had their turns.
    wants_turn: bool,
    /// When the client last accepted `MUCH` bytes, or everything that waited.
    read_at: Duration,
    taken: usize,
    /// Set while no input is taken from the client, because subscribers to its messages lag behind.
    waiting: Option<LagWait>,
    ended: Option<Ended>,
}

struct LagWait {
    behind: Vec<Arc<Subscriber>>,
    until: Duration,
}

/// Closes the service when this value is dropped. Without that, the service's own wakers would keep it alive.
struct OpenService(Arc<ClientService>);

impl Drop for OpenService {
    fn drop(&mut self) {
        drop(self.0.close());
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TurnLength {
    Short,
    Long,
}

type Did = Result<bool, Ended>;

/// Serves a client until its connection ends, and returns the reason. Before that, the session is remembered and the
/// last bytes are sent, for at most `FAREWELL`.
pub(super) async fn run(
    connection: ClientConnection,
    ends: ClientEnds,
    mut running: Running,
    identity: &Identity,
    access: &Access,
    clock: Clock,
) -> Ended {
    let ClientEnds { client, ahead, permit, mut id, leaving, from } = ends;
    let subscriber = connection.subscriber();
    let service = OpenService(ClientService::new(ClientIo::new(connection, client, ahead, Arc::clone(&permit), clock)));
    let ended = tokio::select! {
        ended = service.0.serve(clock) => ended,
        () = id.wanted() => Ended::TakenOver,
        _ = running.changed() => Ended::Closing,
        ended = shut_out(identity, access, clock, &permit) => ended,
    };
    let ended = if ended == Ended::Closing { drain(&service.0, &subscriber, clock).await } else { ended };
    permit.release();
    let Some(ClientIo { mut connection, client, ahead, .. }) = service.0.close() else { return ended };
    ahead.leave(left(ended));
    connection.handle_end(ended, clock.since_start());
    let to_client = std::mem::take(connection.to_client());
    id.remember(connection.into_session());
    // Frees the id now, so that the next client with this name need not wait for the last bytes.
    drop(id);
    send_farewell(ended, client, to_client, ahead, leaving, from).await;
    ended
}

/// While the program ends: serves until the client has received everything published for it, such as the program's
/// last message. The caller limits the time (`embedded::LAST_WORDS`).
async fn drain(service: &Arc<ClientService>, subscriber: &Subscriber, clock: Clock) -> Ended {
    let settled = async {
        while !subscriber.is_empty() {
            tokio::time::sleep(BREATH).await;
        }
    };
    tokio::select! {
        ended = service.serve(clock) => ended,
        () = settled => Ended::Closing,
    }
}

async fn send_farewell(
    ended: Ended,
    mut client: Writer,
    mut to_client: Outbox,
    ahead: Taker,
    leaving: PendingConnections,
    from: IpAddr,
) {
    let told = async {
        // Errors are ignored: the client may have left.
        let _ = client.write_all_buf(&mut to_client).await;
        let _ = client.shutdown().await;
    };
    let farewell = async {
        if ended != Ended::Closing {
            return leaving.linger(from, told).await;
        }
        told.await;
        // The program may exit once this function returns. So it waits until the client closes the connection,
        // because only that proves that the last bytes arrived.
        ahead.ended().await;
    };
    let _ = tokio::time::timeout(FAREWELL, farewell).await;
}

impl ClientIo {
    fn new(connection: ClientConnection, client: Writer, ahead: Taker, permit: Arc<SessionPermit>, clock: Clock) -> ClientIo {
        ClientIo {
            subscriber: connection.subscriber(),
            connection,
            client,
            ahead,
            permit,
            clock,
            from_client: BytesMut::new(),
            is_cut: false,
            wants_turn: false,
            read_at: clock.since_start(),
            taken: 0,
            waiting: None,
            ended: None,
        }
    }

    /// Works for one turn: a single step if `Short`, at most `TURN` if `Long`. Returns `Ready` with the reason when
    /// the connection ends.
    pub(super) fn poll(&mut self, length: TurnLength, cx: &mut Context<'_>) -> Poll<Ended> {
        let began = self.clock.since_start();
        self.wants_turn = false;
        while self.ended.is_none() && !self.wants_turn {
            match self.step(length, cx) {
                Ok(false) => break,
                Ok(true) => self.wants_turn |= length == TurnLength::Short || self.clock.since_start() >= began + TURN,
                Err(ended) => self.ended = Some(ended),
            }
        }
        self.note_held();
        self.ended.map_or(Poll::Pending, Poll::Ready)
    }

    /// Whether there is more work although no waker will report it. The caller must poll again.
    pub(super) const fn wants_turn(&self) -> bool {
        self.wants_turn
    }

    /// Whether the client's own task must serve. This is so if there is too much work for the hearing thread, or if
    /// the service has to wait for something.
    pub(super) fn wants_task(&self) -> bool {
        self.waiting.is_some() || self.ended.is_some() || self.is_cut || self.ahead.bytes() > LITTLE
    }

    /// Returns the latest time for the next poll. At that time the client has been silent for too long, or the wait
    /// for lagging subscribers is over.
    pub(super) fn due(&self) -> Duration {
        let silent_until = self.connection.poll_timeout();
        self.waiting.as_ref().map_or(silent_until, |waiting| waiting.until.min(silent_until))
    }

    fn step(&mut self, length: TurnLength, cx: &mut Context<'_>) -> Did {
        let is_held_up = self.is_held_up(cx);
        let heard = !is_held_up && self.hear_client(length, cx)?;
        let came = self.connection.reads() && self.subscriber.poll_come(self.connection.has_window(), cx).is_ready();
        let goes_on = self.connection.wants_turn();
        if came || goes_on {
            self.connection.handle_come(self.clock.since_start());
        }
        // Messages of this client are passed on to other clients before this client gets the acknowledgements.
        let told = !(heard && length == TurnLength::Short) && self.tell_client(cx)?;
        self.connection.handle_timeout(self.clock.since_start())?;
        Ok(told || heard || came || goes_on)
    }

    fn tell_client(&mut self, cx: &mut Context<'_>) -> Did {
        if self.connection.to_client().is_empty() {
            return Ok(false);
        }
        // Does not use tokio's own task budget, because a turn here is limited in time already.
        let written = match pin!(unconstrained(self.client.write_buf(self.connection.to_client()))).poll(cx) {
            Poll::Pending => return Ok(false),
            Poll::Ready(Ok(written @ 1..)) => written,
            Poll::Ready(Ok(0) | Err(_)) => return Err(Ended::Gone),
        };
        self.taken += written;
        if self.taken >= MUCH {
            (self.read_at, self.taken) = (self.clock.since_start(), 0);
        }
        self.connection.handle_drained(self.clock.since_start());
        self.moves();
        Ok(true)
    }

    fn hear_client(&mut self, length: TurnLength, cx: &Context<'_>) -> Did {
        if self.connection.is_unread() {
            let is_full = self.ahead.poll_full(cx).is_ready();
            let unread = Ended::TooMuch { what: "bytes of answers unread", most: ANSWER_ROOM };
            return if is_full { Err(unread) } else { Ok(false) };
        }
        let before = self.from_client.len();
        if !self.is_cut {
            match self.ahead.poll_come(cx) {
                Poll::Pending => return Ok(false),
                Poll::Ready(true) => return Err(Ended::Gone),
                Poll::Ready(false) if length == TurnLength::Short && self.wants_task() => return Ok(false),
                Poll::Ready(false) => {}
            }
            let connection = &mut self.connection;
            self.ahead.take(&mut self.from_client, |mark| connection.handle_mark(mark));
            // If a client sends much input, other clients get their turns before the next input is taken.
            self.wants_turn |= self.from_client.len() - before >= READ / 2;
        }
        self.is_cut = self.connection.handle_turn(&mut self.from_client, self.clock.since_start())?;
        self.moves();
        Ok(true)
    }

    /// Whether no input is taken from the client at present, because subscribers to its messages lag behind.
    fn is_held_up(&mut self, cx: &Context<'_>) -> bool {
        let now = self.clock.since_start();
        if let Some(LagWait { behind, until }) = &self.waiting {
            let is_over = behind.iter().all(|subscriber| subscriber.poll_relieved(cx).is_ready());
            if !is_over && now < *until {
                self.connection.note_room(now);
                return true;
            }
            self.waiting = None;
            if !is_over {
                self.connection.handle_waited(now);
            }
        }
        let behind = self.connection.poll_behind(now);
        if behind.is_empty() {
            return false;
        }
        let until = self.connection.waits_until(now);
        // A subscriber may have caught up since `poll_behind`.
        let is_over = behind.iter().all(|subscriber| subscriber.poll_relieved(cx).is_ready());
        self.waiting = (!is_over).then_some(LagWait { behind, until });
        !is_over
    }

    /// Reports how many bytes wait for this client. These bytes reduce its room for reading ahead. If there are many,
    /// its session may be evicted.
    fn note_held(&mut self) {
        let here = self.connection.held() + self.from_client.len();
        self.ahead.hold(here, self.connection.reads());
        if self.connection.to_client().is_empty() {
            (self.read_at, self.taken) = (self.clock.since_start(), 0);
        }
        let unread = UnreadBytes { here, shared: self.connection.shared() };
        self.permit.note_unread(unread, self.read_at, || self.connection.beside());
    }

    fn moves(&self) {
        self.permit.note_progress(self.clock.since_start());
    }
}

fn left(ended: Ended) -> Left {
    if ended == Ended::NotKnown {
        Left::Deaf
    } else if ended == Ended::Closing {
        Left::HearsOn
    } else {
        Left::HearsRest
    }
}

/// Waits until an admitted client must be disconnected. This happens when its key becomes invalid, or when its
/// session is evicted for another one.
async fn shut_out(identity: &Identity, access: &Access, clock: Clock, permit: &SessionPermit) -> Ended {
    let unknown = async {
        while identity.is_known(access, clock.now()) {
            tokio::time::sleep(GLANCE).await;
        }
    };
    tokio::select! {
        () = unknown => Ended::NotKnown,
        () = permit.evicted() => Ended::GaveWay,
    }
}
