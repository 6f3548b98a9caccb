//! One of the two simulated robots alone: where its base stands, what it does, the state of its arm. The work that
//! both robots do together is in the other files of this folder.

use std::f64::consts::FRAC_PI_2;
use std::time::Duration;

use super::super::drive::{BodyPose, normal};
use hallsweep_core::arm::{ArmAction, Controllers, Gripper};
use hallsweep_core::event::Obstacle;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::units::{Cell, OrderId, Pose};

#[derive(Clone, Debug)]
pub(super) struct Robot {
    /// The pose of the robot after its last completed order.
    pub(super) stands: BasePose,
    /// How far the robot really is from `stands` while it does not move.
    pub(super) astray: Astray,
    pub(super) task: Option<PairTask>,
    pub(super) gripper: Gripper,
    pub(super) aligned: Option<Place>,
    pub(super) controllers: Controllers,
}

/// How far a base is from the pose where it should be. It is either on the way to a neighbouring place or between two
/// headings, never both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Astray {
    Not,
    /// This share (0–1) of the way to a neighbouring place.
    Along(Place, f64),
    /// The robot has turned away from its heading by this angle, in radians clockwise.
    Turned(f64),
}

#[derive(Clone, Debug)]
pub(super) struct PairTask {
    pub(super) order: OrderId,
    pub(super) deadline: Duration,
    pub(super) work: Work,
    /// When the work runs. `None` while the robot waits for the other robot's order for the same work.
    pub(super) run: Option<WorkTime>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WorkTime {
    pub(super) began: Duration,
    pub(super) ends: Duration,
    /// Whether both robots do this work together.
    pub(super) together: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Work {
    /// A step to a neighbouring place. If an obstacle is in the way, only the share `until` of the step.
    Step {
        to: Place,
        until: f64,
        against: Option<Obstacle>,
    },
    /// The way back to `Robot::stands`.
    Back,
    Turn {
        clockwise: bool,
    },
    Arm(ArmAction),
}

impl WorkTime {
    /// How much of the work is done at `now`, 0–1.
    pub(super) fn done(self, now: Duration) -> f64 {
        let (passed, whole) = (now.saturating_sub(self.began), self.ends.saturating_sub(self.began));
        if passed >= whole { 1.0 } else { passed.as_secs_f64() / whole.as_secs_f64() }
    }
}

impl Work {
    /// Whether the robot or its arm moves. A look is not a motion, and switching a controller on is not one either.
    pub(super) fn is_motion(self) -> bool {
        match self {
            Work::Step { .. } | Work::Back | Work::Turn { .. } => true,
            Work::Arm(action) => action.is_motion(),
        }
    }
}

impl Robot {
    pub(super) const fn new(stands: BasePose) -> Robot {
        let controllers = Controllers { force: false, angle: false, distance: false };
        Robot { stands, astray: Astray::Not, task: None, gripper: Gripper::Open, aligned: None, controllers }
    }

    pub(super) fn is_off_centre(&self) -> bool {
        self.astray != Astray::Not
    }

    /// How far the robot is from `stands` at `now`, if nothing interrupts its work.
    pub(super) fn astray_at(&self, now: Duration) -> Astray {
        let Some(PairTask { work, run: Some(run), .. }) = &self.task else { return self.astray };
        let done = run.done(now);
        match *work {
            Work::Step { to, until, .. } => Astray::Along(to, until * done).settled(),
            Work::Turn { clockwise } => Astray::Turned(if clockwise { FRAC_PI_2 } else { -FRAC_PI_2 } * done).settled(),
            Work::Back => self.astray.times(1.0 - done),
            Work::Arm(_) => self.astray,
        }
    }

    /// Whether the robot is in a place, partly in it, or on its way into it.
    pub(super) fn is_in_or_enters(&self, place: Place, now: Duration) -> bool {
        let enters = matches!(&self.task, Some(PairTask { work: Work::Step { to, .. }, .. }) if *to == place);
        self.stands.place == place || enters || matches!(self.astray_at(now), Astray::Along(to, _) if to == place)
    }

    /// Where the robot's body is at `now`, in metres.
    pub(super) fn body_at(&self, now: Duration, cell_m: f64) -> BodyPose {
        let centre = body_of(self.stands, cell_m);
        match self.astray_at(now) {
            Astray::Not => centre,
            Astray::Turned(angle) => BodyPose { theta: normal(centre.theta + angle), ..centre },
            Astray::Along(to, share) => {
                let end = body_of(BasePose { place: to, ..self.stands }, cell_m);
                let between = |from: f64, to: f64| from + (to - from) * share;
                BodyPose { x_m: between(centre.x_m, end.x_m), y_m: between(centre.y_m, end.y_m), ..centre }
            }
        }
    }

    /// Ends the work without a report, and leaves the body where it is now. Returns the order, if there was one.
    pub(super) fn stop(&mut self, now: Duration) -> Option<OrderId> {
        self.astray = self.astray_at(now);
        self.task.take().map(|task| task.order)
    }
}

impl Astray {
    fn times(self, share: f64) -> Astray {
        match self {
            Astray::Not => Astray::Not,
            Astray::Along(to, way) => Astray::Along(to, way * share).settled(),
            Astray::Turned(angle) => Astray::Turned(angle * share).settled(),
        }
    }

    /// Returns `Not` if the distance or the angle is zero.
    pub(super) fn settled(self) -> Astray {
        match self {
            Astray::Along(_, 0.0) | Astray::Turned(0.0) | Astray::Not => Astray::Not,
            Astray::Along(..) | Astray::Turned(_) => self,
        }
    }
}

/// Where the body is when it stands exactly at its place. The way out is drawn to the north of home, where the halls
/// of the original specification have nothing.
pub(super) fn body_of(stands: BasePose, cell_m: f64) -> BodyPose {
    let cell = match stands.place {
        Place::Cell(cell) => cell,
        Place::Outside(steps) => Cell::new(Cell::HOME.x, Cell::HOME.y - i32::from(steps)),
    };
    BodyPose::centred(Pose { cell, heading: stands.heading }, cell_m)
}
