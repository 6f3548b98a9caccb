//! The simulated pair of robots (mobile manipulators), without input or output of its own. The pair and the parcel
//! between its robots are one object, because the parcel couples them. Orders, halts and the time go in, and reports
//! come out. Nothing here waits. Other crates decide what to do next.
//!
//! ```text
//!   orders ─► orders ─► robot, robot ─┐
//!                                     ├─► passing ─► reports        memory: the stored state of all
//!   ground (the hall as it is now) ── grip ┘
//! ```
//! Robots that hold no parcel are independent. Once both grippers are closed around a parcel, a step begins only when
//! both robots have an order for it. Whatever stops one robot then stops the other too.

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
    /// Time of the next computation of the grip.
    next_step: Duration,
    next_report: Duration,
    noise: RandomStream,
    looks: RandomStream,
    events: VecDeque<(Which, RobotEvent)>,
    slips: Vec<Slip>,
    unrecognised: Vec<u32>,
    holding: Holding,
    restarts: u32,
    /// Whether the state has changed since it was last stored.
    unkept: bool,
}

impl Pair {
    /// Makes two new robots at these places. The first reports are the poses of both robots, their arms, and
    /// `LinkUp`.
    #[must_use]
    pub fn new(hall: Arc<Hall>, settings: PairSettings, stands: [BasePose; 2]) -> Pair {
        Pair::placed(hall, settings, PairMemory::new(stands), Duration::ZERO)
    }

    /// What each robot can do, with times in simulated time. The stated time of a step is the longer one of two
    /// times: with a load and without.
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

    /// Begins an order, or reports at once why it cannot be done. Some orders need both robots. Such an order begins
    /// when both have it.
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
        // Finishes the action at once if it has no duration.
        self.pass_to(now.since_start);
    }

    /// Stops wheels and arm of one robot where they are. The other robot stops too if both do this work together.
    /// Controllers that hold the parcel stay on.
    pub fn handle_halt(&mut self, which: Which, now: Now) {
        self.pass_to(now.since_start);
        self.halt(which);
    }

    /// Handles everything that is due up to `now`, in order of time.
    pub fn handle_timeout(&mut self, now: Now) {
        self.pass_to(now.since_start);
    }

    pub fn poll_event(&mut self) -> Option<(Which, RobotEvent)> {
        self.events.pop_front()
    }

    /// When the next report is due, counted from the start of the run.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.next_heard()
    }

    /// Closes a cell permanently. If a robot or a parcel is in the cell, nothing changes and the result is false.
    pub fn close_cell(&mut self, cell: Cell) -> bool {
        let in_use = self.is_in_use(cell);
        if !in_use {
            self.ground.close(cell);
            self.unkept = true;
        }
        !in_use
    }

    /// Puts temporary obstacles into these cells and removes all earlier ones. A cell with a robot or a parcel gets
    /// no obstacle. Returns whether every cell got its obstacle.
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

    /// Whether a robot has an order that needs both robots, and the other robot does not have it yet.
    #[must_use]
    pub fn awaits_the_other(&self) -> bool {
        self.robots.iter().any(|robot| robot.task.as_ref().is_some_and(|task| task.run.is_none()))
    }

    #[must_use]
    pub const fn is_busy(&self, which: Which) -> bool {
        self.robots[which.index()].task.is_some()
    }

    /// The pose of the robot after its last completed order. The second value says whether the robot is away from
    /// that pose.
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

    /// The parcel in the grippers. Its place is the one on which it stands or above which it is held.
    #[must_use]
    pub fn load(&self) -> Option<Parcel> {
        self.grip.as_ref().map(|grip| grip.parcel)
    }

    /// Where the middle of the parcel in the grippers really is: metres to the east and to the south of home. The
    /// third value is its height, 0–1.
    #[must_use]
    pub fn load_m(&self) -> Option<(f64, f64, f64)> {
        let grip = self.grip.as_ref()?;
        let cell_m = self.ground.hall().cell_m();
        let centre = |place: Place| {
            let BodyPose { x_m, y_m, .. } = body_of(BasePose { place, heading: Pose::START.heading }, cell_m);
            (x_m, y_m)
        };
        let (x, y) = centre(grip.parcel.place);
        // The parcel moves to the place where the leading base stood.
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

    /// The pieces on the floor that were put down or fell, each with its place.
    #[must_use]
    pub fn lying(&self) -> Vec<(Piece, Place)> {
        self.ground.lying().collect()
    }

    /// Every piece that was ever lifted, with the cell in which it lies now. `None` if it lies in no cell.
    #[must_use]
    pub fn moved(&self) -> BTreeMap<Piece, Option<Cell>> {
        self.ground.moved().map(|(piece, place)| (piece, place.and_then(Place::cell))).collect()
    }

    #[must_use]
    pub const fn holding(&self) -> &Holding {
        &self.holding
    }

    /// The mishaps that are still to come. Jams are never used up, since a jammed gripper stays jammed.
    #[must_use]
    pub fn mishaps_left(&self) -> Mishaps {
        let jams = self.settings.mishaps.jams.clone();
        Mishaps { slips: self.slips.clone(), unrecognised: self.unrecognised.clone(), jams }
    }

    /// The state to store. Returns `None` if nothing has changed since the last call.
    pub fn poll_memory(&mut self) -> Option<PairMemory> {
        std::mem::take(&mut self.unkept).then(|| self.memory())
    }

    /// Number of the current parcel, counted from 1.
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

    /// Parcels that lie on the floor after they fell or were released. They are reported again after a restart,
    /// because the killed program may have missed the first report.
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
