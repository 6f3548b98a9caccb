//! The elements of the transition table: guards that may forbid an input, cases, and outcomes. This module only
//! names and explains them. `crate::engine` tests the guards and cases and carries out the acts.

use crate::hold::Hold;
use crate::phase::PhaseName;

/// One rule in a cell of the table. The first rule that applies decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Rule {
    RefuseIf(Guard),
    /// If this guard forbids the input, the input is refused. These acts are carried out in spite of the refusal.
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
        Held = "there is a hold that this command does not clear",
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
        NotABomb = "the named piece is not a bomb in the hall",
        Decided = "the piece has the other verdict already",
        NoKey = "`mission.safe_by` is 2, and the command came over CoAP, which has no keys",
        NoPhoto = "there is no usable photo",
        HotUnanswered = "`mission.hot` is `required`, and one of the three questions is not answered",
        NotInspected = "the piece already has a verdict or is not in front of the robot",
        PhotoUnderWay = "the photo is being taken",
        PhotoHeld = "`robotLink` or `store` is raised",
        StoreDown = "`store` is raised",
        UnknownAlarm = "there is no such alarm",
        NoRetrievalRobot = "there is no retrieval robot",
        FetcherUnreached = "a retrieval robot cannot be reached",
        FetcherAbroad = "a robot of an unfinished retrieval is not back at its place",
        NoMission = "no mission is under way, or the command names another one",
        ExerciseOver = "a mission has begun with the test pieces of this exercise already",
        OpenUnseen = "no mission is under way, or the command does not name its open points",
        AreaUnfit = "the area is unknown, or has no searched cell, or too many",
        UnknownArea = "the hall has no area of this name",
        AreaClosed = "the area is closed already",
        FaultStands = "the cause of the fault is still present",
        UnknownSensor = "no such sensor is configured",
    }
}

named! {
    by in_words;
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum Case {
        ToBeInspected = "the obstacle is not inspected yet",
        BackedUp = "the robot has moved back from the obstacle",
        FirstPhoto = "the piece has no record yet",
        ThisPiece = "the piece is in front of the robot",
        SameVerdict = "the piece has this verdict already, and the command names no other size",
        FirstJudge = "`mission.safe_by` is 2, and no other judge has said *safe*",
        FromIdle = "the interrupted phase is idle",
        RobotAtHome = "the robot is at home",
        KeptOutLeft = "places inside keep-out rings are not searched",
        BombLeft = "a bomb is still in the hall",
        GoesOn = "`mission.after_danger` is `go_on`",
        GoesOnFromHere = "`mission.after_danger` is `go_on`, and the piece is in front of the robot",
        SearchUnderWay = "the LED blinks, because the search goes on after a find",
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
    LedOn,
    EndSearch,
    AlarmDanger,
    AlarmUnrecorded,
    FacePiece,
    Retake,
    RecordPiece,
    RecordRetake,
    AskOperator,
    RecordUnsure,
    RecordVerdict,
    KeepBack,
    NoteReading,
    HearSensor,
    Acknowledge,
    ChooseStrategy,
    Archive,
    Close,
    HandOver,
    SearchAgain,
    OrderAreas,
    CloseArea,
    RetryBlocked,
    BeginRetrieval,
    EndRetrieval,
}

impl Act {
    pub(crate) fn in_words(self) -> String {
        let words = match self {
            Act::Release => "clears `operator`, `restart`, `awaitingStart`",
            Act::Begin => "begins a mission, lets the LED blink",
            Act::EmptyMap => "empties the map",
            Act::Stop => "halts, increases the epoch, raises `operator`",
            Act::Raise(hold) => return format!("halts, raises `{}`", hold.name()),
            Act::Clear(hold) => return format!("clears `{}`", hold.name()),
            Act::LedOff => "turns the LED off",
            Act::EndSearch => "turns the LED off, unless `mission.after_danger` is `go_on`",
            Act::LedOn => "lets the LED blink",
            Act::AlarmDanger => "raises an alarm, clears `alarm` if no other alarm needs it",
            Act::AlarmUnrecorded => "raises an alarm and the hold `alarm`",
            Act::FacePiece => "takes the photo",
            Act::Retake => "takes the photo again",
            Act::RecordPiece => "records the piece",
            Act::RecordRetake => "records the new photo",
            Act::AskOperator => "asks the operator for the verdict",
            Act::RecordUnsure => "records that the sender is unsure, takes photos from other sides",
            Act::RecordVerdict => "records the verdict",
            Act::KeepBack => "keeps the answer back until another judge has answered",
            Act::NoteReading | Act::HearSensor => "compares the reading with the threshold",
            Act::Acknowledge => "records who acknowledged the alarm, clears `alarm` if no other alarm needs it",
            Act::ChooseStrategy => "chooses the strategy",
            Act::Archive => "archives the mission",
            Act::Close => "records who closes the mission, and the open points",
            Act::HandOver => "records to whom the mission is handed over",
            Act::SearchAgain => "notes the cells to be visited again, reopens the named area",
            Act::OrderAreas => "records the order of the areas",
            Act::CloseArea => "records who closes the area, and what is open in it",
            Act::RetryBlocked => "tries blocked cells again",
            Act::BeginRetrieval => "chooses the bag, sends the robots",
            Act::EndRetrieval => "ends the retrieval",
        };
        words.to_owned()
    }
}
