//! How the pair accepts an order: whether it is possible, whether it needs both robots, and how long it takes. The
//! outcome of orders is handled in `passing`.

use std::f64::consts::FRAC_PI_2;
use std::time::Duration;

use super::super::hall::Truth;
use super::super::sonar::way_to_contact;
use super::robot::{Astray, PairTask, Work, WorkTime};
use super::{Pair, RobotEvent};
use hallsweep_core::arm::{ArmAction, Gripper};
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order};
use hallsweep_core::event::Obstacle;
use hallsweep_core::pair::Which;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::units::Cell;

type Words = &'static str;

impl Pair {
    pub(super) fn work_of(&self, which: Which, action: Action) -> Result<Work, Words> {
        let stands = self.robots[which.index()].stands;
        match action {
            Action::Recentre => Ok(Work::Back),
            Action::Photograph(_) => Err("it takes no photos"),
            Action::Move(Move::NudgeLeft | Move::NudgeRight) => Err("it has no small corrective turns"),
            Action::Move(Move::TurnLeft) => self.may_drive(which).map(|()| Work::Turn { clockwise: false }),
            Action::Move(Move::TurnRight) => self.may_drive(which).map(|()| Work::Turn { clockwise: true }),
            Action::Move(step @ (Move::Forward | Move::Backward)) => {
                self.may_drive(which)?;
                let Place::Cell(cell) = stands.place else { return Err("it is before the entrance: it can only go in or out") };
                let heading = if step == Move::Forward { stands.heading } else { stands.heading.opposite() };
                Ok(step_to(Place::Cell(cell.ahead(heading))))
            }
            Action::Enter | Action::Leave => {
                self.may_drive(which)?;
                self.way_out(stands.place, action == Action::Enter).map(step_to)
            }
            Action::Arm(action) => self.arm_work(which, action).map(|()| Work::Arm(action)),
        }
    }

    fn may_drive(&self, which: Which) -> Result<(), Words> {
        if self.robots[which.index()].is_off_centre() {
            return Err("it stands away from the centre of its place: recentre first");
        }
        match &self.grip {
            Some(grip) if grip.height < 1.0 => Err("it holds a parcel that is not lifted: lift it, or put it down and let go"),
            Some(_) | None => Ok(()),
        }
    }

    fn way_out(&self, from: Place, inwards: bool) -> Result<Place, Words> {
        match (from, inwards) {
            _ if !self.settings.way_out => Err("there is no way out here"),
            (Place::Outside(1), true) => Ok(Place::Cell(Cell::HOME)),
            (Place::Outside(steps), true) => Ok(Place::Outside(steps.saturating_sub(1).max(1))),
            (Place::Cell(_), true) => Err("it is in the hall already"),
            (Place::Cell(Cell::HOME), false) => Ok(Place::Outside(1)),
            (Place::Cell(_), false) => Err("it is not at home, where the way out begins"),
            (Place::Outside(steps), false) if steps < Place::FURTHEST => Ok(Place::Outside(steps + 1)),
            (Place::Outside(_), false) => Err("it is at the end of the way out"),
        }
    }

    fn arm_work(&self, which: Which, action: ArmAction) -> Result<(), Words> {
        let (robot, grip) = (&self.robots[which.index()], self.grip.as_ref());
        let height = grip.map_or(0.0, |grip| grip.height);
        match action {
            ArmAction::FindParcel(_) => Ok(()),
            _ if robot.is_off_centre() && action.is_motion() => {
                Err("its base stands away from the centre of its place: recentre first")
            }
            ArmAction::AlignEndEffector(_) if robot.gripper == Gripper::Closed => Err("its gripper is closed: let go first"),
            ArmAction::AlignEndEffector(place) if !place.is_beside(robot.stands.place) => Err("the parcel is out of its reach"),
            ArmAction::AlignEndEffector(place) if self.ground.piece_at(place).is_none() => Err("there is no parcel"),
            ArmAction::CloseGripper if robot.aligned.is_none() => Err("its gripper is not at a parcel: align the gripper first"),
            ArmAction::HoldForce | ArmAction::HoldAngle | ArmAction::HoldDistance | ArmAction::Lift | ArmAction::Lower
                if grip.is_none() =>
            {
                Err("the two robots hold no parcel")
            }
            ArmAction::Release if height > 0.0 => Err("the parcel is off the floor: put it down first"),
            ArmAction::AlignEndEffector(_)
            | ArmAction::CloseGripper
            | ArmAction::HoldForce
            | ArmAction::HoldAngle
            | ArmAction::HoldDistance
            | ArmAction::Lift
            | ArmAction::Lower
            | ArmAction::Release => Ok(()),
        }
    }

    /// Accepts an order that is possible. An order for one robot begins at once. An order for both begins when the
    /// other robot has it too.
    pub(super) fn take(&mut self, which: Which, order: Order, work: Work) {
        let deadline = self.now.saturating_add(order.deadline);
        let needs_both = self.needs_both(which, work);
        self.unkept = true;
        self.robots[which.index()].task = Some(PairTask { order: order.id, deadline, work, run: None });
        if needs_both {
            self.begin_together();
        } else {
            self.begin_alone(which, work);
        }
    }

    /// Whether this work needs both robots. A held parcel couples them: neither can drive or lift alone. But each can
    /// turn alone, because the arm can rotate on its base.
    fn needs_both(&self, which: Which, work: Work) -> bool {
        let is_along = matches!(self.robots[which.index()].astray, Astray::Along(..));
        match work {
            Work::Arm(ArmAction::Lift | ArmAction::Lower) => true,
            Work::Step { .. } => self.grip.is_some(),
            Work::Back => self.grip.is_some() && is_along,
            Work::Turn { .. } | Work::Arm(_) => false,
        }
    }

    fn begin_alone(&mut self, which: Which, work: Work) {
        let (work, lasts) = match work {
            Work::Step { to, .. } => {
                let (until, against) = self.contact(which, to);
                (Work::Step { to, until, against }, self.settings.step.mul_f64(until))
            }
            Work::Back => (work, self.way_back(which, self.settings.step)),
            Work::Turn { .. } => (work, self.settings.turn),
            Work::Arm(action) => (work, self.arm_takes(action)),
        };
        self.run(which, work, lasts, false);
    }

    fn run(&mut self, which: Which, work: Work, lasts: Duration, together: bool) {
        let (began, ends) = (self.now, self.now.saturating_add(lasts));
        if let Some(task) = &mut self.robots[which.index()].task {
            (task.work, task.run) = (work, Some(WorkTime { began, ends, together }));
        }
    }

    /// Begins work that needs both robots, if both have an order for it.
    fn begin_together(&mut self) {
        let waiting =
            |which: Which| self.robots[which.index()].task.as_ref().filter(|task| task.run.is_none()).map(|task| task.work);
        let (Some(one), Some(two)) = (waiting(Which::Srm1), waiting(Which::Srm2)) else { return };
        let height = self.grip.as_ref().map_or(0.0, |grip| grip.height);
        let begun = match (one, two) {
            (Work::Step { to: one, .. }, Work::Step { to: two, .. }) => self.train_step([one, two]),
            (Work::Back, Work::Back) => {
                let lasts = Which::ALL.map(|which| self.way_back(which, self.settings.loaded_step));
                Some(([one, two], lasts[0].max(lasts[1])))
            }
            (Work::Arm(ArmAction::Lift), Work::Arm(ArmAction::Lift)) => {
                Some(([one, two], self.settings.arm.mul_f64(1.0 - height)))
            }
            (Work::Arm(ArmAction::Lower), Work::Arm(ArmAction::Lower)) => Some(([one, two], self.settings.arm.mul_f64(height))),
            (Work::Step { .. } | Work::Back | Work::Turn { .. } | Work::Arm(_), _) => None,
        };
        let Some((works, lasts)) = begun else {
            return self.refuse_both("the two robots got different orders for one parcel");
        };
        if self.next_step <= self.now {
            self.next_step = self.now + super::grip::STEP;
        }
        for which in Which::ALL {
            self.run(which, works[which.index()], lasts, true);
        }
    }

    /// A step of both robots with a parcel between them. One base leads. The parcel moves to the leader's old place.
    /// The other base moves to the parcel's old place.
    fn train_step(&self, to: [Place; 2]) -> Option<([Work; 2], Duration)> {
        let grip = self.grip.as_ref()?;
        let parcel = grip.parcel.place;
        let leads = |which: Which| {
            let leader = to[which.index()];
            let others = [parcel, self.robots[0].stands.place, self.robots[1].stands.place];
            to[which.other().index()] == parcel && (!others.contains(&leader) || leader.cell().is_none())
        };
        let leader = Which::ALL.into_iter().find(|which| leads(*which))?;
        let (until, against) = self.contact(leader, to[leader.index()]);
        let work = |which: Which| Work::Step { to: to[which.index()], until, against: against.filter(|_| which == leader) };
        Some((Which::ALL.map(work), self.settings.loaded_step.mul_f64(until)))
    }

    /// How much of the way to a neighbouring place a base can drive (0–1), and the obstacle that stops it, if any.
    fn contact(&self, which: Which, to: Place) -> (f64, Option<Obstacle>) {
        let Place::Cell(cell) = to else { return (1.0, None) };
        let partner = self.robots[which.other().index()].is_in_or_enters(to, self.now) && self.grip.is_none();
        let truth = if partner { Truth::Luggage(hallsweep_core::units::Piece(0)) } else { self.ground.truth(cell) };
        let Some(way) = way_to_contact(truth) else { return (1.0, None) };
        let stands = self.robots[which.index()].stands;
        let is_ahead = stands.place.cell().is_some_and(|here| here.ahead(stands.heading) == cell);
        let seen = match truth {
            Truth::Wall => Obstacle::Wall { left: 0, right: 0 },
            Truth::Luggage(piece) if !partner => Obstacle::Luggage(piece),
            Truth::Luggage(_) | Truth::Free => Obstacle::Unknown,
        };
        (way, Some(if is_ahead { seen } else { Obstacle::Unknown }))
    }

    /// How long a robot needs for the way back to `Robot::stands`. The time is proportional to the distance or angle.
    fn way_back(&self, which: Which, step: Duration) -> Duration {
        match self.robots[which.index()].astray {
            Astray::Not => Duration::ZERO,
            Astray::Along(_, share) => step.mul_f64(share.abs()),
            Astray::Turned(angle) => self.settings.turn.mul_f64(angle.abs() / FRAC_PI_2),
        }
    }

    const fn arm_takes(&self, action: ArmAction) -> Duration {
        match action {
            ArmAction::FindParcel(_) => self.settings.look,
            ArmAction::HoldForce | ArmAction::HoldAngle | ArmAction::HoldDistance => Duration::ZERO,
            ArmAction::AlignEndEffector(_)
            | ArmAction::CloseGripper
            | ArmAction::Lift
            | ArmAction::Lower
            | ArmAction::Release => self.settings.arm,
        }
    }

    fn refuse_both(&mut self, words: Words) {
        for which in Which::ALL {
            if let Some(task) = self.robots[which.index()].task.take() {
                self.events.push_back((which, RobotEvent::Failed(task.order, words.to_owned())));
            }
        }
    }
}

const fn step_to(to: Place) -> Work {
    Work::Step { to, until: 1.0, against: None }
}

pub(super) const fn moved(stands: BasePose, to: Place) -> BasePose {
    BasePose { place: to, heading: stands.heading }
}
