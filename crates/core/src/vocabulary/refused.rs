//! Every reason why a command can be refused, as a sentence for an operator and as a fixed code for programs. Each
//! interface decides how it sends a refusal.

use std::sync::Arc;

use crate::closing::OpenPoints;
use crate::command::{CommandId, Verdict};
use crate::hold::Hold;
use crate::phase::{FaultCause, PhaseName};
use crate::robot::RobotId;
use crate::units::{AlarmId, Cell, Epoch, LuggageId, MissionId};

/// Kind of a refusal. Each interface derives its own codes from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefusalKind {
    /// The state forbids the command.
    Conflict,
    /// The thing that the command names does not exist.
    Unknown,
    /// The command cannot be recorded at present.
    Unavailable,
    /// The command contradicts an earlier command of the same sender.
    Mismatch,
    /// The role of the sender does not allow the command.
    Forbidden,
}

/// Why a command was refused. `Display` is the sentence for an operator.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// Holds that a movement command does not clear. The text is the reason of the store, if the store is among the
    /// holds and its reason is known.
    #[error("not possible while held: {}", holds_in_words(.0, .1.as_deref()))]
    Held(Vec<Hold>, Option<String>),
    #[error("outdated: it was sent at epoch {sent}, but a STOP has since raised it to {now}; look again, then repeat it")]
    Outdated { sent: Epoch, now: Epoch },
    /// The command was delivered again and has no epoch. A STOP or a restart may have happened since it was first
    /// sent.
    #[error("outdated: it was sent before, and a STOP or a restart may have come since; look again, then give it anew")]
    SentBefore,
    #[error("not possible while {}", .0.in_words())]
    NotInPhase(PhaseName),
    #[error("luggage #{0} waits for its verdict: answer safe or danger first")]
    VerdictPending(LuggageId),
    #[error("the robot is being driven by hand: wait for the end of the move, or press STOP")]
    Driving,
    #[error("the robot is on its mission: press STOP before driving it by hand")]
    NotStopped,
    #[error("there is an obstacle at {0}")]
    IntoObstacle(Cell),
    #[error("this robot has no small corrective turns")]
    NotCapable,
    #[error("the robot is moving: press STOP first")]
    Moving,
    #[error("a piece of luggage is being recorded: wait for its photo")]
    Unrecorded,
    #[error("luggage #{0} is dangerous and still in the hall: acknowledge its alarm first")]
    BombUnfetched(LuggageId),
    #[error("there is no luggage #{0}")]
    UnknownLuggage(LuggageId),
    /// Only a dangerous piece that is still in the hall is fetched.
    #[error("luggage #{0} is not a bomb in the hall: name a dangerous piece that has not been fetched yet")]
    NotABomb(LuggageId),
    /// An old client sent a verdict without a number, but no piece waits for a verdict.
    #[error("no luggage waits for a verdict")]
    NothingPending,
    #[error("luggage #{luggage} was already found {}: a verdict is final", .verdict.name())]
    Decided { luggage: LuggageId, verdict: Verdict },
    /// Without a photo, a piece cannot be declared safe.
    #[error("luggage #{0} has no usable photo: take it again, or answer danger")]
    NoPhoto(LuggageId),
    /// The rules of the team ask for the three answers before a piece is declared safe.
    #[error(
        "luggage #{0} cannot be declared safe yet: first answer whether it is hidden, obviously suspicious or typical of this place"
    )]
    HotUnanswered(LuggageId),
    /// Only the piece in front of the robot can be photographed.
    #[error("luggage #{0} is not the one being inspected")]
    NotInspected(LuggageId),
    #[error("the photo is being taken")]
    PhotoUnderWay,
    #[error("there is no alarm {0}")]
    UnknownAlarm(AlarmId),
    #[error("no retrieval robot is there")]
    NoRetrievalRobot,
    #[error("{0} cannot be reached, and the retrieval needs it: mend its link first")]
    FetcherUnreached(RobotId),
    /// A retrieval was interrupted and can continue. This robot is not at the place where a new mission begins.
    #[error("{0} is not back yet: press START, so that the retrieval goes on")]
    FetcherAbroad(RobotId),
    /// Whoever closes a mission must have seen what is left open.
    #[error("open points: {open}; to close the mission with them, send openPoints {:?}", .open.code(*.mission))]
    OpenPoints { mission: MissionId, open: Box<OpenPoints> },
    /// The sender may have looked at an earlier mission.
    #[error("mission {0} is under way now: look again, then name that one")]
    OtherMission(MissionId),
    /// Whoever knows the test pieces would judge them without looking.
    #[error("the test pieces of this exercise are known by now: start hallsweep again for another exercise")]
    ExerciseOver,
    #[error("no searched cell lies in this area: name two corners of an area that the robot has searched")]
    NothingSearched,
    #[error("too many cells: at most {0} can wait to be searched again")]
    AreaTooLarge(usize),
    #[error("the hall has no area {0:?}: name one of its areas")]
    UnknownArea(Arc<str>),
    #[error("the area {0:?} is closed already: to open it, search it again")]
    AreaClosed(Arc<str>),
    #[error("the fault still stands: {0}")]
    FaultStands(FaultCause),
    #[error("the record cannot be written, so nothing was decided: try again when the store is back")]
    StoreDown,
    /// The command was carried out, but the store failed before it was recorded.
    #[error("it could not be put on record, because the store has failed: look at the state before you repeat it")]
    NotKept,
    /// Shown at a button, but never sent as an answer. The last change is not recorded yet, and this change may
    /// forbid the command.
    #[error("what was done last is not on record yet: wait a moment")]
    NotOnRecord,
    #[error("the id {} was used before, for another command: give each command an id of its own", .0.text())]
    OtherContent(CommandId),
    #[error("there is no sensor {0:?}: name it in the setting temperature.sensor")]
    UnknownSensor(Arc<str>),
    /// The sender's role allows only watching and STOP. The interface provides the sentence.
    #[error("{0}")]
    NotAllowed(String),
    /// A refusal as text from an interface, or from another version of the program.
    #[error("{}", .0.words)]
    InWords(Refusal),
}

pub const OTHER_CONTENT: &str = "otherContent";

/// A refusal of which only the code and the sentence are known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    pub code: &'static str,
    pub kind: RefusalKind,
    pub words: String,
}

/// Every code with its kind, for refusals that are read back. A test of an interface compares this list with the
/// variants. The code of `NotOnRecord` is missing, because no command is answered with it.
pub const CODES: [(&str, RefusalKind); 37] = {
    use RefusalKind::{Conflict, Forbidden, Mismatch, Unavailable, Unknown};
    [
        ("held", Conflict),
        ("outdated", Conflict),
        ("sentBefore", Conflict),
        ("notInPhase", Conflict),
        ("verdictPending", Conflict),
        ("driving", Conflict),
        ("notStopped", Conflict),
        ("intoObstacle", Conflict),
        ("notCapable", Conflict),
        ("moving", Conflict),
        ("unrecorded", Conflict),
        ("bombUnfetched", Conflict),
        ("unknownLuggage", Unknown),
        ("notABomb", Conflict),
        ("nothingPending", Conflict),
        ("decided", Conflict),
        ("noPhoto", Conflict),
        ("hotUnanswered", Conflict),
        ("notInspected", Conflict),
        ("photoUnderWay", Conflict),
        ("unknownAlarm", Unknown),
        ("noRetrievalRobot", Conflict),
        ("fetcherUnreached", Conflict),
        ("fetcherAbroad", Conflict),
        ("openPoints", Conflict),
        ("otherMission", Conflict),
        ("exerciseOver", Conflict),
        ("nothingSearched", Conflict),
        ("areaTooLarge", Conflict),
        ("unknownArea", Unknown),
        ("areaClosed", Conflict),
        ("faultStands", Conflict),
        ("storeDown", Unavailable),
        ("notKept", Unavailable),
        (OTHER_CONTENT, Mismatch),
        ("unknownSensor", Unknown),
        ("notAllowed", Forbidden),
    ]
};

impl Refused {
    #[must_use]
    pub const fn kind(&self) -> RefusalKind {
        match self {
            Refused::UnknownLuggage(_) | Refused::UnknownAlarm(_) | Refused::UnknownSensor(_) | Refused::UnknownArea(_) => {
                RefusalKind::Unknown
            }
            Refused::StoreDown | Refused::NotKept | Refused::NotOnRecord => RefusalKind::Unavailable,
            Refused::OtherContent(_) => RefusalKind::Mismatch,
            Refused::NotAllowed(_) => RefusalKind::Forbidden,
            Refused::InWords(refusal) => refusal.kind,
            Refused::Held(..)
            | Refused::Outdated { .. }
            | Refused::SentBefore
            | Refused::NotInPhase(_)
            | Refused::VerdictPending(_)
            | Refused::Driving
            | Refused::NotStopped
            | Refused::IntoObstacle(_)
            | Refused::NotCapable
            | Refused::Moving
            | Refused::Unrecorded
            | Refused::BombUnfetched(_)
            | Refused::NotABomb(_)
            | Refused::NothingPending
            | Refused::Decided { .. }
            | Refused::NoPhoto(_)
            | Refused::HotUnanswered(_)
            | Refused::NotInspected(_)
            | Refused::PhotoUnderWay
            | Refused::NoRetrievalRobot
            | Refused::FetcherUnreached(_)
            | Refused::FetcherAbroad(_)
            | Refused::OpenPoints { .. }
            | Refused::OtherMission(_)
            | Refused::ExerciseOver
            | Refused::NothingSearched
            | Refused::AreaTooLarge(_)
            | Refused::AreaClosed(_)
            | Refused::FaultStands(_) => RefusalKind::Conflict,
        }
    }

    /// A short fixed word for programs. The code never changes, but the sentence may change.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Refused::Held(..) => "held",
            Refused::Outdated { .. } => "outdated",
            Refused::SentBefore => "sentBefore",
            Refused::NotInPhase(_) => "notInPhase",
            Refused::VerdictPending(_) => "verdictPending",
            Refused::Driving => "driving",
            Refused::NotStopped => "notStopped",
            Refused::IntoObstacle(_) => "intoObstacle",
            Refused::NotCapable => "notCapable",
            Refused::Moving => "moving",
            Refused::Unrecorded => "unrecorded",
            Refused::BombUnfetched(_) => "bombUnfetched",
            Refused::UnknownLuggage(_) => "unknownLuggage",
            Refused::NotABomb(_) => "notABomb",
            Refused::NothingPending => "nothingPending",
            Refused::Decided { .. } => "decided",
            Refused::NoPhoto(_) => "noPhoto",
            Refused::HotUnanswered(_) => "hotUnanswered",
            Refused::NotInspected(_) => "notInspected",
            Refused::PhotoUnderWay => "photoUnderWay",
            Refused::UnknownAlarm(_) => "unknownAlarm",
            Refused::NoRetrievalRobot => "noRetrievalRobot",
            Refused::FetcherUnreached(_) => "fetcherUnreached",
            Refused::FetcherAbroad(_) => "fetcherAbroad",
            Refused::OpenPoints { .. } => "openPoints",
            Refused::OtherMission(_) => "otherMission",
            Refused::ExerciseOver => "exerciseOver",
            Refused::NothingSearched => "nothingSearched",
            Refused::AreaTooLarge(_) => "areaTooLarge",
            Refused::UnknownArea(_) => "unknownArea",
            Refused::AreaClosed(_) => "areaClosed",
            Refused::FaultStands(_) => "faultStands",
            Refused::StoreDown => "storeDown",
            Refused::NotKept => "notKept",
            Refused::NotOnRecord => "notOnRecord",
            Refused::OtherContent(_) => OTHER_CONTENT,
            Refused::UnknownSensor(_) => "unknownSensor",
            Refused::NotAllowed(_) => "notAllowed",
            Refused::InWords(refusal) => refusal.code,
        }
    }
}

/// Joins the sentences of the holds. The reason of the store comes first, because the store may be the cause of other
/// holds.
fn holds_in_words(holds: &[Hold], store_failure: Option<&str>) -> String {
    let store = store_failure.map(|why| format!("nothing can be recorded: {why}"));
    let others = holds.iter().filter(|hold| store.is_none() || **hold != Hold::Store).map(|hold| hold.in_words().to_owned());
    store.iter().cloned().chain(others).collect::<Vec<_>>().join("; ")
}
