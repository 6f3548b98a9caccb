//! Passes the simulator's controls to the links of simulated robots. Only the latest state of the controls
//! counts, and each link applies it when it can. A move to another hall is passed to each link in turn. The move
//! takes place when the links are ready and the core has agreed.
//!
//! ```text
//!   controls ── speed, pause, faults ─────────► every link      (latest state)
//!            ── another hall comes ───────────► a link          it delivers its reports, begins nothing more,
//!            ◄─ ready ────────────────────────                  and still obeys halts
//!            ── the new hall, or no move ─────►                 it puts its robot into the new hall, or continues
//!            ◄─ put down ─────────────────────
//! ```

use std::collections::BTreeSet;
use std::sync::Arc;

use tokio::sync::{mpsc, oneshot, watch};

use hallsweep_core::speed::Speed;
use hallsweep_core::units::Cell;
use hallsweep_sim::{Faults, Hall};

#[derive(Clone, Debug, Default)]
pub(in crate::robots) struct Controls {
    /// The chosen speed; `None` for the speed in each robot's settings.
    pub(super) speed: Option<Speed>,
    pub(super) is_paused: bool,
    pub(super) steps: u64,
    pub(super) is_link_lost: bool,
    pub(super) faults: Faults,
    pub(super) blocked: Arc<BTreeSet<Cell>>,
}

#[derive(Clone, Debug)]
pub(in crate::robots) struct SimulatedHall {
    pub(in crate::robots) hall: Arc<Hall>,
    pub(in crate::robots) seed: u64,
}

#[derive(Debug)]
pub(in crate::robots) struct Move {
    pub(super) ready: Option<oneshot::Sender<()>>,
    pub(super) decided: oneshot::Receiver<SimulatedHall>,
    pub(super) put_down: oneshot::Sender<()>,
}

#[derive(Debug)]
pub(in crate::robots) struct Remote {
    pub(super) controls: watch::Receiver<Controls>,
    pub(super) moves: mpsc::Receiver<Move>,
    under_way: Option<Move>,
}

impl Remote {
    pub(in crate::robots) fn new(controls: watch::Receiver<Controls>) -> (Remote, mpsc::Sender<Move>) {
        let (ask, moves) = mpsc::channel(1);
        (Remote { controls, moves, under_way: None }, ask)
    }

    pub(in crate::robots) fn untouched() -> Remote {
        Remote::new(watch::channel(Controls::default()).1).0
    }

    /// Whether the robot must not begin anything, because it may be moved to another hall.
    pub(super) const fn is_moving(&self) -> bool {
        self.under_way.is_some()
    }

    pub(super) fn say_ready(&mut self) {
        if let Some(ready) = self.under_way.as_mut().and_then(|under_way| under_way.ready.take()) {
            // The requester may have stopped waiting. In this case it sends no decision either.
            let _ = ready.send(());
        }
    }

    /// Waits for the next change. Receives a change only when the link has no report to deliver and writes no file
    /// (`has_settled`). If the controls change several times, only the last change is applied, so that the resulting
    /// reports cannot pile up.
    pub(super) async fn news(&mut self, has_settled: bool) -> News {
        let Remote { controls, moves, under_way } = self;
        let is_moving = under_way.is_some();
        tokio::select! {
            biased;
            ground = decided(under_way), if has_settled && is_moving => {
                News::Decided(ground.and_then(|ground| Some((ground, under_way.take()?.put_down))).or_else(|| {
                    *under_way = None;
                    None
                }))
            }
            Ok(()) = controls.changed(), if has_settled => News::Controls,
            Some(asked) = moves.recv(), if has_settled && !is_moving => {
                *under_way = Some(asked);
                News::Asked
            }
            else => std::future::pending().await,
        }
    }
}

#[derive(Debug)]
pub(super) enum News {
    Controls,
    /// A move to another hall may follow, so the link must begin nothing more.
    Asked,
    /// The new hall, and the channel on which to report the move as done; `None` when there is no move.
    Decided(Option<(SimulatedHall, oneshot::Sender<()>)>),
}

async fn decided(under_way: &mut Option<Move>) -> Option<SimulatedHall> {
    let Some(under_way) = under_way else { return std::future::pending().await };
    (&mut under_way.decided).await.ok()
}
