//! Moves bytes between a client, the gate and the engine, for as long as all three go on. It understands none of them: what is let
//! through, and how much may wait, is said by the gate.

use std::sync::Arc;
use std::time::Duration;

use bytes::BytesMut;
use tokio::io::{AsyncReadExt, AsyncWriteExt, ReadHalf, WriteHalf};
use tokio::net::TcpStream;
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};

use super::embedded::Running;
use super::gate::ledger::Ledger;
use super::gate::limits::PATIENCE;
use super::gate::turnstile::{Ended, Turnstile};
use super::identity::Identity;
use super::slots::Slot;
use super::visitor::Stream;
use crate::access::Access;
use crate::runtime::clock::Clock;

/// So much is read at once, in bytes.
const READ: usize = 64 * 1024;

/// How often it is looked whether a client would be let in still: a key that was taken away is good for no longer than this.
const GLANCE: Duration = Duration::from_millis(500);

/// So long the last words of a connection may take to get to the other side.
const FAREWELL: Duration = Duration::from_secs(1);

/// How often it is looked, when the program ends, whether a client was told everything.
const BREATH: Duration = Duration::from_millis(2);

/// The two ends of a connection.
pub(super) struct Ends {
    pub(super) client: Box<dyn Stream>,
    /// What the client has sent already.
    pub(super) heard: BytesMut,
    pub(super) engine: TcpStream,
}

/// The way to the client and back, and that to the engine.
type ToClient = (ReadHalf<Box<dyn Stream>>, WriteHalf<Box<dyn Stream>>);
type ToEngine = (OwnedReadHalf, OwnedWriteHalf);

/// Whose connection it is.
pub(super) type Whose<'a> = (&'a Identity, &'a Access, Clock);

/// The gate in the middle, and what has come from both sides.
struct Pump {
    turnstile: Turnstile,
    clock: Clock,
    from_client: BytesMut,
    from_engine: BytesMut,
    /// The client has published in a flood, and these subscribers do not keep up.
    waiting: Option<Waiting>,
    /// Nothing more comes from the client.
    has_ended: bool,
}

#[derive(Clone)]
struct Waiting {
    ledgers: Arc<[Arc<Ledger>]>,
    until: Duration,
}

/// Runs until it has to end; why.
pub(super) async fn run(turnstile: Turnstile, ends: Ends, mut slot: Slot, mut engine: Running, whose: Whose<'_>) -> Ended {
    let Ends { client, heard, engine: upstream } = ends;
    let (mut client, mut upstream) = (tokio::io::split(client), upstream.into_split());
    let mut pump =
        Pump { turnstile, clock: whose.2, from_client: heard, from_engine: BytesMut::new(), waiting: None, has_ended: false };
    let ended = tokio::select! {
        ended = pump.flow(&mut client, &mut upstream) => ended,
        () = slot.wanted() => Ended::TakenOver,
        changed = engine.changed() => if changed.is_ok() { Ended::EngineGone } else { Ended::Closing },
        () = shut_out(whose) => Ended::NotKnown,
    };
    let ended = if ended == Ended::Closing { pump.see_out(&mut client, &mut upstream).await } else { ended };
    pump.turnstile.handle_end(ended);
    let (to_engine, to_client) = pump.turnstile.outgoing();
    let to_client = async {
        // Whoever is gone already hears nothing.
        let _ = client.1.write_all(to_client).await;
        let _ = client.1.shutdown().await;
        if ended == Ended::Closing {
            // The program goes on ending when this connection is closed; what is on its way is there only when the other side has
            // closed it, too.
            while let Ok(1..) = client.0.read(&mut [0; 512]).await {}
        }
    };
    let farewell = async { tokio::join!(to_client, leave(&mut upstream, to_engine)) };
    let _ = tokio::time::timeout(FAREWELL, farewell).await;
    slot.remember(pump.turnstile.into_session());
    ended
}

impl Pump {
    /// The program ends: moves bytes until the client was told everything that was published for it, as that the program ends. Whoever
    /// ends connections bounds the time for this.
    async fn see_out(&mut self, client: &mut ToClient, engine: &mut ToEngine) -> Ended {
        let ledger = self.turnstile.ledger();
        let settled = async {
            while !ledger.is_settled() {
                tokio::time::sleep(BREATH).await;
            }
        };
        tokio::select! {
            ended = self.flow(client, engine) => ended,
            () = settled => Ended::Closing,
        }
    }

    /// Moves bytes until something ends it.
    async fn flow(&mut self, (client, to_client): &mut ToClient, (engine, to_engine): &mut ToEngine) -> Ended {
        let mut outcome = self.client_said();
        loop {
            if let Err(ended) = outcome {
                return ended;
            }
            let behind = self.behind();
            let is_looked_through = !self.has_ended && self.from_client.len() < READ;
            let hears_client = if behind.is_some() { is_looked_through } else { self.turnstile.wants_client() };
            let hears_engine = self.turnstile.wants_engine();
            let silent_until = self.turnstile.poll_timeout();
            self.from_client.reserve(READ);
            self.from_engine.reserve(READ);
            let has_more = self.turnstile.wants_turn();
            let (for_engine, for_client) = self.turnstile.outgoing();
            outcome = tokio::select! {
                biased;
                written = to_engine.write_buf(for_engine), if !for_engine.is_empty() => went(written, Ended::EngineGone),
                written = to_client.write_buf(for_client), if !for_client.is_empty() => {
                    self.turnstile.handle_drained();
                    went(written, Ended::Gone)
                }
                read = client.read_buf(&mut self.from_client), if hears_client => {
                    self.has_ended = matches!(read, Ok(0));
                    // What a client has said that had to wait is taken before its end is.
                    if self.has_ended && behind.is_some() { Ok(()) } else { went(read, Ended::Gone).and_then(|()| self.client_said()) }
                }
                read = engine.read_buf(&mut self.from_engine), if hears_engine => {
                    acknowledge_at_once(engine);
                    went(read, Ended::EngineGone).and_then(|()| self.turnstile.handle_engine(&mut self.from_engine))
                }
                () = caught_up(behind.as_ref(), self.clock) => {
                    self.waiting = None;
                    self.client_said()
                }
                () = tokio::task::yield_now(), if has_more => {
                    self.turnstile.handle_drained();
                    Ok(())
                }
                () = self.clock.reach(Some(silent_until)) => self.turnstile.handle_timeout(self.clock.now().since_start),
            };
        }
    }

    /// For whom nothing is read from the client, and until when.
    fn behind(&mut self) -> Option<Waiting> {
        let now = self.clock.now().since_start;
        if self.waiting.is_none() {
            let ledgers = self.turnstile.poll_behind(now);
            self.waiting = (!ledgers.is_empty()).then(|| Waiting { ledgers: ledgers.into(), until: now + PATIENCE });
        }
        self.waiting.clone()
    }

    /// A client that has to wait is heard for a STOP alone; the rest stays where it is.
    fn client_said(&mut self) -> Result<(), Ended> {
        if self.waiting.is_some() {
            self.turnstile.handle_waiting(&self.from_client);
            return Ok(());
        }
        self.turnstile.handle_client(&mut self.from_client, self.clock.now().since_start)
    }
}

/// Waits until all subscribers have caught up, or were waited for long enough; for ever, when there is none to wait for.
async fn caught_up(waiting: Option<&Waiting>, clock: Clock) {
    let Some(Waiting { ledgers, until }) = waiting else { return std::future::pending().await };
    let all_relieved = async {
        for ledger in ledgers.iter() {
            ledger.relieved().await;
        }
    };
    tokio::select! {
        () = all_relieved => {}
        () = clock.reach(Some(*until)) => {
            let now = clock.now().since_start;
            ledgers.iter().filter(|ledger| ledger.is_behind(now)).for_each(|ledger| ledger.forgive(now));
        }
    }
}

/// The engine holds its next small packet back until the system has acknowledged the last one, which may be 40 ms later unless it is
/// told each time not to wait.
fn acknowledge_at_once(engine: &OwnedReadHalf) {
    #[cfg(target_os = "linux")]
    if let Err(error) = engine.as_ref().set_quickack(true) {
        tracing::debug!(%error, "small packets of the engine will be held back");
    }
    #[cfg(not(target_os = "linux"))]
    let _ = engine;
}

/// Sends the last words to the engine, and waits until it has closed the connection as well: one that hears of an end later than of the
/// next client with the same number ends that one.
async fn leave((engine, to_engine): &mut (OwnedReadHalf, OwnedWriteHalf), last_words: &[u8]) {
    let _ = to_engine.write_all(last_words).await;
    let _ = to_engine.shutdown().await;
    let mut unheard = [0; 4096];
    while let Ok(1..) = engine.read(&mut unheard).await {}
}

/// Whether anything went through.
fn went(moved: std::io::Result<usize>, else_: Ended) -> Result<(), Ended> {
    match moved {
        Ok(1..) => Ok(()),
        Ok(0) | Err(_) => Err(else_),
    }
}

/// Waits until whoever was let in would not be any more.
async fn shut_out((identity, access, clock): Whose<'_>) {
    while identity.is_known(access, clock.now().wall.unix_ms.div_euclid(1000)) {
        tokio::time::sleep(GLANCE).await;
    }
}
