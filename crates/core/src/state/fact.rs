//! The facts of the journal: everything that may happen to a mission and its robots. An entry is a fact with its
//! time. `effect` groups the entries of one input.

use std::sync::Arc;

use super::{Conditions, PersistentState, Phase, Retrieval};
use crate::asked::Asked;
use crate::closing::{Closed, OpenInArea};
use crate::command::{Again, CommandId, Hot, Issuer, Note, Strategy, Verdict};
use crate::event::Photo;
use crate::hold::Hold;
use crate::refused::Refused;
use crate::robot::RobotId;
use crate::search::{Goal, Search};
use crate::units::{AlarmId, Cell, Celsius, Epoch, Heading, LuggageId, MissionId, Piece, Pose, Seq, WallTime};
use crate::world::alarm::AlarmCause;
use crate::world::hall_map::Mark;
use crate::world::luggage::{Judgement, Luggage};

#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub wall: WallTime,
    pub fact: Fact,
}

/// Something that happened, as the journal records it. `crate::state` applies facts to the state.
#[derive(Clone, Debug, PartialEq)]
pub enum Fact {
    /// The program was started, in this version.
    ProgramStarted(String),
    /// The program was ended by this signal, such as `SIGTERM`.
    ProgramEnded(String),
    /// The machine's wall clock was set by this many milliseconds (negative: set back), or the machine slept. Earlier
    /// entries keep the times of the earlier clock.
    ClockSet(i64),
    /// The conditions for all entries that follow.
    Conditions(Conditions),
    /// The whole state, so that the program need not read earlier entries at its next start.
    State(Box<PersistentState>),
    /// A command. Refused commands are recorded too (safety A6).
    Command {
        issuer: Issuer,
        id: Option<CommandId>,
        asked: Asked,
        /// The epoch that the sender named. The epoch at the command's arrival is not recorded.
        epoch: Option<Epoch>,
        luggage: Option<LuggageId>,
        refused: Option<Refused>,
    },
    MissionBegan(MissionId, Strategy),
    /// The mission was archived. The list has the dangerous pieces that were left in the hall.
    MissionArchived(MissionId, Vec<LuggageId>),
    Phase(Phase),
    Holds(Vec<Hold>),
    Epoch(Epoch),
    Goal(Option<Goal>, Search),
    Pose(Pose),
    RobotPose(RobotId, Pose),
    /// Number of steps from home if the robot stands outside the entrance; 0 if it is in the hall.
    Outside(RobotId, u8),
    /// The state of the retrieval; `None` after its end.
    Retrieval(Option<Box<Retrieval>>),
    MetAgain(Cell, Piece),
    Secured(LuggageId),
    Led(bool),
    /// The cell, and the recognised kind of the obstacle: `wall`, `luggage` or `unknown`.
    Obstacle(Cell, &'static str),
    Mark(Cell, Mark),
    Luggage {
        /// The record without its verdict. `Verdict` records the verdict.
        record: Arc<Luggage>,
        /// The new photo, if there is one. It is `None` in an entry that was read back, because pictures are stored
        /// separately.
        photo: Option<Photo>,
    },
    Verdict {
        luggage: LuggageId,
        verdict: Verdict,
        who: Arc<str>,
        note: Option<Note>,
        hot: Hot,
    },
    /// A judge could not tell from the photo whether the piece is safe.
    Unsure {
        luggage: LuggageId,
        who: Arc<str>,
        note: Option<Note>,
        hot: Hot,
    },
    /// The answer of another judge, which was kept back until this entry.
    Judged(Box<Judgement>),
    /// Whether a judged piece is a test piece of the exercise. It is recorded at the end of the exercise.
    Revealed {
        luggage: LuggageId,
        is_test: bool,
    },
    /// The person in charge has closed the mission.
    Closed(Box<Closed>),
    /// The mission and its record were handed over to this person or office.
    HandedOver {
        /// The sender with door and address, such as `operator (http, 192.0.2.7)`.
        who: Arc<str>,
        to: Note,
        note: Option<Note>,
    },
    /// The robot has to visit these searched cells once more. A closed area is open again.
    SearchAgain(Again),
    /// The order in which a person wants the areas searched. The search chooses its goal anew.
    AreasOrdered(Arc<[Arc<str>]>),
    /// The person in charge has closed the area of this name. The search chooses its goal anew.
    AreaClosed(Arc<str>, Box<Closed<OpenInArea>>),
    Temperature(Arc<str>, Celsius),
    /// The last reading of this source no longer counts as known.
    ThermometerSilent(Arc<str>),
    AlarmRaised(AlarmId, Option<LuggageId>, AlarmCause),
    AlarmAcknowledged(AlarmId, Arc<str>),
    Strategy(Strategy),
    /// The map was emptied. The robot stands at home with this heading.
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
    /// The last entry that was moved into the archive. It and all earlier entries are in the archive only.
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
    /// The last entry that is missing from the journal; 0 if none is missing.
    pub behind: Seq,
    /// The digest of the page that contains this last entry, in 64 lower-case hexadecimal digits.
    pub page: String,
}
