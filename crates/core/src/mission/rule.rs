//! The elements of the transition table: guards that may forbid an input, cases, and outcomes. This module only
//! names and explains them. `crate::engine` tests the guards and cases and carries out the acts.

use crate::hold::Hold;
use crate::phase::PhaseName;

/// One rule in a cell of the table. The first rule that applies decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Rule {
    RefuseIf(Guard),
    /// If this guard forbids the input, the input is refused, but these acts are carried out all the same.
    RefuseIfThen(Guard, &'static [Act]),
    When(Case, To, &'static [Act]),
    /// Always the last rule of its cell.
    Go(To, &'static [Act]),
    /// Always the last rule of its cell.
    Never(Guard),
    /// The rule of the interrupted phase applies, and that phase stays interrupted. Always the only rule of its cell.
    AsInterrupted,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum To {
    Stay,
    Phase(PhaseName),
    Interrupted,
}

named! {
    by in_words;
    /// A condition that forbids an input. Each guard has its own refusal with a reason.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Guard {
        Held = "a hold that this command does not clear still stands",
        NotInPhase = "not in this phase",
        VerdictAwaited = "the robot would explore while a piece with a usable photo waits for its verdict",
        VerdictPending = "a verdict is pending",
        OperatorAsked = "the piece in front of the robot waits for its verdict",
        Driving = "an operator drives the robot by hand",
        NotStopped = "`operator` is not raised",
        IntoObstacle = "the robot would enter a cell with a known obstacle",
        NotCapable = "the robot cannot make this move",
        Moving = "the robot moves or is about to move",
        Unrecorded = "a piece is being recorded",
        BombUnfetched = "a bomb is still in the hall and its alarm is not acknowledged",
        UnknownLuggage = "there is no such piece",
        Decided = "the piece has the other verdict already",
        NoPhoto = "there is no usable photo",
        NotInspected = "the piece has its verdict or is not in front of the robot",
        PhotoUnderWay = "the photo is being taken",
        PhotoHeld = "`robotLink` or `store` is raised",
        StoreDown = "`store` is raised",
        UnknownAlarm = "there is no such alarm",
        NoRetrievalRobot = "there is no retrieval robot",
        FetcherUnreached = "a retrieval robot cannot be reached",
        FetcherAbroad = "a robot of an unfinished retrieval is not back",
        FaultStands = "the cause of the fault still stands",
        UnknownSensor = "no such sensor is configured",
    }
}

named! {
    by in_words;
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Case {
        ToBeInspected = "the obstacle is not inspected yet",
        BackedUp = "the robot has backed up",
        FirstPhoto = "the piece has no record yet",
        ThisPiece = "the piece is in front of the robot",
        SameVerdict = "the piece has this verdict already",
        FromIdle = "the interrupted phase is idle",
        RobotAtHome = "the robot is at home",
        BombLeft = "another bomb is still in the hall",
    }
}

/// One small change of the state or of the robot. `Act::in_words` explains each act.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Act {
    Release,
    Begin,
    EmptyMap,
    Stop,
    Raise(Hold),
    Clear(Hold),
    LedOff,
    AlarmDanger,
    AlarmUnrecorded,
    FacePiece,
    Retake,
    RecordPiece,
    RecordRetake,
    AskOperator,
    RecordVerdict,
    NoteReading,
    HearSensor,
    Acknowledge,
    ChooseStrategy,
    Archive,
    RetryBlocked,
    BeginRetrieval,
    EndRetrieval,
}

impl Act {
    pub(crate) fn in_words(self) -> String {
        let words = match self {
            Act::Release => "clear `operator`, `restart`, `awaitingStart`",
            Act::Begin => "begin a mission, LED blinks",
            Act::EmptyMap => "empty the map",
            Act::Stop => "halt, raise the epoch and `operator`",
            Act::Raise(hold) => return format!("halt, raise `{}`", hold.name()),
            Act::Clear(hold) => return format!("clear `{}`", hold.name()),
            Act::LedOff => "LED off",
            Act::AlarmDanger => "alarm the console, end `alarm`",
            Act::AlarmUnrecorded => "alarm the console, raise `alarm`",
            Act::FacePiece => "take the photo",
            Act::Retake => "take the photo again",
            Act::RecordPiece => "record the piece",
            Act::RecordRetake => "record the new photo",
            Act::AskOperator => "ask the operator",
            Act::RecordVerdict => "record the verdict",
            Act::NoteReading | Act::HearSensor => "compare with the threshold",
            Act::Acknowledge => "record who acknowledged the alarm, end `alarm`",
            Act::ChooseStrategy => "choose the strategy",
            Act::Archive => "archive the mission",
            Act::RetryBlocked => "try blocked cells again",
            Act::BeginRetrieval => "choose the bag, send the robots",
            Act::EndRetrieval => "forget the retrieval",
        };
        words.to_owned()
    }
}
