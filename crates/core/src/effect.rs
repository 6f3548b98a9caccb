//! The core's requests to the world outside: orders to robots, halts, records, answers. Whoever polls the effects
//! performs them.

use std::sync::Arc;
use std::time::Duration;

use crate::arm::ArmAction;
use crate::asked::Asked;
use crate::command::{Accepted, CommandId, Issuer, Move, Note, Strategy, Verdict};
use crate::event::Photo;
use crate::hold::Hold;
use crate::refused::Refused;
use crate::robot::{Part, RobotId};
use crate::search::{Goal, Search};
use crate::state::{Conditions, PersistentState, Phase, Retrieval};
use crate::units::{AlarmId, Cell, Celsius, Epoch, Heading, LuggageId, MissionId, OrderId, Piece, Pose, Seq, Ticket, WallTime};
use crate::world::alarm::AlarmCause;
use crate::world::hall_map::Mark;
use crate::world::luggage::Luggage;

#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// A halt raised after `order.epoch` makes the order void.
    Order(RobotId, Order),
    Halt(RobotId),
    Led(RobotId, bool),
    /// Store these entries for good, then report `Event::Recorded` with the last of them.
    Record(Page),
    Answer(Ticket, Result<Accepted, Refused>),
}

/// One bounded action of a robot: at most one cell, one quarter turn, one photo or one movement of its arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    pub id: OrderId,
    pub action: Action,
    /// The epoch in which the order was given; the order must not begin after a later stop.
    pub epoch: Epoch,
    /// Time after which the robot halts by itself.
    pub deadline: Duration,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Move(Move),
    /// Sense, then return to the cell centre and the heading in which the last completed order left the robot.
    Recentre,
    Photograph(Stamp),
    /// One step from outside the entrance towards home. The heading stays.
    Enter,
    /// One step away from home. The heading stays.
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

/// Printed on a photo, so that the picture alone says where and when it was taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Where the robot stands, in the map's own cells.
    pub pose: Pose,
    pub wall: WallTime,
}

/// The entries of one input, stored together or not at all, so that the journal never ends halfway through an input.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// The place of the first entry; the others follow without a gap.
    pub first: Seq,
    /// The entries, at least one.
    pub entries: Vec<Entry>,
}

impl Page {
    #[must_use]
    pub fn last(&self) -> Seq {
        Seq((self.first.0 + self.entries.len() as u64).saturating_sub(1))
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub wall: WallTime,
    pub fact: Fact,
}

/// `crate::state` folds facts into the state.
#[derive(Clone, Debug, PartialEq)]
pub enum Fact {
    /// With the version of the program.
    ProgramStarted(String),
    /// With the signal that ended the program, such as `SIGTERM`.
    ProgramEnded(String),
    /// The machine's wall clock was set by this many milliseconds (back, if negative), or the machine slept. Earlier
    /// entries have times of the earlier clock.
    ClockSet(i64),
    /// Valid for all entries that follow.
    Conditions(Conditions),
    /// The whole state, so that a start need not read earlier entries.
    State(Box<PersistentState>),
    /// Refused commands go on record too (safety A6).
    Command {
        issuer: Issuer,
        id: Option<CommandId>,
        asked: Asked,
        /// The epoch that the sender named; the epoch of the command's arrival is not on record.
        epoch: Option<Epoch>,
        luggage: Option<LuggageId>,
        refused: Option<Refused>,
    },
    MissionBegan(MissionId, Strategy),
    /// With the bombs that were left in the hall.
    MissionArchived(MissionId, Vec<LuggageId>),
    Phase(Phase),
    Holds(Vec<Hold>),
    Epoch(Epoch),
    Goal(Option<Goal>, Search),
    Pose(Pose),
    RobotPose(RobotId, Pose),
    /// Number of steps from home at which a robot now stands outside the entrance; 0: the robot is in the hall.
    Outside(RobotId, u8),
    /// `None` once the retrieval has ended.
    Retrieval(Option<Box<Retrieval>>),
    MetAgain(Cell, Piece),
    Secured(LuggageId),
    Led(bool),
    /// The cell, and what the obstacle was taken for: `wall`, `luggage` or `unknown`.
    Obstacle(Cell, &'static str),
    Mark(Cell, Mark),
    Luggage {
        /// The record without its verdict, which is a fact of its own.
        record: Arc<Luggage>,
        /// The new photo. `None` if there is none, or if the entry was read back: pictures are stored separately.
        photo: Option<Photo>,
    },
    Verdict {
        luggage: LuggageId,
        verdict: Verdict,
        who: Arc<str>,
        note: Option<Note>,
    },
    Temperature(Arc<str>, Celsius),
    /// The last reading of this source no longer counts as known.
    ThermometerSilent(Arc<str>),
    AlarmRaised(AlarmId, Option<LuggageId>, AlarmCause),
    AlarmAcknowledged(AlarmId, Arc<str>),
    Strategy(Strategy),
    /// With the heading of the robot, which stands at home.
    MapEmptied(Heading),
    WrittenOut(WrittenOut),
    /// All entries before this one were unpacked from an archive.
    Unpacked(Unpacked),
}

/// The part of the journal that was moved into an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenOut {
    /// The first and the last mission in the archive.
    pub missions: (MissionId, MissionId),
    /// Entries up to here are in the archive only.
    pub until: Seq,
    pub file: String,
    /// The SHA-256 of the file, in 64 lower-case hexadecimal digits.
    pub digest: String,
}

/// The archive from which a journal was unpacked, and where the journal begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unpacked {
    pub file: String,
    /// The SHA-256 of the file, in 64 lower-case hexadecimal digits.
    pub digest: String,
    /// The last entry that is not in the journal; 0 if none is missing.
    pub behind: Seq,
    /// The digest of the page with that entry, in 64 lower-case hexadecimal digits.
    pub page: String,
}
