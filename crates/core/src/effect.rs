//! What the core asks of the world outside: orders to robots, halts, records, answers.
//! It only asks; whoever polls the effects performs them.

use std::sync::Arc;
use std::time::Duration;

use crate::arm::ArmAction;
use crate::asked::Asked;
use crate::command::{Accepted, CommandId, Issuer, Move, Note, Refused, Strategy, Verdict};
use crate::event::{Photo, RobotId};
use crate::hold::Hold;
use crate::robot::Part;
use crate::search::{Goal, Search};
use crate::state::{Conditions, PersistentState, Phase, Retrieval};
use crate::units::{AlarmId, Cell, Celsius, Epoch, Heading, LuggageId, MissionId, OrderId, Piece, Pose, Seq, Ticket, WallTime};
use crate::world::alarm::AlarmCause;
use crate::world::hall_map::Mark;
use crate::world::luggage::Luggage;

/// Something to be done outside.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Give a robot an order. A halt raised after `order.epoch` makes it void.
    Order(RobotId, Order),
    /// Halt a robot where it is, whatever it does.
    Halt(RobotId),
    /// Let the LED blink, or not.
    Led(RobotId, bool),
    /// Keep this for good, and say `Event::Recorded` of its last entry when it is.
    Record(Page),
    /// Answer a command.
    Answer(Ticket, Result<Accepted, Refused>),
}

/// One bounded thing for a robot to do: at most one cell, one quarter turn, one photo or one movement of its arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// Its number, by which the robot answers.
    pub id: OrderId,
    /// What to do.
    pub action: Action,
    /// The epoch in which it was given; after a later stop it must not begin.
    pub epoch: Epoch,
    /// After this long the robot halts by itself.
    pub deadline: Duration,
}

/// What one order asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// A basic move.
    Move(Move),
    /// Sense, then return to the centre of the cell and the heading in which the last completed order left the robot.
    Recentre,
    /// Take a photo of what is ahead, with this written on it.
    Photograph(Stamp),
    /// One place further in, on the way from before the entrance to home. The heading stays.
    Enter,
    /// One place further out, from home or on the way from there. The heading stays.
    Leave,
    /// Something that the arm does.
    Arm(ArmAction),
}

impl Action {
    /// Whether the robot, or its arm, moves while it does this.
    #[must_use]
    pub const fn is_motion(self) -> bool {
        match self {
            Action::Move(_) | Action::Recentre | Action::Enter | Action::Leave => true,
            Action::Photograph(_) => false,
            Action::Arm(action) => action.is_motion(),
        }
    }

    /// Whether the robot may leave its place while it does this.
    #[must_use]
    pub const fn moves_base(self) -> bool {
        matches!(self, Action::Move(_) | Action::Recentre | Action::Enter | Action::Leave)
    }

    /// What a robot must have for it.
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

/// What is written on a photo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Where the robot stands, in the map's own cells.
    pub pose: Pose,
    /// When.
    pub wall: WallTime,
}

/// What one input put on record: kept together or not at all, so that the journal never ends in the middle of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// The place of the first entry; the others follow without a gap.
    pub first: Seq,
    /// The entries; never none.
    pub entries: Vec<Entry>,
}

impl Page {
    /// The place of the last entry.
    #[must_use]
    pub fn last(&self) -> Seq {
        Seq((self.first.0 + self.entries.len() as u64).saturating_sub(1))
    }
}

/// One line of the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// When it happened.
    pub wall: WallTime,
    /// What happened.
    pub fact: Fact,
}

/// What is worth keeping for good. `crate::state` folds them into what stands.
#[derive(Clone, Debug, PartialEq)]
pub enum Fact {
    /// The program was started, in this version, over what had been kept before.
    ProgramStarted(String),
    /// The program was asked to end, by this.
    ProgramEnded(String),
    /// The machine's wall clock was set by so many milliseconds, back if negative, or the machine slept: entries before are by the
    /// clock as it was.
    ClockSet(i64),
    /// Where, and under which threshold, what follows happens.
    Conditions(Conditions),
    /// Everything that stands, so that nothing before needs to be read to go on.
    State(Box<PersistentState>),
    /// A command came, and what became of it.
    Command {
        /// Who gave it, where from and by which door.
        issuer: Issuer,
        /// The sender's own name for it.
        id: Option<CommandId>,
        /// What was asked.
        asked: Asked,
        /// The epoch that its sender said it saw.
        epoch: Option<Epoch>,
        /// The piece it turned out to be about.
        luggage: Option<LuggageId>,
        /// Why it was refused, if it was.
        refused: Option<Refused>,
    },
    /// A mission began.
    MissionBegan(MissionId, Strategy),
    /// A mission was put away; the bombs that were left in place.
    MissionArchived(MissionId, Vec<LuggageId>),
    /// The phase changed, or how far an inspection has come.
    Phase(Phase),
    /// The set of holds changed.
    Holds(Vec<Hold>),
    /// Somebody's stop raised the epoch.
    Epoch(Epoch),
    /// The goal changed; how far the search has come.
    Goal(Option<Goal>, Search),
    /// The robot that searches stands at a pose.
    Pose(Pose),
    /// Another robot stands at a pose.
    RobotPose(RobotId, Pose),
    /// So many steps from home a robot stands before the entrance now; 0: it is in the hall.
    Outside(RobotId, u8),
    /// How a retrieval stands now; `None`: none is under way any more.
    Retrieval(Option<Box<Retrieval>>),
    /// A piece that was known already was met in this cell, too.
    MetAgain(Cell, Piece),
    /// The piece is in the container.
    Secured(LuggageId),
    /// The LED begins or ends blinking.
    Led(bool),
    /// An obstacle was met; what it was taken for.
    Obstacle(Cell, &'static str),
    /// A cell is known now.
    Mark(Cell, Mark),
    /// A piece of luggage was inspected, or photographed again.
    Luggage {
        /// Its record, without a verdict.
        record: Arc<Luggage>,
        /// The new photo; absent when none was taken, and when the entry was read back: pictures are kept apart.
        photo: Option<Photo>,
    },
    /// A verdict was given.
    Verdict {
        /// Of which piece.
        luggage: LuggageId,
        /// What it is.
        verdict: Verdict,
        /// Who says so.
        who: Arc<str>,
        /// What else was said of it.
        note: Option<Note>,
    },
    /// A temperature was read: the source and the reading.
    Temperature(Arc<str>, Celsius),
    /// A source of readings fell silent: what it read last is not known any more.
    ThermometerSilent(Arc<str>),
    /// An alarm was raised: the piece it is about, and what it says.
    AlarmRaised(AlarmId, Option<LuggageId>, AlarmCause),
    /// An alarm was seen by somebody.
    AlarmAcknowledged(AlarmId, Arc<str>),
    /// A strategy was chosen.
    Strategy(Strategy),
    /// The map was emptied, with the robot facing this way at home.
    MapEmptied(Heading),
    /// Old missions were written out into an archive.
    WrittenOut(WrittenOut),
    /// All entries before this one were unpacked from an archive.
    Unpacked(Unpacked),
}

/// What an archive took out of the journal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WrittenOut {
    /// The first and the last mission in it.
    pub missions: (MissionId, MissionId),
    /// Entries up to here stand in it alone.
    pub until: Seq,
    /// What its file was called.
    pub file: String,
    /// The SHA-256 of the file, in 64 lower-case hexadecimal digits.
    pub digest: String,
}

/// What a journal was unpacked from, and where it begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unpacked {
    /// What the file of the archive was called.
    pub file: String,
    /// The SHA-256 of the file, in 64 lower-case hexadecimal digits.
    pub digest: String,
    /// The last entry that is not in it, 0 where none is missing,
    pub behind: Seq,
    /// and the digest of that entry's page, in 64 lower-case hexadecimal digits.
    pub page: String,
}
