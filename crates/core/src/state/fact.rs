//! The facts of the journal: everything that may happen to a mission and its robots. An entry is a fact with its time;
//! `effect` puts the entries of one input together.

use std::sync::Arc;

use super::{Conditions, PersistentState, Phase, Retrieval};
use crate::asked::Asked;
use crate::command::{CommandId, Issuer, Note, Strategy, Verdict};
use crate::event::Photo;
use crate::hold::Hold;
use crate::refused::Refused;
use crate::robot::RobotId;
use crate::search::{Goal, Search};
use crate::units::{AlarmId, Cell, Celsius, Epoch, Heading, LuggageId, MissionId, Piece, Pose, Seq, WallTime};
use crate::world::alarm::AlarmCause;
use crate::world::hall_map::Mark;
use crate::world::luggage::Luggage;

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
