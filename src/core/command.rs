//! What can be asked of hallsweep, by whom, and every reason for which it can be refused.
//! How a command or a refusal is written on a wire stands in `crate::wire`, not here.

use std::sync::Arc;

use super::explore::Strategy;
use super::mission::{Hold, PhaseName};
use super::units::{AlarmId, Cell, Celsius, Epoch, LuggageId};

/// A command with what came with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// What is asked.
    pub command: Command,
    /// The epoch its sender saw; `None` is stamped on arrival. Only movement commands look at it.
    pub epoch: Option<Epoch>,
    /// Who asks.
    pub issuer: Issuer,
    /// The sender's own name for this command: one that comes again is answered as before, and not carried out again.
    pub id: Option<CommandId>,
}

impl Request {
    /// A command as its sender gave it, without an epoch or an id.
    #[must_use]
    pub const fn new(command: Command, issuer: Issuer) -> Request {
        Request { command, epoch: None, issuer, id: None }
    }
}

/// A sender's own name for one command.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CommandId(Arc<str>);

impl CommandId {
    /// The longest name taken, in bytes: more than a UUID in any writing.
    pub const MOST: usize = 128;

    /// `text` as a name: 1 to `MOST` visible ASCII characters, else `None`.
    #[must_use]
    pub fn new(text: &str) -> Option<CommandId> {
        let sound = (1..=CommandId::MOST).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_graphic());
        sound.then(|| CommandId(Arc::from(text)))
    }

    /// The name.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.0
    }
}

/// Everything an operator, or a tool acting for one, can ask for (mission §4).
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Begin, or go on with what was halted.
    Start,
    /// Halt the robot where it is. The handle raises the halt before this command is even queued.
    Stop,
    /// Go to the home cell and wait.
    BackHome,
    /// Fetch the dangerous piece.
    Retrieve,
    /// Archive the mission and be idle.
    Reset,
    /// One basic move by hand.
    Move(Move),
    /// Drive to a cell by hand.
    Goto(Cell),
    /// Say of a piece of luggage what it is.
    Verdict {
        /// The piece meant.
        luggage: LuggageRef,
        /// What it is.
        verdict: Verdict,
    },
    /// Take the photo of the piece being inspected again.
    RetakePhoto(LuggageId),
    /// The operator has seen the alarm.
    Acknowledge(AlarmId),
    /// Choose the order of the search.
    ChooseStrategy(Strategy),
    /// What is known of the temperature.
    Temperature(TemperatureReport),
}

impl Command {
    /// The piece of luggage it is about, where it is about one.
    #[must_use]
    pub const fn luggage(&self) -> Option<LuggageRef> {
        match self {
            Command::Verdict { luggage, .. } => Some(*luggage),
            Command::RetakePhoto(id) => Some(LuggageRef::Id(*id)),
            Command::Start
            | Command::Stop
            | Command::BackHome
            | Command::Retrieve
            | Command::Reset
            | Command::Move(_)
            | Command::Goto(_)
            | Command::Acknowledge(_)
            | Command::ChooseStrategy(_)
            | Command::Temperature(_) => None,
        }
    }
}

/// A basic move (mission §3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Move {
    /// One cell forward, `w`.
    Forward,
    /// One cell backward, `s`.
    Backward,
    /// 90° to the left, `a` (and `l` of old clients).
    TurnLeft,
    /// 90° to the right, `d` (and `r` of old clients).
    TurnRight,
    /// A small correction to the left, `z`; only some robots can.
    NudgeLeft,
    /// A small correction to the right, `x`; only some robots can.
    NudgeRight,
}

/// What the operator says of a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// The search goes on.
    Safe,
    /// The robot comes home and the piece is fetched.
    Danger,
}

impl Verdict {
    /// The word of the doors: `safe` or `danger`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Verdict::Safe => "safe",
            Verdict::Danger => "danger",
        }
    }
}

/// How a verdict says which piece it means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LuggageRef {
    /// By its number.
    Id(LuggageId),
    /// An old client's bare word: the one piece whose verdict is pending.
    Pending,
}

/// What an operator or a tool reports of the temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TemperatureReport {
    /// The button OK; concerns the hold `tooHigh` alone.
    Ok,
    /// The button TOO HIGH.
    TooHigh,
    /// A reading, compared with the threshold.
    Reading(Celsius),
}

/// Who gave a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Issuer {
    /// By which door it came.
    pub door: Door,
    /// The name of whoever gave it, as far as it is known.
    pub who: Arc<str>,
    /// Where it came from, as `192.0.2.7`; `here` where there is no address.
    pub from: Arc<str>,
}

impl Issuer {
    /// Somebody at a door that asks for no name.
    #[must_use]
    pub fn operator(door: Door) -> Issuer {
        Issuer { door, who: Arc::from("operator"), from: Arc::from("here") }
    }
}

/// The ways into hallsweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Door {
    /// The page at `/`.
    Console,
    /// JSON over HTTP, and the old console's HTTP routes.
    Http,
    /// The command line itself (`hallsweep explore`) and tests of the core.
    Local,
}

impl Door {
    /// The word for records.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Door::Console => "console",
            Door::Http => "http",
            Door::Local => "local",
        }
    }
}

/// Which family a refusal is of; each door maps these to its own codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefusalKind {
    /// The state forbids it (HTTP 409).
    Conflict,
    /// There is no such thing (HTTP 404).
    Unknown,
    /// It cannot be kept safe just now (HTTP 503).
    Unavailable,
}

/// Why a command was refused. `Display` is the sentence an operator reads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// Holds stand that a movement command does not clear.
    #[error("refused while held: {}", holds_in_words(.0))]
    Held(Vec<Hold>),
    /// Somebody pressed STOP after the sender last looked.
    #[error("outdated: it was sent at epoch {sent}, but a STOP has since raised it to {now}; look again, then repeat it")]
    Outdated {
        /// The epoch the command carried.
        sent: Epoch,
        /// The epoch that holds.
        now: Epoch,
    },
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
    /// What put the mission in fault is still so.
    #[error("the fault still stands: {0}")]
    FaultStands(String),
    /// Nothing can be put on record.
    #[error("the record cannot be written, so nothing was decided: try again when the store is back")]
    StoreDown,
    /// It was carried out, but the store failed before it was on record.
    #[error("it could not be put on record, because the store has failed: look at the state before you repeat it")]
    NotKept,
}

impl Refused {
    /// The family, for the codes of the doors.
    #[must_use]
    pub const fn kind(&self) -> RefusalKind {
        match self {
            Refused::UnknownLuggage(_) | Refused::UnknownAlarm(_) => RefusalKind::Unknown,
            Refused::StoreDown | Refused::NotKept => RefusalKind::Unavailable,
            Refused::Held(_)
            | Refused::Outdated { .. }
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
            | Refused::FaultStands(_) => RefusalKind::Conflict,
        }
    }

    /// A short fixed word for programs: it never changes, the sentence may.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Refused::Held(_) => "held",
            Refused::Outdated { .. } => "outdated",
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
            Refused::FaultStands(_) => "faultStands",
            Refused::StoreDown => "storeDown",
            Refused::NotKept => "notKept",
        }
    }
}

/// What an accepted command is answered with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Accepted {
    /// The revision of the state that contains its effect.
    pub revision: super::units::Revision,
    /// The piece it concerned, where it concerned one.
    pub luggage: Option<LuggageId>,
}

fn holds_in_words(holds: &[Hold]) -> String {
    let words: Vec<&str> = holds.iter().map(|hold| hold.in_words()).collect();
    words.join("; ")
}
