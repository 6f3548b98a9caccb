//! Moves bytes between a client, the gate and the router, for as long as all three go on. It understands none of them: what is let
//! through, and how much may wait, is said by the gate. What the client says has been looked through for a STOP before it comes here,
//! so that nothing here is urgent: it works in short turns, and others have theirs in between.

use std::io;
use std::net::IpAddr;
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use bytes::BytesMut;
use tokio::io::AsyncWriteExt;
use tokio::sync::Semaphore;

use super::identity::Identity;
use super::incoming::Writer;
use super::read_ahead::{Left, READ, Taker};
use super::seats::{Seat, Unread, given_up};
use super::slots::Slot;
use super::upstream::{ToRouter, Upstream, leave, read_some, write_some};
use crate::access::Access;
use crate::doors::vestibule::Vestibule;
use crate::runtime::clock::Clock;
use mqtt_gate::SubscriberLag;
use mqtt_gate::give_back;
use mqtt_gate::limits::ANSWER_ROOM;
use mqtt_gate::{ClientConnection, Ended};

/// After so long of one client's packets others have their turn.
const TURN: Duration = Duration::from_millis(1);

/// So much room there is for what the router sends, in bytes, while no more than that comes at once.
const FEW: usize = 4 * 1024;

/// How often it is looked whether a client would be let in still: a key that was taken away is good for no longer than this.
const GLANCE: Duration = Duration::from_millis(500);

/// So long the last words of a connection may take to get to the other side,
const FAREWELL: Duration = Duration::from_secs(1);

/// and so long the messages of a client that left before it had a way to the router.
const LATE: Duration = Duration::from_secs(5);

/// How often it is looked, when the program ends, whether a client was told everything.
const BREATH: Duration = Duration::from_millis(2);

/// A client that takes so many bytes reads what waits for it.
const MUCH: usize = 64 * 1024;

pub(super) struct Ends {
    pub(super) client: Writer,
    /// What the client has sent.
    pub(super) ahead: Taker,
    /// Our own session has none.
    pub(super) seat: Option<Seat>,
    /// Where those are who leave, and from where this one came.
    pub(super) leaving: (Vestibule, IpAddr),
    /// Room for those who have left and whose messages wait for a way to the router.
    pub(super) late: Arc<Semaphore>,
}

pub(super) type Whose<'a> = (&'a Identity, &'a Access, Clock);

/// The gate in the middle, and what has come from both sides.
struct Pump<'a> {
    connection: ClientConnection,
    client: Writer,
    ahead: Taker,
    seat: Option<&'a Seat>,
    /// Not before the router has let us in.
    router: Option<ToRouter>,
    clock: Clock,
    from_client: BytesMut,
    /// Whole packets of the client may be there that were not taken in the last turn;
    is_cut: bool,
    /// others have their turn first.
    is_long: bool,
    from_router: BytesMut,
    /// When the client had last taken much, or all, of what waited for it, and how much since then.
    read_at: Duration,
    taken: usize,
    /// The client has published in a flood, and these subscribers do not keep up.
    waiting: Option<LagWait>,
}

#[derive(Clone)]
struct LagWait {
    behind: Arc<[Arc<SubscriberLag>]>,
    until: Duration,
}

/// Runs until it has to end, and says why. The client is served although `joining`, which finds the way to the router, takes long; for
/// a client that is gone it is not waited for while it only `waits`, unless what it published is there and has room.
pub(super) async fn run(
    connection: ClientConnection,
    Ends { client, ahead, seat, leaving, late }: Ends,
    (joining, waits): (impl Future<Output = Result<Upstream, Ended>>, &AtomicBool),
    whose: Whose<'_>,
) -> Ended {
    let mut pump = Pump::new(connection, (client, ahead, seat.as_ref()), whose.2);
    let (mut joining, mut shut_out) = (pin!(joining), pin!(shut_out(whose, seat.as_ref())));
    let joined = tokio::select! {
        ended = pump.flow() => Err(ended),
        joined = &mut joining => Ok(joined),
        ended = &mut shut_out => Err(ended),
    };
    let has_not_joined = joined.is_err();
    let is_joining = has_not_joined && !waits.load(Ordering::Relaxed);
    let (ended, slot, way) = match joined.and_then(|joined| joined) {
        Err(ended) => (ended, None, None),
        Ok(Upstream { stream, mut slot, mut router, way }) => {
            pump.router = Some(stream.into_split());
            let ended = tokio::select! {
                ended = pump.flow() => ended,
                () = slot.wanted() => Ended::TakenOver,
                changed = router.changed() => if changed.is_ok() { Ended::RouterGone } else { Ended::Closing },
                ended = &mut shut_out => ended,
            };
            (ended, Some(slot), Some(way))
        }
    };
    let ended = if ended == Ended::Closing { pump.see_out().await } else { ended };
    if let Some(seat) = &seat {
        seat.give_back();
    }
    pump.ahead.leave(left(ended));
    pump.connection.handle_end(ended);
    if ended == Ended::GaveWay {
        // What waited for it may be why.
        pump.connection.to_client().clear();
    }
    let room = (has_not_joined && pump.connection.has_messages()).then(|| late.try_acquire_owned().ok()).flatten();
    let patience = if room.is_some() { LATE } else { FAREWELL };
    let joined = async { if is_joining || room.is_some() { joining.await.ok() } else { None } };
    if let Some(slot) = pump.take_leave(ended, (joined, patience), leaving).await.or(slot) {
        slot.remember(pump.connection.into_session());
    }
    drop(way);
    ended
}

impl<'a> Pump<'a> {
    fn new(connection: ClientConnection, (client, ahead, seat): (Writer, Taker, Option<&'a Seat>), clock: Clock) -> Pump<'a> {
        Pump {
            connection,
            client,
            ahead,
            seat,
            router: None,
            clock,
            from_client: BytesMut::new(),
            is_cut: false,
            is_long: false,
            from_router: BytesMut::new(),
            read_at: clock.now().since_start,
            taken: 0,
            waiting: None,
        }
    }

    /// The program ends: moves bytes until the client was told everything that was published for it, as that the program ends. Whoever
    /// ends connections bounds the time for this.
    async fn see_out(&mut self) -> Ended {
        let lag = self.connection.lag();
        let settled = async {
            while !lag.is_settled() {
                tokio::time::sleep(BREATH).await;
            }
        };
        tokio::select! {
            ended = self.flow() => ended,
            () = settled => Ended::Closing,
        }
    }

    /// Says the last words to both sides. The router is left only after it has let us in: one that was left before that may let nobody
    /// in again. So a way to it that comes late is taken, and with it the slot that it was for.
    async fn take_leave(
        &mut self,
        ended: Ended,
        (late, patience): (impl Future<Output = Option<Upstream>>, Duration),
        (leaving, from): (Vestibule, IpAddr),
    ) -> Option<Slot> {
        let (to_router, to_client) = self.connection.outgoing();
        let told = async {
            // Whoever is gone already hears nothing.
            let _ = self.client.write_all_buf(to_client).await;
            let _ = self.client.shutdown().await;
        };
        let to_client = async {
            if ended != Ended::Closing {
                return leaving.linger(from, told).await;
            }
            told.await;
            // The program goes on ending when this connection is closed; what is on its way is there only when the other side has
            // closed it, too.
            self.ahead.ended().await;
        };
        let to_router = async {
            match self.router.take() {
                Some(mut router) => {
                    leave(&mut router, to_router).await;
                    None
                }
                None => {
                    let Upstream { stream, slot, .. } = late.await?;
                    leave(&mut stream.into_split(), to_router).await;
                    Some(slot)
                }
            }
        };
        let (to_client, to_router) = (tokio::time::timeout(FAREWELL, to_client), tokio::time::timeout(patience, to_router));
        tokio::join!(to_client, to_router).1.ok().flatten()
    }

    async fn flow(&mut self) -> Ended {
        let (mut outcome, mut read) = (Ok(()), 0);
        loop {
            if let Err(ended) = outcome {
                return ended;
            }
            let behind = self.behind();
            let hears_client = behind.is_none() && self.connection.wants_client();
            let (is_unread, hears_router) =
                (self.connection.is_unread(), self.connection.wants_router() && self.router.is_some());
            let silent_until = self.connection.poll_timeout();
            self.note_held();
            if hears_router {
                make_room(&mut self.from_router, read);
            }
            let has_more = self.connection.wants_turn();
            let (for_router, for_client) = self.connection.outgoing();
            let tells_router = !for_router.is_empty() && self.router.is_some();
            let (router, to_router) = self.router.as_mut().map(|(read, write)| (read, write)).unzip();
            outcome = tokio::select! {
                biased;
                written = write_some(to_router, for_router), if tells_router => {
                    give_back(for_router);
                    went(written, Ended::RouterGone)
                }
                written = self.client.write_buf(for_client), if !for_client.is_empty() => {
                    self.handle_read(&written);
                    went(written, Ended::Gone)
                }
                has_ended = said(&self.ahead, self.is_cut || self.is_long, self.is_cut), if hears_client => {
                    if has_ended { Err(Ended::Gone) } else { self.client_said() }
                }
                () = self.ahead.full(), if is_unread => Err(Ended::TooMuch { what: "bytes of answers unread", most: ANSWER_ROOM }),
                came = read_some(router, &mut self.from_router), if hears_router => {
                    read = came.as_ref().copied().unwrap_or_default();
                    went(came, Ended::RouterGone).and_then(|()| self.connection.handle_router(&mut self.from_router))
                }
                in_vain = caught_up(behind.as_ref(), self.clock) => {
                    self.waiting = None;
                    if in_vain {
                        self.connection.handle_waited(self.clock.now().since_start);
                    }
                    Ok(())
                }
                () = tokio::task::yield_now(), if has_more => {
                    self.connection.handle_drained();
                    Ok(())
                }
                () = self.clock.reach(Some(silent_until)) => self.connection.handle_timeout(self.clock.now().since_start),
            };
        }
    }

    /// The client has taken some of what waits for it.
    fn handle_read(&mut self, written: &io::Result<usize>) {
        self.taken += written.as_ref().copied().unwrap_or_default();
        if self.taken >= MUCH {
            (self.read_at, self.taken) = (self.clock.now().since_start, 0);
        }
        self.connection.handle_drained();
        self.moves();
    }

    /// Says how much waits here, for the client and of it.
    fn note_held(&mut self) {
        let here = self.connection.held() + self.from_client.len() + self.from_router.len();
        self.ahead.hold(here, self.connection.wants_router());
        let (shared, at_router) = self.connection.elsewhere();
        if self.connection.to_client().is_empty() {
            (self.read_at, self.taken) = (self.clock.now().since_start, 0);
        }
        if let Some(seat) = self.seat {
            seat.note_unread(Unread { here, at_router, shared }, self.read_at, || self.connection.beside());
        }
    }

    /// For whom nothing is taken from the client, and until when.
    fn behind(&mut self) -> Option<LagWait> {
        let now = self.clock.now().since_start;
        if self.waiting.is_none() {
            let behind = self.connection.poll_behind(now);
            let until = self.connection.waits_until(now);
            self.waiting = (!behind.is_empty()).then(|| LagWait { behind: behind.into(), until });
        } else {
            self.connection.note_room(now);
        }
        self.waiting.clone()
    }

    /// Takes some of what the client has said, for no longer than a turn.
    fn client_said(&mut self) -> Result<(), Ended> {
        let now = self.clock.now().since_start;
        let before = self.from_client.len();
        if !self.is_cut {
            let connection = &mut self.connection;
            self.ahead.take(&mut self.from_client, |mark| connection.handle_mark(mark));
        }
        self.is_long = self.from_client.len() - before >= READ / 2;
        loop {
            self.is_cut = self.connection.handle_turn(&mut self.from_client, now)?;
            let is_over = self.clock.now().since_start >= now + TURN;
            if !self.is_cut || is_over || !self.connection.wants_client() || self.behind().is_some() {
                break;
            }
        }
        self.moves();
        Ok(())
    }

    /// The client has said something, or read something.
    fn moves(&self) {
        if let Some(seat) = self.seat {
            seat.moves(self.clock.now().since_start);
        }
    }
}

/// Whether nothing more is said by the client; else there is something to take. Whoever has said much lets others have their turn first.
async fn said(ahead: &Taker, is_long: bool, is_there: bool) -> bool {
    if is_long {
        tokio::task::yield_now().await;
    }
    if is_there { false } else { ahead.come().await }
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

/// Room for what is read at once, more of it while much comes; what one long message or a burst took is given back.
fn make_room(buffer: &mut BytesMut, read: usize) {
    let room = if read < FEW { FEW } else { READ };
    if buffer.is_empty() && buffer.capacity() > 4 * room {
        *buffer = BytesMut::new();
    }
    buffer.reserve(room);
}

/// Waits until all subscribers have caught up, or it is time to look who does not read: whether the latter. For ever without any.
async fn caught_up(waiting: Option<&LagWait>, clock: Clock) -> bool {
    let Some(LagWait { behind, until }) = waiting else { return std::future::pending().await };
    let all_relieved = async {
        for lag in behind.iter() {
            lag.relieved().await;
        }
    };
    tokio::select! {
        () = all_relieved => false,
        () = clock.reach(Some(*until)) => true,
    }
}

fn went(moved: io::Result<usize>, else_: Ended) -> Result<(), Ended> {
    match moved {
        Ok(1..) => Ok(()),
        Ok(0) | Err(_) => Err(else_),
    }
}

/// Waits until whoever was let in has to go: its key is not known any more, or its seat is somebody else's.
async fn shut_out((identity, access, clock): Whose<'_>, seat: Option<&Seat>) -> Ended {
    let unknown = async {
        while identity.is_known(access, clock.now().wall.unix_ms.div_euclid(1000)) {
            tokio::time::sleep(GLANCE).await;
        }
    };
    tokio::select! {
        () = unknown => Ended::NotKnown,
        () = given_up(seat) => Ended::GaveWay,
    }
}
