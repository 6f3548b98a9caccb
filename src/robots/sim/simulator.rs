//! The simulator as the doors (HTTP, CoAP, MQTT) see and change it while it runs. This file also moves all simulated
//! robots into another hall.
//!
//! A move has these steps. Every link delivers its reports and begins nothing more. The core agrees, records the
//! move, and marks the robots as not yet reached. The pair is moved, then the other robots. The hall is stored for a
//! restart, and each robot reports its position. A kill in between leaves some robots and the record in different
//! halls, which the next start corrects (`app::data_folder`).

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{Mutex, mpsc, oneshot, watch};

use super::chosen_hall::{ChosenHall, file_of};
use super::kept_halls::{fitting, size};
use super::offered_halls::Offered;
use super::remote::{Controls, Move, SimulatedHall};
use crate::runtime::handle::{Gone, Handle};
use crate::runtime::simulator::{
    Change, Changing, Faults, HallFacts, HallSource, MOST_BLOCKED, NotSimulated, OtherHall, Simulator, SimulatorState,
};
use hallsweep_core::command::Issuer;
use hallsweep_core::hold::Hold;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::{RobotId, RobotState};
use hallsweep_core::simulated::Simulated;
use hallsweep_core::speed::Speed;
use hallsweep_core::state::Venue;
use hallsweep_core::units::Cell;
use hallsweep_core::world::coverage::Sensor;
use hallsweep_sim::{Hall, Truth};

/// Maximum time for a robot to get ready for another hall, and again to report its position there. It includes the
/// time in which the robot's state file is written.
const READY_WITHIN: Duration = Duration::from_secs(5);

pub(in crate::robots) struct Parts {
    pub(in crate::robots) ground: SimulatedHall,
    pub(in crate::robots) speed: Speed,
    pub(in crate::robots) controls: watch::Sender<Controls>,
    /// The simulated robots. `links` has the channels to their links, the pair's channels first.
    pub(in crate::robots) robots: Vec<RobotId>,
    pub(in crate::robots) links: Vec<mpsc::Sender<Move>>,
    pub(in crate::robots) chosen: Option<ChosenHall>,
    pub(in crate::robots) usual: (String, Option<(u32, u32)>),
    /// What is the same in every hall: the robots and their sensor.
    pub(in crate::robots) team: Venue,
}

/// The simulator before it has a handle to the core. It needs the handle to ask the core for consent to a change of
/// hall.
pub struct SimulatorParts(pub(in crate::robots) Parts);

impl SimulatorParts {
    pub fn in_hand_of(self, handle: Handle) -> Arc<dyn Simulator> {
        let Parts { ground, speed, controls, robots, links, chosen, usual, team } = self.0;
        let state =
            SimulatorState { hall: facts(&ground.hall), seed: ground.seed, speed, is_paused: false, faults: Faults::default() };
        let (state, turn) = (watch::Sender::new(Arc::new(state)), Mutex::new(ground));
        let offered = Arc::new(Offered::with(&usual.0, usual.1, chosen.as_ref().map(ChosenHall::folder)));
        Arc::new(InHand { handle, state, controls, turn, robots, links, chosen, offered, team })
    }
}

struct InHand {
    handle: Handle,
    state: watch::Sender<Arc<SimulatorState>>,
    controls: watch::Sender<Controls>,
    /// The hall in which the robots are. The lock allows only one change at a time.
    turn: Mutex<SimulatedHall>,
    robots: Vec<RobotId>,
    links: Vec<mpsc::Sender<Move>>,
    chosen: Option<ChosenHall>,
    offered: Arc<Offered>,
    team: Venue,
}

impl Simulator for InHand {
    fn watch(&self) -> watch::Receiver<Arc<SimulatorState>> {
        self.state.subscribe()
    }

    fn halls(&self) -> Vec<String> {
        self.offered.names()
    }

    fn kept_halls(&self) -> Vec<String> {
        self.offered.kept()
    }

    fn hall(&self, name: &str) -> Result<String, NotSimulated> {
        self.offered.named(name).map(|hall| file_of(&hall))
    }

    fn change(self: Arc<Self>, change: Change, issuer: Issuer) -> Changing {
        Box::pin(async move {
            let ground = self.turn.lock().await;
            check_blocked(&ground.hall, change.blocked.as_ref())?;
            if change == Change::default() {
                return Ok(self.now());
            }
            self.handle.note_simulated(issuer, Simulated::Changed(change.clone())).await?;
            self.take(change);
            Ok(self.now())
        })
    }

    fn step(self: Arc<Self>, issuer: Issuer) -> Changing {
        Box::pin(async move {
            let _turn = self.turn.lock().await;
            if !self.state.borrow().is_paused {
                return Err(NotSimulated::NotPaused);
            }
            let snapshot = self.handle.snapshot();
            if snapshot.robots.iter().all(|robot| robot.view.state == RobotState::Stopped) {
                return Err(NotSimulated::NothingUnderWay);
            }
            self.handle.note_simulated(issuer, Simulated::Step).await?;
            self.controls.send_modify(|controls| controls.steps += 1);
            Ok(self.now())
        })
    }

    fn put_down(self: Arc<Self>, hall: OtherHall, issuer: Issuer) -> Changing {
        Box::pin(async move {
            let mut ground = self.turn.lock().await;
            self.must_be_recorded()?;
            let seed = hall.seed.unwrap_or(ground.seed);
            let hall = self.on_disk(move |offered| read(hall.source, offered)).await?;
            let next = SimulatedHall { hall: Arc::new(hall), seed };
            self.move_all(&next, issuer).await?;
            let unkept = self.keep_for_restart(&next).await;
            // Obstacles of the previous hall do not apply to the new hall.
            self.controls.send_modify(|controls| controls.blocked = Arc::default());
            *ground = next;
            self.state.send_modify(|state| {
                let faults = Faults { blocked: BTreeSet::new(), ..state.faults.clone() };
                let hall = facts(&ground.hall);
                *state = Arc::new(SimulatorState { hall, seed: ground.seed, faults, ..SimulatorState::clone(state) });
            });
            self.until_reached().await;
            unkept.map_or_else(|| Ok(self.now()), |why| Err(NotSimulated::NotKept(why)))
        })
    }

    fn keep(self: Arc<Self>, name: String, toml: String, may_replace: bool, issuer: Issuer) -> Changing {
        Box::pin(async move {
            let _turn = self.turn.lock().await;
            self.must_be_recorded()?;
            let kept = Simulated::Kept(name.clone());
            let keep = move |offered: &Offered| {
                let hall = Hall::parse(&format!("{name}.toml"), &toml).map_err(|error| NotSimulated::Hall(error.to_string()))?;
                offered.keep(&name, &fitting(hall)?.called(&name), may_replace)
            };
            self.on_disk(keep).await?;
            self.handle.note_simulated(issuer, kept).await?;
            Ok(self.now())
        })
    }

    fn discard(self: Arc<Self>, name: String, issuer: Issuer) -> Changing {
        Box::pin(async move {
            let _turn = self.turn.lock().await;
            self.must_be_recorded()?;
            let discarded = Simulated::Discarded(name.clone());
            self.on_disk(move |offered| offered.discard(&name)).await?;
            self.handle.note_simulated(issuer, discarded).await?;
            Ok(self.now())
        })
    }
}

impl InHand {
    async fn on_disk<T: Send + 'static>(
        &self,
        act: impl FnOnce(&Offered) -> Result<T, NotSimulated> + Send + 'static,
    ) -> Result<T, NotSimulated> {
        let offered = Arc::clone(&self.offered);
        tokio::task::spawn_blocking(move || act(&offered)).await.map_err(|_| Gone)?
    }

    /// Refuses a change of hall while nothing can be recorded, because the record must have every change.
    fn must_be_recorded(&self) -> Result<(), NotSimulated> {
        let is_down = self.handle.snapshot().mission.holds.contains(&Hold::Store);
        if is_down { Err(Refused::StoreDown.into()) } else { Ok(()) }
    }

    fn now(&self) -> Arc<SimulatorState> {
        Arc::clone(&self.state.borrow())
    }

    fn take(&self, change: Change) {
        let Change { speed, is_paused, link_lost, no_thermometer, camera_fails, blocked } = change;
        self.state.send_modify(|state| {
            let faults = Faults {
                link_lost: link_lost.unwrap_or(state.faults.link_lost),
                no_thermometer: no_thermometer.unwrap_or(state.faults.no_thermometer),
                camera_fails: camera_fails.unwrap_or(state.faults.camera_fails),
                blocked: blocked.unwrap_or_else(|| state.faults.blocked.clone()),
            };
            *state = Arc::new(SimulatorState {
                speed: speed.unwrap_or(state.speed),
                is_paused: is_paused.unwrap_or(state.is_paused),
                faults,
                ..SimulatorState::clone(state)
            });
        });
        let SimulatorState { is_paused, faults, .. } = &*self.now();
        self.controls.send_modify(|controls| {
            *controls = Controls {
                speed: speed.or(controls.speed),
                is_paused: *is_paused,
                steps: controls.steps,
                is_link_lost: faults.link_lost,
                faults: hallsweep_sim::Faults { no_thermometer: faults.no_thermometer, camera_fails: faults.camera_fails },
                blocked: Arc::new(faults.blocked.clone()),
            };
        });
    }

    /// Moves all links into another hall if the core agrees. A link whose request is dropped stays in the present
    /// hall.
    async fn move_all(&self, next: &SimulatedHall, issuer: Issuer) -> Result<(), NotSimulated> {
        let mut moves = Vec::new();
        for link in &self.links {
            let ((ready, is_ready), (decide, decided), (put_down, is_put_down)) =
                (oneshot::channel(), oneshot::channel(), oneshot::channel());
            let asked = Move { ready: Some(ready), decided, put_down };
            let begun = async { link.send(asked).await.ok().and(is_ready.await.ok()) };
            if tokio::time::timeout(READY_WITHIN, begun).await.ok().flatten().is_none() {
                return Err(NotSimulated::Hall(
                    "a simulated robot does not answer: look into the log, and start hallsweep again".into(),
                ));
            }
            moves.push((decide, is_put_down));
        }
        let venue = venue(&next.hall, next.seed, &self.team);
        self.handle.put_down(issuer, venue, self.robots.clone()).await??;
        for (decide, is_put_down) in moves {
            if decide.send(next.clone()).is_err() || is_put_down.await.is_err() {
                tracing::error!("a simulated robot stopped working during the move to another hall");
            }
        }
        Ok(())
    }

    /// Waits until the robots have reported their positions, so that START works right after the answer. Does not
    /// wait for a robot whose link is lost by a simulated fault.
    async fn until_reached(&self) {
        if self.now().faults.link_lost {
            return;
        }
        let mut states = self.handle.watch();
        let reached = states
            .wait_for(|state| !state.robots.iter().any(|shown| self.robots.contains(&shown.id) && shown.unreached.is_some()));
        if tokio::time::timeout(READY_WITHIN, reached).await.is_err() {
            tracing::warn!("the simulated robots have not reported their positions yet");
        }
    }

    /// Stores the hall for a restart. Returns the reason if this fails, otherwise `None`.
    async fn keep_for_restart(&self, next: &SimulatedHall) -> Option<String> {
        let (chosen, next) = (self.chosen.clone()?, next.clone());
        let kept = tokio::task::spawn_blocking(move || chosen.keep(&next).map_err(|error| error.to_string()));
        kept.await.unwrap_or_else(|error| Err(error.to_string())).err()
    }
}

fn read(source: HallSource, offered: &Offered) -> Result<Hall, NotSimulated> {
    let hall = match source {
        HallSource::Named(name) => offered.named(&name)?,
        HallSource::Toml(text) => Hall::parse("hall.toml", &text).map_err(|error| NotSimulated::Hall(error.to_string()))?,
    };
    fitting(hall)
}

fn check_blocked(hall: &Hall, blocked: Option<&BTreeSet<Cell>>) -> Result<(), NotSimulated> {
    let Some(blocked) = blocked else { return Ok(()) };
    if blocked.len() > MOST_BLOCKED {
        return Err(NotSimulated::TooManyBlocked(blocked.len()));
    }
    blocked.iter().find(|cell| hall.truth(**cell) != Truth::Free).map_or(Ok(()), |cell| Err(NotSimulated::NoFreeCell(*cell)))
}

/// The venue of a team of robots in this hall.
pub(in crate::robots) fn venue(hall: &Hall, seed: u64, team: &Venue) -> Venue {
    let (name, cell_m, reach) = (hall.name().into(), Some(hall.cell_m()), Some(hall.reach()));
    let (is_exercise, seed) = (hall.is_exercise(), (!hall.is_exercise()).then_some(seed));
    let model = team.sensor.model.filter(|_| hall.cell_m() == Sensor::CALIBRATED_M);
    let (sensor, areas) = (Sensor { model, ..team.sensor }, Arc::clone(hall.areas()));
    Venue { name, cell_m, reach, is_exercise, seed, areas, sensor, ..team.clone() }
}

fn facts(hall: &Hall) -> HallFacts {
    HallFacts {
        name: hall.name().into(),
        size: size(hall),
        cell_m: hall.cell_m(),
        pieces: hall.pieces().len(),
        toml: file_of(hall).into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hall_that_is_not_there_too_large_or_wrong_is_refused_in_words() {
        let why = |source| read(source, &Offered::with("seed", None, None)).expect_err("it is refused").to_string();
        assert!(why(HallSource::Named("/etc/passwd".to_owned())).contains("; it has airport, empty-8x8"));
        assert!(why(HallSource::Toml("width = 600\nheight = 2\n".to_owned())).contains("600 × 2 cells is too large"));
        assert!(why(HallSource::Toml("width = 0\nheight = 2\n".to_owned())).starts_with("hall.toml:1: "));
        assert!(read(HallSource::Toml("width = 250\nheight = 250\n".to_owned()), &Offered::with("seed", None, None)).is_ok());
    }

    #[test]
    fn only_free_cells_can_be_blocked_and_not_too_many() {
        let hall = Hall::from_rows("test", &["S.#", "a.."]).expect("a good hall");
        let why = |cells: &[Cell]| check_blocked(&hall, Some(&cells.iter().copied().collect()));
        assert_eq!(why(&[Cell::new(1, 0), Cell::new(1, 1)]), Ok(()));
        for taken in [Cell::new(2, 0), Cell::new(0, 1), Cell::new(9, 9)] {
            assert_eq!(why(&[Cell::new(1, 0), taken]), Err(NotSimulated::NoFreeCell(taken)));
        }
        let many: Vec<Cell> = (0..100).map(|x| Cell::new(x, 0)).collect();
        assert_eq!(why(&many), Err(NotSimulated::TooManyBlocked(100)));
    }
}
