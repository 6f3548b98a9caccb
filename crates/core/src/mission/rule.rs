//! The words in which the table is written: what may forbid an input (its guards), what a case depends on, what follows.
//! Here they are only named and explained; `crate::engine` tests the guards and cases and carries out the acts.

use super::{Hold, PhaseName};

/// One line of a cell of the table; the first that applies decides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// Refused if this guard forbids it.
    RefuseIf(Guard),
    /// Refused if this guard forbids it, but these acts are done all the same.
    RefuseIfThen(Guard, &'static [Act]),
    /// In this case: on to a phase, with these acts.
    When(Case, To, &'static [Act]),
    /// Else: on to a phase, with these acts. Always the last line.
    Go(To, &'static [Act]),
    /// Always refused. The last line.
    Never(Guard),
    /// As in the phase that was interrupted, which stays interrupted. The only line.
    AsInterrupted,
}

/// Where a mission goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum To {
    /// It stays where it is.
    Stay,
    /// To another phase.
    Phase(PhaseName),
    /// Back to the phase that was interrupted.
    Interrupted,
}

/// What may forbid an input (its guards); each is a refusal with its reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "each is explained by `Guard::in_words`, which the documentation prints")]
pub enum Guard {
    Held,
    NotInPhase,
    VerdictAwaited,
    VerdictPending,
    OperatorAsked,
    Driving,
    NotStopped,
    IntoObstacle,
    NotCapable,
    Moving,
    Unrecorded,
    BombUnfetched,
    UnknownLuggage,
    Decided,
    NoPhoto,
    NotInspected,
    PhotoUnderWay,
    PhotoHeld,
    StoreDown,
    UnknownAlarm,
    NoRetrievalRobot,
    FaultStands,
    UnknownSensor,
}

impl Guard {
    /// For the documentation: `refused if …`.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Guard::Held => "a hold stands that it does not clear",
            Guard::NotInPhase => "not in this phase",
            Guard::VerdictAwaited => "it would explore while a piece with a usable photo waits for its verdict",
            Guard::VerdictPending => "a verdict is pending",
            Guard::OperatorAsked => "the piece in front of the robot waits for its verdict",
            Guard::Driving => "the robot is driven by hand",
            Guard::NotStopped => "`operator` does not stand",
            Guard::IntoObstacle => "the way leads into a known obstacle",
            Guard::NotCapable => "the robot cannot do that",
            Guard::Moving => "the robot is not stationary",
            Guard::Unrecorded => "a piece is being recorded",
            Guard::BombUnfetched => "a bomb is unfetched and its alarm not acknowledged",
            Guard::UnknownLuggage => "there is no such piece",
            Guard::Decided => "another verdict stands",
            Guard::NoPhoto => "there is no usable photo",
            Guard::NotInspected => "it is not the undecided piece in front of the robot",
            Guard::PhotoUnderWay => "the photo is being taken",
            Guard::PhotoHeld => "`robotLink` or `store` stands",
            Guard::StoreDown => "`store` stands",
            Guard::UnknownAlarm => "there is no such alarm",
            Guard::NoRetrievalRobot => "no retrieval robot is there",
            Guard::FaultStands => "the cause of the fault still stands",
            Guard::UnknownSensor => "no such sensor is configured",
        }
    }
}

/// What a line of the table may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "each is explained by `Case::in_words`, which the documentation prints")]
pub enum Case {
    ToBeInspected,
    BackedUp,
    FirstPhoto,
    ThisPiece,
    SameVerdict,
    FromIdle,
    RobotAtHome,
}

impl Case {
    /// For the documentation: `when …`.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Case::ToBeInspected => "the obstacle is still to be inspected",
            Case::BackedUp => "the robot has backed up",
            Case::FirstPhoto => "there is no record yet",
            Case::ThisPiece => "it is the piece in front of the robot",
            Case::SameVerdict => "the same verdict stands already",
            Case::FromIdle => "idle was interrupted",
            Case::RobotAtHome => "the robot stands at home",
        }
    }
}

/// What is done; each is one small deed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Act {
    /// Clear `operator`, `restart`, `awaitingStart`.
    Release,
    /// A new mission; the LED blinks.
    Begin,
    /// Forget the map and the last mission's luggage; home is where the robot stands.
    EmptyMap,
    /// Halt, raise the epoch, raise `operator`.
    Stop,
    /// Halt, raise this hold.
    Raise(Hold),
    /// Clear this hold.
    Clear(Hold),
    /// The LED ends blinking.
    LedOff,
    /// Alarm the console: a piece is dangerous. Ends the hold `alarm` if it stood for this.
    AlarmDanger,
    /// Alarm the console, and raise `alarm`: a danger was said but could not be recorded.
    AlarmUnrecorded,
    /// Turn to the photo of the piece.
    FacePiece,
    /// Take the photo once more.
    Retake,
    /// Put the piece on record.
    RecordPiece,
    /// Put the new photo on record.
    RecordRetake,
    /// Ask the operator.
    AskOperator,
    /// Put the verdict on record.
    RecordVerdict,
    /// Compare the reading with the threshold.
    NoteReading,
    /// The same, and the sensor is not silent.
    HearSensor,
    /// Note who has seen the alarm. Ends the hold `alarm` if it stood for this.
    Acknowledge,
    /// Search by this strategy from the next mission on.
    ChooseStrategy,
    /// Put the mission away.
    Archive,
    /// Try again the cells that were found blocked after they had been free.
    RetryBlocked,
}

impl Act {
    /// For the documentation.
    #[must_use]
    pub fn in_words(self) -> String {
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
            Act::Acknowledge => "note who has seen it, end `alarm`",
            Act::ChooseStrategy => "choose it",
            Act::Archive => "archive the mission",
            Act::RetryBlocked => "try blocked cells again",
        };
        words.to_owned()
    }
}
