//! The leaves of the arms: align with the parcel, close, start the controllers, lift, lower and open. Each leaf is
//! done when both arms report the new state, so a restart in between makes no difference.

use super::{MOST_FAILURES, Performer, REPORTING, place_in};
use crate::arm::{ArmAction, ArmState, Gripper};
use crate::effect::Action;
use crate::pair::{RetrievalFault, Which};
use behaviour_trees::{Leaf, Status};

impl Performer<'_> {
    /// Makes both arms do this action until each reports that it is done.
    fn both(&mut self, action: ArmAction, is_done: impl Fn(&ArmState) -> bool) -> Status {
        let mut all_done = true;
        for which in Which::ALL {
            let base = self.base(which);
            if is_done(&base.arm) {
                continue;
            }
            all_done = false;
            if base.failures >= MOST_FAILURES {
                return self.fails(RetrievalFault::RobotFails);
            }
            if base.open.is_none() {
                self.propose(which, if base.off_centre { Action::Recentre } else { Action::Arm(action) });
            }
        }
        if all_done { Status::Success } else { Status::Running }
    }

    pub(super) fn set_end_effectors(&mut self, leaf: &Leaf<'_>) -> Status {
        if self.is_anybody_busy() {
            return Status::Running;
        }
        let Some(grip) = place_in(leaf, 0).and_then(|place| self.grip_place(place)) else {
            return self.fails(RetrievalFault::NotAligned);
        };
        self.both(ArmAction::AlignEndEffector(grip), |arm| arm.aligned == Some(grip))
    }

    /// Closes the grippers. If both are closed but do not hold the same parcel, a person must help. Before that, both
    /// robots get time to report what they hold.
    pub(super) fn close_grippers(&mut self, leaf: &Leaf<'_>) -> Status {
        let held = self.arms().iter().all(|arm| arm.holds.is_some());
        if held {
            return self.right_parcel();
        }
        let closed = self.arms().iter().all(|arm| arm.gripper == Gripper::Closed);
        if closed && !self.is_anybody_busy() && leaf.elapsed() > REPORTING {
            return self.fails(RetrievalFault::NotAligned);
        }
        match self.both(ArmAction::CloseGripper, |arm| arm.gripper == Gripper::Closed) {
            Status::Success => Status::Running,
            status @ (Status::Idle | Status::Running | Status::Failure | Status::Skipped) => status,
        }
    }

    fn right_parcel(&mut self) -> Status {
        let wanted = self.view.wanted;
        match self.load() {
            Some(parcel) if wanted.is_none_or(|wanted| wanted == parcel.piece) => Status::Success,
            Some(_) | None => self.fails(RetrievalFault::WrongParcel),
        }
    }

    /// Starts a controller. This takes no time. Fails if the grippers do not hold the parcel.
    pub(super) fn start_controller(&mut self, leaf: &Leaf<'_>) -> Status {
        let (action, is_at_work): (_, fn(&ArmState) -> bool) = match leaf.text(0) {
            Some("ForceControllerInit") => (ArmAction::HoldForce, |arm| arm.controllers.force),
            Some("AngleControllerInit") => (ArmAction::HoldAngle, |arm| arm.controllers.angle),
            Some("BasePosController-Init") => (ArmAction::HoldDistance, |arm| arm.controllers.distance),
            Some(_) | None => return self.fails(RetrievalFault::Tree),
        };
        if self.load().is_none() { Status::Failure } else { self.both(action, is_at_work) }
    }

    /// Lifts the parcel. Fails unless both grippers hold it.
    pub(super) fn lift(&mut self) -> Status {
        if self.load().is_none() {
            return Status::Failure;
        }
        match self.right_parcel() {
            Status::Success => self.both(ArmAction::Lift, |arm| arm.lifted),
            status @ (Status::Idle | Status::Running | Status::Failure | Status::Skipped) => status,
        }
    }

    /// Puts the parcel down at its destination and nowhere else.
    pub(super) fn drop(&mut self) -> Status {
        let Some(parcel) = self.load() else { return Status::Failure };
        if parcel.place != self.view.target {
            return self.fails(RetrievalFault::NotAligned);
        }
        let status = self.both(ArmAction::Lower, |arm| arm.on_floor);
        if status == Status::Success {
            self.output.dropped = Some(parcel);
        }
        status
    }

    pub(super) fn release(&mut self) -> Status {
        let status = self.both(ArmAction::Release, |arm| arm.gripper == Gripper::Open);
        self.output.released = status == Status::Success;
        status
    }
}
