//! Moves bytes between a client and the gate, for as long as both go on. It understands none of them: what is let through, and how much
//! may wait, is said by the gate. What the client says has been looked through for a STOP before it comes here, so that nothing here is
//! urgent: it works in short turns, and others have theirs in between. Who polls it, stands in `client_service`.

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

/// After so long of one client's packets others have their turn.
const TURN: Duration = Duration::from_millis(1);

/// Of a client who says more than this at once nothing is taken by whoever has something else to do.
const LITTLE: usize = 2 * 1024;

/// How often it is looked whether a client would be let in still: a key that was taken away is good for no longer than this.
const GLANCE: Duration = Duration::from_millis(500);

/// So long the last words to a client may take to get to it.
const FAREWELL: Duration = Duration::from_secs(1);

/// How often it is looked, when the program ends, whether a client was told everything.
const BREATH: Duration = Duration::from_millis(2);

/// A client that takes so many bytes reads what waits for it.
const MUCH: usize = 64 * 1024;

/// Changes, or is closed, when the program ends.
pub(super) type Running = watch::Receiver<()>;

pub(super) struct ClientEnds {
    pub(super) client: Writer,
    /// What the client has sent.
    pub(super) ahead: Taker,
    pub(super) permit: Arc<SessionPermit>,
    pub(super) id: ClientId,
    /// Where those are who leave, and from where this one came.
    pub(super) leaving: (PendingConnections, IpAddr),
}

pub(super) type Whose<'a> = (&'a Identity, &'a Access, Clock);

/// The gate, and what has come for it.
pub(super) struct ClientIo {
    connection: ClientConnection,
    subscriber: Arc<Subscriber>,
    client: Writer,
    ahead: Taker,
    permit: Arc<SessionPermit>,
    clock: Clock,
    from_client: BytesMut,
    /// Whole packets of the client may be there that were not taken in the last turn.
    is_cut: bool,
    /// There is more to do, and others have their turn first.
    wants_turn: bool,
    /// When the client had last taken much, or all, of what waited for it, and how much since then.
    read_at: Duration,
    taken: usize,
    /// The client has published in a flood, and these subscribers do not keep up.
    waiting: Option<LagWait>,
    /// It has come to its end.
    ended: Option<Ended>,
}

struct LagWait {
    behind: Vec<Arc<Subscriber>>,
    until: Duration,
}

/// A service that is closed when nobody serves there any more: whoever would wake it has it, too.
struct OpenService(Arc<ClientService>);

impl Drop for OpenService {
    fn drop(&mut self) {
        drop(self.0.close());
    }
}

/// For how long somebody serves a client before he does something else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TurnLength {
    Short,
    Long,
}

/// Whether there was something to do.
type Did = Result<bool, Ended>;

/// Runs until it has to end, and says why.
pub(super) async fn run(connection: ClientConnection, ends: ClientEnds, mut running: Running, whose: Whose<'_>) -> Ended {
    let ClientEnds { client, ahead, permit, mut id, leaving } = ends;
    let subscriber = connection.subscriber();
    let service = OpenService(ClientService::new(ClientIo::new(connection, (client, ahead, Arc::clone(&permit)), whose.2)));
    let ended = tokio::select! {
        ended = service.0.serve(whose.2) => ended,
        () = id.wanted() => Ended::TakenOver,
        _ = running.changed() => Ended::Closing,
        ended = shut_out(whose, &permit) => ended,
    };
    let ended = if ended == Ended::Closing { drain(&service.0, &subscriber, whose.2).await } else { ended };
    permit.release();
    let Some(ClientIo { mut connection, client, ahead, .. }) = service.0.close() else { return ended };
    ahead.leave(left(ended));
    connection.handle_end(ended, whose.2.since_start());
    let to_client = std::mem::take(connection.to_client());
    id.remember(connection.into_session());
    // Whoever wants the name need not wait for the farewell.
    drop(id);
    send_farewell(ended, (client, to_client, ahead), leaving).await;
    ended
}

/// The program ends: serves until the client was told everything that was published for it, as that the program ends. Whoever ends
/// connections bounds the time for this.
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

/// Says the last words to a client, but not for long.
async fn send_farewell(
    ended: Ended,
    (mut client, mut to_client, ahead): (Writer, Outbox, Taker),
    (leaving, from): (PendingConnections, IpAddr),
) {
    let told = async {
        // Whoever is gone already hears nothing.
        let _ = client.write_all_buf(&mut to_client).await;
        let _ = client.shutdown().await;
    };
    let farewell = async {
        if ended != Ended::Closing {
            return leaving.linger(from, told).await;
        }
        told.await;
        // The program goes on ending when this connection is closed; what is on its way is there only when the other side has
        // closed it, too.
        ahead.ended().await;
    };
    let _ = tokio::time::timeout(FAREWELL, farewell).await;
}

impl ClientIo {
    fn new(connection: ClientConnection, (client, ahead, permit): (Writer, Taker, Arc<SessionPermit>), clock: Clock) -> ClientIo {
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

    /// Does what there is to do, for as long as one turn is; ready with why there is an end to it.
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

    /// Whether there is more to do, though nobody wakes whoever serves.
    pub(super) const fn wants_turn(&self) -> bool {
        self.wants_turn
    }

    /// Whether there is too much to do for somebody who serves in between, or somebody is waited for.
    pub(super) fn wants_task(&self) -> bool {
        self.waiting.is_some() || self.ended.is_some() || self.is_cut || self.ahead.bytes() > LITTLE
    }

    /// By when it is to be polled again, whatever happens.
    pub(super) fn due(&self) -> Duration {
        let silent_until = self.connection.poll_timeout();
        self.waiting.as_ref().map_or(silent_until, |waiting| waiting.until.min(silent_until))
    }

    /// Does one thing of each kind; whether there was any.
    fn step(&mut self, length: TurnLength, cx: &mut Context<'_>) -> Did {
        let is_held_up = self.is_held_up(cx);
        let heard = !is_held_up && self.hear_client(length, cx)?;
        let came = self.connection.reads() && self.subscriber.poll_come(self.connection.has_window(), cx).is_ready();
        let goes_on = self.connection.wants_turn();
        if came || goes_on {
            self.connection.handle_come(self.clock.since_start());
        }
        // What others are to read goes out before it is acknowledged.
        let told = !(heard && length == TurnLength::Short) && self.tell_client(cx)?;
        self.connection.handle_timeout(self.clock.since_start())?;
        Ok(told || heard || came || goes_on)
    }

    fn tell_client(&mut self, cx: &mut Context<'_>) -> Did {
        if self.connection.to_client().is_empty() {
            return Ok(false);
        }
        // Turns have their own bound here.
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

    /// Takes some of what the client has said.
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
            // Whoever has said much lets others have their turn first.
            self.wants_turn |= self.from_client.len() - before >= READ / 2;
        }
        self.is_cut = self.connection.handle_turn(&mut self.from_client, self.clock.since_start())?;
        self.moves();
        Ok(true)
    }

    /// Whether nothing is taken from the client, because others do not keep up with what it publishes.
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
        // Whoever catches up in this moment is seen to have done so.
        let is_over = behind.iter().all(|subscriber| subscriber.poll_relieved(cx).is_ready());
        self.waiting = (!is_over).then_some(LagWait { behind, until });
        !is_over
    }

    /// Says how much waits here, for the client and of it.
    fn note_held(&mut self) {
        let here = self.connection.held() + self.from_client.len();
        self.ahead.hold(here, self.connection.reads());
        if self.connection.to_client().is_empty() {
            (self.read_at, self.taken) = (self.clock.since_start(), 0);
        }
        let unread = UnreadBytes { here, shared: self.connection.shared() };
        self.permit.note_unread(unread, self.read_at, || self.connection.beside());
    }

    /// The client has said something, or read something.
    fn moves(&self) {
        self.permit.note_progress(self.clock.since_start());
    }
}

/// What is heard of a client from whom nothing more is taken.
fn left(ended: Ended) -> Left {
    if ended == Ended::NotKnown {
        Left::Deaf
    } else if ended == Ended::Closing {
        Left::HearsOn
    } else {
        Left::HearsRest
    }
}

/// Waits until whoever was let in has to go: its key is not known any more, or its session is evicted.
async fn shut_out((identity, access, clock): Whose<'_>, permit: &SessionPermit) -> Ended {
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
