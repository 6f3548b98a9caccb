//! The outputs of the core: orders to robots, halts, records and answers. The caller that polls the effects carries
//! them out.

use std::time::Duration;

use crate::arm::ArmAction;
use crate::command::{Accepted, Move};
use crate::refused::Refused;
use crate::robot::{Part, RobotId};
use crate::state::fact::Entry;
use crate::units::{Epoch, OrderId, Pose, Seq, Ticket, WallTime};
use crate::world::luggage::Judgement;

#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// An order for a robot. A stop that raises the epoch above `order.epoch` cancels the order.
    Order(RobotId, Order),
    Halt(RobotId),
    Led(RobotId, bool),
    /// Store these entries durably, then report `Event::Recorded` with the last entry. If the page has answers that are
    /// kept back, report `Event::KeptBack` with their number, too.
    Record(Page),
    Answer(Ticket, Result<Accepted, Refused>),
}

/// One bounded action of a robot: at most one cell, one quarter turn, one photo or one movement of its arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    pub id: OrderId,
    pub action: Action,
    /// The epoch in which the order was given. After a later stop, the order must not begin.
    pub epoch: Epoch,
    /// Time after which the robot halts by itself.
    pub deadline: Duration,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Move(Move),
    /// Measure the position, then return to the cell centre and the heading of the last completed order.
    Recentre,
    Photograph(Stamp),
    /// One step towards home, from outside the entrance. The heading stays the same.
    Enter,
    /// One step away from home. The heading stays the same.
    Leave,
    Arm(ArmAction),
}

impl Action {
    #[must_use]
    pub const fn is_motion(self) -> bool {
        match self {
            Action::Move(_) | Action::Recentre | Action::Enter | Action::Leave => true,
            Action::Photograph(_) => false,
            Action::Arm(action) => action.is_motion(),
        }
    }

    #[must_use]
    pub const fn moves_base(self) -> bool {
        matches!(self, Action::Move(_) | Action::Recentre | Action::Enter | Action::Leave)
    }

    #[must_use]
    pub const fn part(self) -> Part {
        match self {
            Action::Move(_) | Action::Recentre | Action::Enter | Action::Leave | Action::Arm(ArmAction::HoldDistance) => {
                Part::Base
            }
            Action::Photograph(_) | Action::Arm(ArmAction::FindParcel(_)) => Part::Camera,
            Action::Arm(ArmAction::AlignEndEffector(_) | ArmAction::HoldAngle | ArmAction::Lift | ArmAction::Lower) => Part::Arm,
            Action::Arm(ArmAction::CloseGripper | ArmAction::HoldForce | ArmAction::Release) => Part::Gripper,
        }
    }
}

/// The place and time that are printed on a photo, so that the picture alone shows them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// The robot's pose, in cells of the map.
    pub pose: Pose,
    pub wall: WallTime,
}

/// All entries that one input (a command, a report or a timeout) causes. They are stored together or not at all, so
/// the journal never ends in the middle of an input.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// The number of the first entry. The other entries follow without a gap.
    pub first: Seq,
    /// The entries. Only a page with answers that are kept back may have none.
    pub entries: Vec<Entry>,
    /// All answers of judges that are kept back from now on, if they have changed. They are stored apart from the
    /// entries, after them.
    pub kept_back: Option<KeptBack>,
}

/// The answers of judges that nobody else may see yet.
#[derive(Clone, Debug, PartialEq)]
pub struct KeptBack {
    /// Number of this list. Each later list has a higher number.
    pub number: u64,
    pub answers: Vec<Judgement>,
}

impl Page {
    #[must_use]
    pub fn last(&self) -> Seq {
        Seq((self.first.0 + self.entries.len() as u64).saturating_sub(1))
    }
}
