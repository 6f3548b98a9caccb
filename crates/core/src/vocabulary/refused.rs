//! Every reason for which a command can be refused, in words for an operator and as a fixed code for programs.
//! How it is told to whom is decided outside.

use std::sync::Arc;

use crate::command::{CommandId, Verdict};
use crate::event::RobotId;
use crate::hold::Hold;
use crate::phase::{FaultCause, PhaseName};
use crate::units::{AlarmId, Cell, Epoch, LuggageId};

/// What kind of refusal it is, as far as it makes a difference to whoever is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefusalKind {
    /// The state forbids it.
    Conflict,
    /// There is no such thing.
    Unknown,
    /// It cannot be kept safe just now.
    Unavailable,
    /// It contradicts what the same sender said before.
    Mismatch,
    /// Its sender may not.
    Forbidden,
}

/// Why a command was refused. `Display` is the sentence an operator reads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// Holds stand that a movement command does not clear, and why nothing can be recorded if that is one of them and known.
    #[error("not possible while held: {}", holds_in_words(.0, .1.as_deref()))]
    Held(Vec<Hold>, Option<String>),
    /// Somebody pressed STOP after the sender last looked.
    #[error("outdated: it was sent at epoch {sent}, but a STOP has since raised it to {now}; look again, then repeat it")]
    Outdated {
        /// The epoch the command carried.
        sent: Epoch,
        /// The epoch that holds.
        now: Epoch,
    },
    /// It was delivered again, and names no epoch: a STOP, or a restart, may have come since it was given.
    #[error("outdated: it was sent before, and a STOP or a restart may have come since; look again, then give it anew")]
    SentBefore,
    /// The phase has no use for it.
    #[error("not possible while {}", .0.in_words())]
    NotInPhase(PhaseName),
    /// A piece waits for its verdict first.
    #[error("luggage #{0} waits for its verdict: answer safe or danger first")]
    VerdictPending(LuggageId),
    /// A hand is on the robot.
    #[error("the robot is being driven by hand: wait for the end of the move, or press STOP")]
    Driving,
    /// Manual driving needs a STOP before it.
    #[error("the robot is on its mission: press STOP before driving it by hand")]
    NotStopped,
    /// The way is known to be blocked.
    #[error("there is an obstacle at {0}")]
    IntoObstacle(Cell),
    /// This robot cannot do that.
    #[error("this robot has no small corrective turns")]
    NotCapable,
    /// It must stand still for that.
    #[error("the robot is moving: press STOP first")]
    Moving,
    /// The piece just met is not on record yet.
    #[error("a piece of luggage is being recorded: wait for its photo")]
    Unrecorded,
    /// A bomb was found and nobody has said that it may stay.
    #[error("luggage #{0} is dangerous and still in the hall: acknowledge its alarm first")]
    BombUnfetched(LuggageId),
    /// No piece has this number.
    #[error("there is no luggage #{0}")]
    UnknownLuggage(LuggageId),
    /// The bare word of an old client found nothing to mean.
    #[error("no luggage waits for a verdict")]
    NothingPending,
    /// Another verdict stands; the first is final.
    #[error("luggage #{luggage} was already found {}: a verdict is final", .verdict.name())]
    Decided {
        /// The piece.
        luggage: LuggageId,
        /// What stands.
        verdict: Verdict,
    },
    /// Without a photo nobody can say that it is safe.
    #[error("luggage #{0} has no usable photo: take it again, or answer danger")]
    NoPhoto(LuggageId),
    /// Only the piece in front of the robot can be photographed.
    #[error("luggage #{0} is not the one being inspected")]
    NotInspected(LuggageId),
    /// One photo at a time.
    #[error("the photo is being taken")]
    PhotoUnderWay,
    /// No alarm has this number.
    #[error("there is no alarm {0}")]
    UnknownAlarm(AlarmId),
    /// Nothing can fetch the bomb.
    #[error("no retrieval robot is there")]
    NoRetrievalRobot,
    /// A robot that the retrieval needs is not linked.
    #[error("{0} cannot be reached, and the retrieval needs it: mend its link first")]
    FetcherUnreached(RobotId),
    /// A retrieval was cut short and can go on; its robots are not where a new mission begins.
    #[error("{0} is not back yet: press START, so that the retrieval goes on")]
    FetcherAbroad(RobotId),
    /// What put the mission in fault is still so.
    #[error("the fault still stands: {0}")]
    FaultStands(FaultCause),
    /// Nothing can be put on record.
    #[error("the record cannot be written, so nothing was decided: try again when the store is back")]
    StoreDown,
    /// It was carried out, but the store failed before it was on record.
    #[error("it could not be put on record, because the store has failed: look at the state before you repeat it")]
    NotKept,
    /// Said of a button, and never as an answer: that something has changed which would forbid it may be told when it is on record.
    #[error("what was done last is not on record yet: wait a moment")]
    NotOnRecord,
    /// The sender used one name for two commands.
    #[error("the id {} was used before, for another command: give each command an id of its own", .0.text())]
    OtherContent(CommandId),
    /// A reading came of a sensor that nobody has configured.
    #[error("there is no sensor {0:?}: name it in the setting temperature.sensor")]
    UnknownSensor(Arc<str>),
    /// Its sender may see, and stop, and no more; in words of the door at which it came.
    #[error("{0}")]
    NotAllowed(String),
    /// In the words of a door, or of another version.
    #[error("{}", .0.words)]
    InWords(Refusal),
}

/// The code of `Refused::OtherContent`.
pub const OTHER_CONTENT: &str = "otherContent";

/// A refusal of which only the code and the sentence are known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// The fixed word for programs.
    pub code: &'static str,
    /// What kind of refusal it is.
    pub kind: RefusalKind,
    /// The sentence an operator read.
    pub words: String,
}

/// Every code with its kind, for refusals read back; a test of a door holds it against the variants. That of `NotOnRecord` is none of
/// them: no command is answered with it.
pub const CODES: [(&str, RefusalKind); 28] = {
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
        ("nothingPending", Conflict),
        ("decided", Conflict),
        ("noPhoto", Conflict),
        ("notInspected", Conflict),
        ("photoUnderWay", Conflict),
        ("unknownAlarm", Unknown),
        ("noRetrievalRobot", Conflict),
        ("fetcherUnreached", Conflict),
        ("fetcherAbroad", Conflict),
        ("faultStands", Conflict),
        ("storeDown", Unavailable),
        ("notKept", Unavailable),
        (OTHER_CONTENT, Mismatch),
        ("unknownSensor", Unknown),
        ("notAllowed", Forbidden),
    ]
};

impl Refused {
    /// What kind of refusal it is.
    #[must_use]
    pub const fn kind(&self) -> RefusalKind {
        match self {
            Refused::UnknownLuggage(_) | Refused::UnknownAlarm(_) | Refused::UnknownSensor(_) => RefusalKind::Unknown,
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
            | Refused::NothingPending
            | Refused::Decided { .. }
            | Refused::NoPhoto(_)
            | Refused::NotInspected(_)
            | Refused::PhotoUnderWay
            | Refused::NoRetrievalRobot
            | Refused::FetcherUnreached(_)
            | Refused::FetcherAbroad(_)
            | Refused::FaultStands(_) => RefusalKind::Conflict,
        }
    }

    /// A short fixed word for programs: it never changes, the sentence may.
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
            Refused::NothingPending => "nothingPending",
            Refused::Decided { .. } => "decided",
            Refused::NoPhoto(_) => "noPhoto",
            Refused::NotInspected(_) => "notInspected",
            Refused::PhotoUnderWay => "photoUnderWay",
            Refused::UnknownAlarm(_) => "unknownAlarm",
            Refused::NoRetrievalRobot => "noRetrievalRobot",
            Refused::FetcherUnreached(_) => "fetcherUnreached",
            Refused::FetcherAbroad(_) => "fetcherAbroad",
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

/// What is to be mended is said first, and by its name: other holds may follow from it.
fn holds_in_words(holds: &[Hold], store_failure: Option<&str>) -> String {
    let store = store_failure.map(|why| format!("nothing can be recorded: {why}"));
    let others = holds.iter().filter(|hold| store.is_none() || **hold != Hold::Store).map(|hold| hold.in_words().to_owned());
    store.iter().cloned().chain(others).collect::<Vec<_>>().join("; ")
}
