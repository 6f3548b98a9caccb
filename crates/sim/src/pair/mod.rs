//! The simulated pair, sans-IO: two mobile manipulators and the parcel between them, which couples them, so that all
//! three are one object. Orders, halts and the passing of time go in, reports come out, and nothing here waits. Other
//! crates decide what to do next.
//!
//! ```text
//!   orders ─► orders ─► robot, robot ─┐
//!                                     ├─► passing ─► reports        memory: what all of them retain
//!   ground (the hall as it is now) ── grip ┘
//! ```
//! A robot that holds nothing is independent. Once both grippers are closed round a parcel, a step begins when both
//! have their order for it, and anything that stops one robot stops the other.

mod grip;
mod ground;
mod memory;
mod orders;
pub mod page;
mod passing;
mod robot;
mod settings;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

pub use self::grip::{ANGLE_LIMIT, FORCE_LIMIT_N, FORCE_N, GAP_LIMIT_M, Holding, Spread};
use self::grip::{Grip, STEP};
use self::ground::PairGround;
pub use self::memory::{AstrayMemory, PairMemory, RobotMemory};
use self::robot::{Astray, Robot, body_of};
pub use self::settings::{Mishaps, PairSettings, Slip};
use super::drive::BodyPose;
use super::hall::Hall;
use super::memory::{micro, reseeded};
use hallsweep_core::arm::{ArmState, Parcel};
use hallsweep_core::effect::Order;
use hallsweep_core::event::{Capabilities, RobotEvent, Whereabouts};
use hallsweep_core::pair::Which;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::robot::Parts;
use hallsweep_core::units::{Cell, Now, Piece, Pose};

#[derive(Debug)]
pub struct Pair {
    ground: PairGround,
    settings: PairSettings,
    now: Duration,
    robots: [Robot; 2],
    grip: Option<Grip>,
    /// When the grip is next computed, and when a lifted parcel is next reported.
    next_step: Duration,
    next_report: Duration,
    noise: RandomStream,
    looks: RandomStream,
    events: VecDeque<(Which, RobotEvent)>,
    slips: Vec<Slip>,
    unrecognised: Vec<u32>,
    holding: Holding,
    restarts: u32,
    /// Whether something has changed that must be stored.
    unkept: bool,
}

impl Pair {
    /// Two robots that were just put down. The first reports are the poses of both robots, their arms, and `LinkUp`.
    #[must_use]
    pub fn new(hall: Arc<Hall>, settings: PairSettings, stands: [BasePose; 2]) -> Pair {
        Pair::placed(hall, settings, PairMemory::new(stands), Duration::ZERO)
    }

    /// What each robot can do, with times in simulated time. The time of a step is that of a step with a load.
    #[must_use]
    pub fn capabilities(&self) -> Capabilities {
        let PairSettings { step, loaded_step, turn, look, arm, .. } = self.settings;
        Capabilities {
            step: step.max(loaded_step),
            turn,
            photo: Duration::ZERO,
            arm: look.max(arm),
            nudges: false,
            parts: Parts::MANIPULATOR,
        }
    }

    /// Begins an order, or answers at once why it cannot. An order that only both can carry out begins when the other
    /// robot has its part of the order too.
    pub fn handle_order(&mut self, which: Which, order: Order, now: Now) {
        self.pass_to(now.since_start);
        if let Some(task) = &self.robots[which.index()].task {
            let words = format!("order {} is still under way", task.order);
            return self.say(which, RobotEvent::Failed(order.id, words));
        }
        match self.work_of(which, order.action) {
            Ok(work) => self.take(which, order, work),
            Err(words) => self.say(which, RobotEvent::Failed(order.id, words.to_owned())),
        }
        // An action without duration is done at once.
        self.pass_to(now.since_start);
    }

    /// Stops wheels and arm of one robot where they are; the other robot stops too if they carry a parcel together.
    /// Controllers that hold the parcel go on.
    pub fn handle_halt(&mut self, which: Which, now: Now) {
        self.pass_to(now.since_start);
        self.halt(which);
    }

    /// Handles everything that is due by `now`, in order of time.
    pub fn handle_timeout(&mut self, now: Now) {
        self.pass_to(now.since_start);
    }

    pub fn poll_event(&mut self) -> Option<(Which, RobotEvent)> {
        self.events.pop_front()
    }

    /// When the next report is due, since the start of the run.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.next_heard()
    }

    /// Closes a cell for good. Returns false, and changes nothing, if a robot or a parcel is in the cell.
    pub fn close_cell(&mut self, cell: Cell) -> bool {
        let in_use = self.is_in_use(cell);
        if !in_use {
            self.ground.close(cell);
            self.unkept = true;
        }
        !in_use
    }

    /// Puts temporary obstacles into these cells, and removes all others. Returns whether all could be put: a cell with
    /// a robot or a parcel gets no obstacle.
    pub fn handle_blocked(&mut self, cells: &BTreeSet<Cell>) -> bool {
        let (taken, free): (BTreeSet<Cell>, BTreeSet<Cell>) = cells.iter().partition(|cell| self.is_in_use(**cell));
        self.ground.block(free);
        taken.is_empty()
    }

    fn is_in_use(&self, cell: Cell) -> bool {
        let place = Place::Cell(cell);
        self.robots.iter().any(|robot| robot.is_in_or_enters(place, self.now))
            || self.load().is_some_and(|parcel| parcel.place == place)
            || self.ground.piece_at(place).is_some()
    }

    pub fn tell_capabilities(&mut self) {
        let can = self.capabilities();
        self.events.extend(Which::ALL.map(|which| (which, RobotEvent::LinkUp(can))));
    }

    /// Whether one robot waits for the other's part of an order that only both can carry out.
    #[must_use]
    pub fn awaits_the_other(&self) -> bool {
        self.robots.iter().any(|robot| robot.task.as_ref().is_some_and(|task| task.run.is_none()))
    }

    #[must_use]
    pub const fn is_busy(&self, which: Which) -> bool {
        self.robots[which.index()].task.is_some()
    }

    /// Where the last completed order left a robot, and whether it stands away from there.
    #[must_use]
    pub fn stands(&self, which: Which) -> (BasePose, bool) {
        let robot = &self.robots[which.index()];
        (robot.stands, robot.astray_at(self.now) != Astray::Not)
    }

    #[must_use]
    pub fn body(&self, which: Which) -> BodyPose {
        self.robots[which.index()].body_at(self.now, self.ground.hall().cell_m())
    }

    #[must_use]
    pub fn arm(&self, which: Which) -> ArmState {
        let robot = &self.robots[which.index()];
        let still =
            ArmState { gripper: robot.gripper, aligned: robot.aligned, controllers: robot.controllers, ..ArmState::default() };
        let Some(grip) = &self.grip else { return still };
        ArmState {
            holds: Some(grip.parcel),
            lifted: grip.height >= 1.0,
            on_floor: !grip.is_loaded(),
            force_mn: thousandths(FORCE_N + grip.force.error),
            angle_urad: millionths(grip.angle.error),
            gap_um: millionths(grip.gap.error),
            ..still
        }
    }

    /// The parcel in the grippers, with the place on which it stands or over which it is held.
    #[must_use]
    pub fn load(&self) -> Option<Parcel> {
        self.grip.as_ref().map(|grip| grip.parcel)
    }

    /// Where the middle of the parcel in the grippers really is, in metres to the east and to the south of home, and
    /// how high it is lifted, 0–1.
    #[must_use]
    pub fn load_m(&self) -> Option<(f64, f64, f64)> {
        let grip = self.grip.as_ref()?;
        let cell_m = self.ground.hall().cell_m();
        let centre = |place: Place| {
            let BodyPose { x_m, y_m, .. } = body_of(BasePose { place, heading: Pose::START.heading }, cell_m);
            (x_m, y_m)
        };
        let (x, y) = centre(grip.parcel.place);
        // The parcel goes to where the leading base has stood.
        let leads = |robot: &&Robot| matches!(robot.astray_at(self.now), Astray::Along(to, _) if to != grip.parcel.place);
        let Some(leader) = self.robots.iter().find(leads) else { return Some((x, y, grip.height)) };
        let Astray::Along(_, share) = leader.astray_at(self.now) else { return Some((x, y, grip.height)) };
        let (to_x, to_y) = centre(leader.stands.place);
        Some((x + (to_x - x) * share, y + (to_y - y) * share, grip.height))
    }

    #[must_use]
    pub fn taken_in(&self) -> &[Piece] {
        self.ground.taken_in()
    }

    /// Pieces on the floor that were moved, each where it was put down or fell.
    #[must_use]
    pub fn lying(&self) -> Vec<(Piece, Place)> {
        self.ground.lying().collect()
    }

    /// Every piece that was ever lifted, and the cell in which it lies now; `None` if it lies in no cell.
    #[must_use]
    pub fn moved(&self) -> BTreeMap<Piece, Option<Cell>> {
        self.ground.moved().map(|(piece, place)| (piece, place.and_then(Place::cell))).collect()
    }

    #[must_use]
    pub const fn holding(&self) -> &Holding {
        &self.holding
    }

    /// Mishaps that are still to come. A jammed gripper stays jammed.
    #[must_use]
    pub fn mishaps_left(&self) -> Mishaps {
        let jams = self.settings.mishaps.jams.clone();
        Mishaps { slips: self.slips.clone(), unrecognised: self.unrecognised.clone(), jams }
    }

    /// The state to store, once whenever something has changed that a report or the next motion depends on.
    pub fn poll_memory(&mut self) -> Option<PairMemory> {
        std::mem::take(&mut self.unkept).then(|| self.memory())
    }

    /// The current parcel, counted from 1.
    fn parcel_number(&self) -> u32 {
        u32::try_from(self.ground.taken_in().len()).unwrap_or(u32::MAX).saturating_add(1)
    }

    fn look(&mut self, place: Place) -> Option<Parcel> {
        let number = self.parcel_number();
        let asked = self.unrecognised.iter().position(|parcel| *parcel == number).map(|index| self.unrecognised.remove(index));
        let fails = self.looks.happens(self.settings.unrecognised_rate);
        self.ground.nearest(place).filter(|_| asked.is_none() && !fails)
    }

    fn introduce(&mut self) {
        for which in Which::ALL {
            let (BasePose { place, heading }, off_centre) = self.stands(which);
            let stands = match place {
                Place::Cell(cell) => RobotEvent::Stands(Whereabouts { pose: Pose { cell, heading }, off_centre }),
                Place::Outside(steps) => RobotEvent::StandsOutside(steps, heading, off_centre),
            };
            let can = self.capabilities();
            let arm = RobotEvent::Arm(self.arm(which));
            let lost = self.lost().map(RobotEvent::ParcelLost);
            let told = [stands, arm].into_iter().chain(lost).chain([RobotEvent::LinkUp(can)]);
            let told: Vec<_> = told.map(|event| (which, event)).collect();
            self.events.extend(told);
        }
    }

    /// Parcels that lie where they fell or were released. A program that was killed just then has no record of these
    /// parcels.
    fn lost(&self) -> impl Iterator<Item = Parcel> {
        let held = self.load().map(|parcel| parcel.piece);
        self.ground.lying().filter(move |(piece, _)| held != Some(*piece)).map(|(piece, place)| Parcel { piece, place })
    }

    fn placed(hall: Arc<Hall>, settings: PairSettings, memory: PairMemory, now: Duration) -> Pair {
        let settings = settings.sound();
        let seed = reseeded(settings.seed, memory.restarts);
        let mut pair = Pair {
            ground: PairGround::remembered(hall, &memory.lying, &memory.taken_in, &memory.closed),
            now,
            robots: memory.robots(),
            grip: memory.grip(),
            next_step: now + STEP,
            next_report: now,
            noise: RandomStream::new(seed, "grip"),
            looks: RandomStream::new(seed, "look"),
            events: VecDeque::new(),
            slips: memory.slips.unwrap_or_else(|| settings.mishaps.slips.clone()),
            unrecognised: memory.unrecognised.unwrap_or_else(|| settings.mishaps.unrecognised.clone()),
            holding: Holding::default(),
            restarts: memory.restarts,
            unkept: true,
            settings,
        };
        pair.introduce();
        pair
    }
}

#[expect(clippy::cast_possible_truncation, reason = "a cast from a double ends at the bounds of the integer")]
fn thousandths(number: f64) -> i32 {
    (number * 1e3).round() as i32
}

#[expect(clippy::cast_possible_truncation, reason = "a cast from a double ends at the bounds of the integer")]
fn millionths(number: f64) -> i32 {
    micro(number) as i32
}
