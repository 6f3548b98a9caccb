//! The state that remains after the program has died, as with a real pair and floor: places and motions of the bases,
//! the parcel in the grippers and how it is held, the places of other parcels. The program that runs the pair stores
//! this state.
//!
//! Quantities are whole numbers of small units. So values are the same after writing and reading.

use std::sync::Arc;
use std::time::Duration;

use super::super::hall::{Hall, Truth};
use super::super::memory::{micro, reseeded, whole};
use super::grip::{Grip, Held};
use super::robot::{Astray, PairTask, Robot, Work, WorkTime};
use super::settings::{PairSettings, Slip};
use super::{Pair, PairGround};
use hallsweep_core::arm::{Controllers, Gripper, Parcel};
use hallsweep_core::pair::Which;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::{Cell, Now, Piece};

/// Longest time from the death of the program to a robot's own halt, in simulated time (safety S5).
const WATCHDOG: Duration = Duration::from_millis(500);

/// A quarter turn plus the largest rounding error, in microradians.
const QUARTER_URAD: u64 = 1_570_797;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairMemory {
    /// The memories of SRM1 and SRM2, the two robots of the pair.
    pub robots: [RobotMemory; 2],
    pub grip: Option<GripMemory>,
    pub lying: Vec<(Piece, Place)>,
    pub taken_in: Vec<Piece>,
    pub closed: Vec<Cell>,
    /// Slips that are still to come. `None` in a new hall.
    pub slips: Option<Vec<Slip>>,
    /// Numbers of the parcels that the first look will not recognise. `None` in a new hall.
    pub unrecognised: Option<Vec<u32>>,
    /// Number of times that the pair continued after the program had ended. After each restart, new random numbers
    /// are used.
    pub restarts: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotMemory {
    /// The pose of the robot after its last completed order.
    pub stands: BasePose,
    pub astray: AstrayMemory,
    pub motion: Option<(AstrayMemory, Duration)>,
    pub gripper: Gripper,
    pub aligned: Option<Place>,
    /// The controllers that are switched on. They work without further orders.
    pub controllers: Controllers,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AstrayMemory {
    Not,
    /// Part of the way to a neighbouring place, in millionths of the way.
    Along(Place, i64),
    /// Angle away from the heading, in microradians clockwise.
    Turned(i64),
}

/// A parcel in the grippers. For `force`, `angle` and `gap`, the first number is the error. The second is the sum of
/// the error over seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GripMemory {
    pub parcel: Parcel,
    /// How high the parcel is lifted, in millionths of the full height.
    pub height: i64,
    /// Number of steps (from place to place) over which the parcel was carried.
    pub steps: u32,
    /// Error of the gripping force, in millionths of a newton.
    pub force: [i64; 2],
    /// Error of the angle of the paddles, in microradians.
    pub angle: [i64; 2],
    /// Error of the distance between the bases, in micrometres.
    pub gap: [i64; 2],
    /// How much faster the second base drives, in millionths of its speed.
    pub faster: i64,
    /// The direction in which the paddles tilt: 1,000,000 or −1,000,000.
    pub tilts: i64,
    /// Number of time steps in a row with a quantity beyond its limit.
    pub beyond: u32,
}

impl PairMemory {
    /// The memory of two new robots at these places, in a new hall.
    #[must_use]
    pub fn new(stands: [BasePose; 2]) -> PairMemory {
        let robot = |stands| RobotMemory {
            stands,
            astray: AstrayMemory::Not,
            motion: None,
            gripper: Gripper::Open,
            aligned: None,
            controllers: Controllers::default(),
        };
        PairMemory {
            robots: stands.map(robot),
            grip: None,
            lying: Vec::new(),
            taken_in: Vec::new(),
            closed: Vec::new(),
            slips: None,
            unrecognised: None,
            restarts: 0,
        }
    }

    /// The state after the program has died and the bases have stopped. The time until they stop is drawn from the
    /// seed and is at most `WATCHDOG`. One share is drawn, and both bases stop after this share of their time,
    /// because a parcel may couple them.
    #[must_use]
    pub fn at_rest(mut self, seed: u64) -> PairMemory {
        self.restarts = self.restarts.wrapping_add(1);
        let share = RandomStream::new(reseeded(seed, self.restarts), "watchdog").fraction();
        for robot in &mut self.robots {
            if let Some((to, left)) = robot.motion.take() {
                let rolls = left.min(WATCHDOG).mul_f64(share).as_secs_f64();
                let share = if left.is_zero() { 1.0 } else { rolls / left.as_secs_f64() };
                robot.astray = robot.astray.towards(to, share);
            }
        }
        self
    }

    /// Whether this state is possible in the given hall. Its pieces must exist. The robots must stand on free floor
    /// or outside before the entrance.
    #[must_use]
    pub fn fits(&self, hall: &Hall) -> bool {
        let is_there = |piece: Piece| hall.pieces().iter().any(|bag| bag.piece == piece);
        let held = self.grip.iter().map(|grip| grip.parcel.piece);
        let pieces = self.lying.iter().map(|(piece, _)| *piece).chain(self.taken_in.iter().copied()).chain(held);
        let lying = self.lying.iter().map(|(piece, place)| (*piece, place.cell()));
        let gone = self.taken_in.iter().copied().chain(self.grip.filter(|grip| grip.height > 0).map(|grip| grip.parcel.piece));
        let now = hall.rearranged(&lying.chain(gone.map(|piece| (piece, None))).collect());
        let stands = |robot: &RobotMemory| match robot.stands.place {
            Place::Cell(cell) => now.truth(cell) == Truth::Free && !self.closed.contains(&cell),
            Place::Outside(steps) => (1..=Place::FURTHEST).contains(&steps),
        };
        let near = |robot: &RobotMemory, astray: AstrayMemory| match astray {
            AstrayMemory::Along(to, way) => to.is_beside(robot.stands.place) && (0..=1_000_000).contains(&way),
            AstrayMemory::Turned(angle) => angle.unsigned_abs() <= QUARTER_URAD,
            AstrayMemory::Not => true,
        };
        let moves =
            |robot: &RobotMemory| near(robot, robot.astray) && robot.motion.as_ref().is_none_or(|(to, _)| near(robot, *to));
        pieces.into_iter().all(is_there) && self.robots.iter().all(|robot| stands(robot) && moves(robot))
    }

    pub(super) fn robots(&self) -> [Robot; 2] {
        self.robots.map(|kept| Robot {
            astray: kept.astray.into(),
            gripper: kept.gripper,
            aligned: kept.aligned,
            controllers: kept.controllers,
            ..Robot::new(kept.stands)
        })
    }

    pub(super) fn grip(&self) -> Option<Grip> {
        let held = |[error, sum]: [i64; 2]| Held { error: whole(error), sum: whole(sum) };
        self.grip.map(|kept| Grip {
            parcel: kept.parcel,
            height: whole(kept.height),
            steps: kept.steps,
            force: held(kept.force),
            angle: held(kept.angle),
            gap: held(kept.gap),
            faster: whole(kept.faster),
            tilts: whole(kept.tilts),
            beyond: kept.beyond,
        })
    }
}

impl Pair {
    /// Makes the pair of an earlier run again, in the same hall, after the program has died. The robots have halted
    /// by themselves within half a second, and a held parcel is still held. The first reports are the poses of both
    /// robots, their arms, the pieces on the floor, and `LinkUp`. `now` is the time of the new run.
    #[must_use]
    pub fn remembering(hall: Arc<Hall>, settings: PairSettings, memory: PairMemory, now: Now) -> Pair {
        let memory = memory.at_rest(settings.seed);
        let mut pair = Pair::placed(hall, settings, memory, now.since_start);
        // A parcel that is gripped but not lifted still stands on the floor.
        if let Some(grip) = &pair.grip
            && grip.is_loaded()
        {
            pair.ground.lift(grip.parcel.piece);
        }
        pair
    }

    /// The state that the pair would retain if the program died now.
    #[must_use]
    pub fn memory(&self) -> PairMemory {
        PairMemory {
            robots: Which::ALL.map(|which| self.robot_memory(which)),
            grip: self.grip.as_ref().map(kept),
            lying: self.ground.lying().collect(),
            taken_in: PairGround::taken_in(&self.ground).to_vec(),
            closed: self.ground.closed().collect(),
            slips: Some(self.slips.clone()),
            unrecognised: Some(self.unrecognised.clone()),
            restarts: self.restarts,
        }
    }

    fn robot_memory(&self, which: Which) -> RobotMemory {
        let robot = &self.robots[which.index()];
        let motion = match &robot.task {
            Some(PairTask {
                work: Work::Step { .. } | Work::Back | Work::Turn { .. }, run: Some(WorkTime { ends, .. }), ..
            }) => Some((robot.astray_at(*ends).into(), ends.saturating_sub(self.now))),
            Some(_) | None => None,
        };
        RobotMemory {
            stands: robot.stands,
            astray: robot.astray_at(self.now).into(),
            motion,
            gripper: robot.gripper,
            aligned: robot.aligned,
            controllers: robot.controllers,
        }
    }
}

fn kept(grip: &Grip) -> GripMemory {
    let held = |held: Held| [micro(held.error), micro(held.sum)];
    GripMemory {
        parcel: grip.parcel,
        height: micro(grip.height),
        steps: grip.steps,
        force: held(grip.force),
        angle: held(grip.angle),
        gap: held(grip.gap),
        faster: micro(grip.faster),
        tilts: micro(grip.tilts),
        beyond: grip.beyond,
    }
}

impl AstrayMemory {
    /// The point that is reached on the way to `end` after this share (0–1) of the motion's time. The speed is
    /// constant.
    #[expect(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "both ends are within a step and a turn")]
    fn towards(self, end: AstrayMemory, share: f64) -> AstrayMemory {
        let between = |from: i64, to: i64| from + (to.saturating_sub(from) as f64 * share) as i64;
        match (self, end) {
            (AstrayMemory::Along(_, from), AstrayMemory::Along(to, until)) => AstrayMemory::Along(to, between(from, until)),
            (AstrayMemory::Not, AstrayMemory::Along(to, until)) => AstrayMemory::Along(to, between(0, until)),
            (AstrayMemory::Along(to, from), AstrayMemory::Not | AstrayMemory::Turned(_)) => {
                AstrayMemory::Along(to, between(from, 0))
            }
            (AstrayMemory::Turned(from), AstrayMemory::Turned(until)) => AstrayMemory::Turned(between(from, until)),
            (AstrayMemory::Turned(from), AstrayMemory::Not | AstrayMemory::Along(..)) => AstrayMemory::Turned(between(from, 0)),
            (AstrayMemory::Not, AstrayMemory::Turned(until)) => AstrayMemory::Turned(between(0, until)),
            (AstrayMemory::Not, AstrayMemory::Not) => AstrayMemory::Not,
        }
    }
}

impl From<Astray> for AstrayMemory {
    fn from(astray: Astray) -> AstrayMemory {
        match astray {
            Astray::Not => AstrayMemory::Not,
            Astray::Along(to, share) => AstrayMemory::Along(to, micro(share)),
            Astray::Turned(angle) => AstrayMemory::Turned(micro(angle)),
        }
    }
}

impl From<AstrayMemory> for Astray {
    fn from(kept: AstrayMemory) -> Astray {
        match kept {
            AstrayMemory::Not => Astray::Not,
            AstrayMemory::Along(to, millionths) => Astray::Along(to, whole(millionths)).settled(),
            AstrayMemory::Turned(microradians) => Astray::Turned(whole(microradians)).settled(),
        }
    }
}
