//! The state that the pair and its floor would retain by physics when the program dies: where the bases stand and roll
//! to, what is in the grippers and how it is held, where parcels lie. The program that runs the pair stores the state.
//!
//! Quantities are whole numbers of small units, so that written values are read back exactly.

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

/// A robot halts by itself at most this long after the program has died (safety S5), in simulated time.
const WATCHDOG: Duration = Duration::from_millis(500);

/// A quarter turn in microradians, plus the largest rounding error.
const QUARTER_URAD: u64 = 1_570_797;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairMemory {
    /// SRM1 and SRM2.
    pub robots: [RobotMemory; 2],
    pub grip: Option<GripMemory>,
    pub lying: Vec<(Piece, Place)>,
    pub taken_in: Vec<Piece>,
    pub closed: Vec<Cell>,
    /// Slips still to come; `None` in a hall that was just opened.
    pub slips: Option<Vec<Slip>>,
    /// Parcels that the first look will not recognise; `None` in a hall that was just opened.
    pub unrecognised: Option<Vec<u32>>,
    /// Number of times that the pair continued after the end of a program; each time its noise begins anew.
    pub restarts: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotMemory {
    /// The pose in which the last completed order left the robot.
    pub stands: BasePose,
    pub astray: AstrayMemory,
    pub motion: Option<(AstrayMemory, Duration)>,
    pub gripper: Gripper,
    pub aligned: Option<Place>,
    /// The controllers at work, which go on by themselves.
    pub controllers: Controllers,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AstrayMemory {
    Not,
    /// On the way to a neighbouring place, in millionths of the way.
    Along(Place, i64),
    /// Turned away from the heading, in microradians clockwise.
    Turned(i64),
}

/// A parcel in the grippers. Each quantity consists of its error and the sum of the error over seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GripMemory {
    pub parcel: Parcel,
    /// How high it is lifted, in millionths.
    pub height: i64,
    /// Steps over which it was carried.
    pub steps: u32,
    /// Gripping force, in millionths of a newton.
    pub force: [i64; 2],
    /// Angle of the paddles, in microradians.
    pub angle: [i64; 2],
    /// Distance of the bases, in micrometres.
    pub gap: [i64; 2],
    /// Share by which the second base is faster, in millionths.
    pub faster: i64,
    /// The direction in which the paddles tilt, 1 or −1, in millionths.
    pub tilts: i64,
    /// Number of steps for which a quantity has been beyond its limit.
    pub beyond: u32,
}

impl PairMemory {
    /// Two robots that were just put down in a hall that was just opened.
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

    /// The state once the program that drove the pair has died and the bases have come to rest, after a random time of
    /// at most `WATCHDOG` that is drawn from the seed. Both bases roll for the same share of that time, because a
    /// parcel may couple them.
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

    /// Whether this state is possible in that hall: its pieces exist, and the robots stand on free floor or before the
    /// entrance.
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
    /// The pair of an earlier run, in the same hall, after the program has died: as it was, halted by itself within
    /// half a second, with its parcel in its grip. Its first reports are the poses of both robots, their arms, the
    /// pieces on the floor, and `LinkUp`. `now` is the time of the new run.
    #[must_use]
    pub fn remembering(hall: Arc<Hall>, settings: PairSettings, memory: PairMemory, now: Now) -> Pair {
        let memory = memory.at_rest(settings.seed);
        let mut pair = Pair::placed(hall, settings, memory, now.since_start);
        // Only a lifted parcel is off the floor; a parcel that is merely gripped still stands on the floor.
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
    /// The point at this share (0–1) of the way to `end`; a motion has constant speed.
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
