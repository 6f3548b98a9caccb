//! How the links of simulated robots are told what the simulator's controls say: the controls are a latest state, which each link obeys as it
//! comes to it; another hall is handed to each in turn, when it is ready for it and the core has agreed.
//!
//! ```text
//!   controls ── speed, pause, faults ─────────► every link      (latest state)
//!            ── another hall comes ───────────► a link          it hands over what it has to report, begins nothing more,
//!            ◄─ ready ────────────────────────                  and still obeys halts
//!            ── this one, or none after all ──►                 it puts its robot down there, or goes on
//!            ◄─ put down ─────────────────────
//! ```

use std::collections::BTreeSet;
use std::sync::Arc;

use tokio::sync::{mpsc, oneshot, watch};

use hallsweep_core::units::Cell;
use hallsweep_sim::{Faults, Hall, Speed};

/// Everything that the controls say just now.
#[derive(Clone, Debug, Default)]
pub(in crate::robots) struct Controls {
    /// As fast as the settings say of each robot while nobody says otherwise.
    pub(super) speed: Option<Speed>,
    pub(super) is_paused: bool,
    /// How often somebody took a step.
    pub(super) steps: u64,
    /// Of the robot that searches.
    pub(super) is_link_lost: bool,
    pub(super) faults: Faults,
    pub(super) blocked: Arc<BTreeSet<Cell>>,
}

/// A hall and the seed of the noise in it.
#[derive(Clone, Debug)]
pub(in crate::robots) struct SimulatedHall {
    pub(in crate::robots) hall: Arc<Hall>,
    pub(in crate::robots) seed: u64,
}

/// Another hall comes, perhaps.
#[derive(Debug)]
pub(in crate::robots) struct Move {
    pub(super) ready: Option<oneshot::Sender<()>>,
    pub(super) decided: oneshot::Receiver<SimulatedHall>,
    pub(super) put_down: oneshot::Sender<()>,
}

/// A link's end.
#[derive(Debug)]
pub(in crate::robots) struct Remote {
    pub(super) controls: watch::Receiver<Controls>,
    pub(super) moves: mpsc::Receiver<Move>,
    /// The move that is under way.
    under_way: Option<Move>,
}

impl Remote {
    pub(in crate::robots) fn new(controls: watch::Receiver<Controls>) -> (Remote, mpsc::Sender<Move>) {
        let (ask, moves) = mpsc::channel(1);
        (Remote { controls, moves, under_way: None }, ask)
    }

    /// One that nobody has in hand.
    pub(in crate::robots) fn untouched() -> Remote {
        Remote::new(watch::channel(Controls::default()).1).0
    }

    /// Whether the robot is to begin nothing, because another hall may come.
    pub(super) const fn is_moving(&self) -> bool {
        self.under_way.is_some()
    }

    /// Says that nothing is on its way any more.
    pub(super) fn say_ready(&mut self) {
        if let Some(ready) = self.under_way.as_mut().and_then(|under_way| under_way.ready.take()) {
            // Whoever asked may have given up; then nothing is decided, either.
            let _ = ready.send(());
        }
    }

    /// Waits for what there is to do, only while the link has settled: nothing of it is on its way. Of controls that change meanwhile the
    /// last are obeyed, so that what is to be reported of each cannot pile up.
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

/// What a link hears of the simulator's controls.
#[derive(Debug)]
pub(super) enum News {
    /// They say something else.
    Controls,
    /// Another hall comes, perhaps: nothing more is to be begun.
    Asked,
    /// This one, and whom to tell; or none.
    Decided(Option<(SimulatedHall, oneshot::Sender<()>)>),
}

async fn decided(under_way: &mut Option<Move>) -> Option<SimulatedHall> {
    let Some(under_way) = under_way else { return std::future::pending().await };
    (&mut under_way.decided).await.ok()
}
