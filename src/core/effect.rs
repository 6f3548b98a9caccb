//! What the core asks of the world outside: orders to robots, halts, records, answers.
//! It only asks; whoever polls the effects performs them.

use std::sync::Arc;
use std::time::Duration;

use super::command::{Accepted, Door, Move, Refused, Verdict};
use super::event::{Photo, RobotId};
use super::explore::Strategy;
use super::mission::{Hold, PhaseName};
use super::units::{AlarmId, Cell, Celsius, Epoch, Heading, LuggageId, MissionId, OrderId, Pose, Seq, Ticket, Wall};

/// Something to be done outside.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Give a robot an order. A halt raised after `order.epoch` makes it void.
    Order(RobotId, Order),
    /// Halt a robot where it is, whatever it does.
    Halt(RobotId),
    /// Let the LED blink, or not.
    Led(RobotId, bool),
    /// Keep this for good, and say `Event::Recorded` when it is.
    Record(Seq, Entry),
    /// Answer a command.
    Answer(Ticket, Result<Accepted, Refused>),
}

/// One bounded thing for a robot to do: at most one cell, one quarter turn or one photo.
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
}

impl Action {
    /// Whether the robot moves while it does this.
    #[must_use]
    pub const fn is_motion(self) -> bool {
        matches!(self, Action::Move(_) | Action::Recentre)
    }
}

/// What is written on a photo.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    /// Where the robot stands, in the map's own cells.
    pub pose: Pose,
    /// When.
    pub wall: Wall,
}

/// One line of the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// When it happened.
    pub wall: Wall,
    /// What happened.
    pub fact: Fact,
}

/// What is worth keeping for good.
#[derive(Clone, Debug, PartialEq)]
pub enum Fact {
    /// A command came, and what became of it.
    Command {
        /// By which door.
        door: Door,
        /// Who gave it.
        who: Arc<str>,
        /// The command in a few words.
        command: String,
        /// Why it was refused, if it was.
        refused: Option<&'static str>,
    },
    /// A mission began.
    MissionBegan(MissionId, Strategy),
    /// A mission was put away; the bombs that were left in place.
    MissionArchived(MissionId, Vec<LuggageId>),
    /// The phase changed; the one it interrupts, if it is an interruption.
    Phase(PhaseName, Option<PhaseName>),
    /// The set of holds changed.
    Holds(Vec<Hold>),
    /// The goal changed.
    Goal(Option<Cell>),
    /// The robot stands at a pose.
    Pose(Pose),
    /// An obstacle was met; what it was taken for.
    Obstacle(Cell, &'static str),
    /// A piece of luggage was inspected, or photographed again.
    Luggage {
        /// Its number.
        id: LuggageId,
        /// The cell of the bag.
        cell: Cell,
        /// Where the photo was taken.
        pose: Pose,
        /// The photo, or why there is none.
        photo: Result<Photo, String>,
    },
    /// A verdict was given.
    Verdict {
        /// Of which piece.
        luggage: LuggageId,
        /// What it is.
        verdict: Verdict,
        /// Who says so.
        who: Arc<str>,
    },
    /// A temperature was read: the source and the reading.
    Temperature(Arc<str>, Celsius),
    /// An alarm was raised, in words.
    AlarmRaised(AlarmId, String),
    /// An alarm was seen by somebody.
    AlarmAcknowledged(AlarmId, Arc<str>),
    /// A strategy was chosen.
    Strategy(Strategy),
    /// The map was emptied, with the robot facing this way at home.
    MapEmptied(Heading),
}
