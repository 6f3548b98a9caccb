//! The inputs that mean the same in every phase, each with its cell; and which inputs are left to the phases (`search`, `alarm`).

use crate::mission::rule::Act::{
    Acknowledge, AlarmUnrecorded, Archive, Clear, EmptyMap, HearSensor, LedOff, NoteReading, Raise, RecordVerdict, Release, Stop,
};
use crate::mission::rule::Rule::{Go, RefuseIf, RefuseIfThen, When};
use crate::mission::rule::To::{Interrupted, Phase, Stay};
use crate::mission::rule::{Case, Guard, Rule};
use crate::mission::{Hold, Input, PhaseName};

/// The cells of one input.
#[derive(Clone, Copy, Debug)]
pub(in crate::mission) enum Row {
    /// The same in every phase.
    Everywhere(&'static [Rule]),
    /// What halts the robot: the same in every phase, but that a drive by hand ends with it.
    Halting {
        /// In every phase but driving.
        elsewhere: &'static [Rule],
        /// While driving.
        driving: &'static [Rule],
    },
    /// Each phase has its own.
    ByPhase(PhaseInput),
}

/// The inputs whose meaning depends on the phase: the phases match these one by one.
#[derive(Clone, Copy, Debug)]
pub(in crate::mission) enum PhaseInput {
    Start,
    BackHome,
    Retrieve,
    Move,
    Goto,
    RetakePhoto,
    Strategy,
    Done,
    Blocked,
    AtPiece,
    PhotoTaken,
    PhotoFailed,
    LuggageRecorded,
    SafeRecorded,
    DangerRecorded,
    CameHome,
    AllExplored,
    DriveEnded,
    NoWayHome,
    Unanswered,
    RobotFailed,
}

const SAFE: &[Rule] = &[
    RefuseIf(Guard::UnknownLuggage),
    When(Case::SameVerdict, Stay, &[]),
    RefuseIf(Guard::Decided),
    RefuseIf(Guard::StoreDown),
    RefuseIf(Guard::NoPhoto),
    Go(Stay, &[RecordVerdict]),
];
const DANGER: &[Rule] = &[
    RefuseIf(Guard::UnknownLuggage),
    When(Case::SameVerdict, Stay, &[]),
    RefuseIf(Guard::Decided),
    RefuseIfThen(Guard::StoreDown, &[AlarmUnrecorded]),
    Go(Stay, &[RecordVerdict]),
];
const RESET: &[Rule] = &[
    RefuseIf(Guard::Moving),
    RefuseIf(Guard::Unrecorded),
    RefuseIf(Guard::VerdictPending),
    RefuseIf(Guard::BombUnfetched),
    RefuseIf(Guard::StoreDown),
    When(Case::RobotAtHome, Phase(PhaseName::Idle), &[Archive, LedOff, Release, EmptyMap]),
    Go(Phase(PhaseName::Idle), &[Archive, LedOff, Release]),
];
/// What makes it safer is done although it cannot be put on record; its sender is told that it is not.
const BUTTON_TOO_HIGH: &[Rule] = &[RefuseIfThen(Guard::StoreDown, &[Raise(Hold::TooHigh)]), Go(Stay, &[Raise(Hold::TooHigh)])];
const READING: &[Rule] = &[RefuseIfThen(Guard::StoreDown, &[NoteReading]), Go(Stay, &[NoteReading])];
const ACKNOWLEDGE: &[Rule] = &[RefuseIf(Guard::UnknownAlarm), RefuseIf(Guard::StoreDown), Go(Stay, &[Acknowledge])];

/// A hold is raised; one that ends the drive of a mission leaves it stopped by the operator as well.
macro_rules! raised {
    ($hold:expr) => {
        raised!($hold, &[Go(Stay, &[Raise($hold)])])
    };
    ($hold:expr, $elsewhere:expr) => {
        Row::Halting {
            elsewhere: $elsewhere,
            driving: &[
                When(Case::FromIdle, Interrupted, &[Raise($hold)]),
                Go(Interrupted, &[Raise(Hold::Operator), Raise($hold)]),
            ],
        }
    };
}

/// The cells of this input.
pub(in crate::mission) const fn row(input: Input) -> Row {
    use Row::{ByPhase, Everywhere, Halting};
    match input {
        Input::Stop => Halting { elsewhere: &[Go(Stay, &[Stop])], driving: &[Go(Interrupted, &[Stop])] },
        Input::TemperatureTooHigh => raised!(Hold::TooHigh, BUTTON_TOO_HIGH),
        Input::LinkLost => raised!(Hold::RobotLink),
        Input::Heat => raised!(Hold::Temperature),
        Input::SensorSilent => raised!(Hold::TemperatureStale),
        Input::StoreFailed => raised!(Hold::Store),
        Input::Restarted => raised!(Hold::Restart),
        Input::Safe => Everywhere(SAFE),
        Input::Danger => Everywhere(DANGER),
        Input::TemperatureOk => Everywhere(&[RefuseIf(Guard::StoreDown), Go(Stay, &[Clear(Hold::TooHigh)])]),
        Input::Reading => Everywhere(READING),
        Input::SensorReading => Everywhere(&[RefuseIf(Guard::UnknownSensor), Go(Stay, &[HearSensor])]),
        Input::Reset => Everywhere(RESET),
        Input::Acknowledge => Everywhere(ACKNOWLEDGE),
        Input::LinkUp => Everywhere(&[Go(Stay, &[Clear(Hold::RobotLink)])]),
        Input::Cool => Everywhere(&[Go(Stay, &[Clear(Hold::Temperature)])]),
        Input::SensorBack => Everywhere(&[Go(Stay, &[Clear(Hold::TemperatureStale)])]),
        Input::StoreRestored => Everywhere(&[Go(Stay, &[Clear(Hold::Store)])]),
        Input::Start => ByPhase(PhaseInput::Start),
        Input::BackHome => ByPhase(PhaseInput::BackHome),
        Input::Retrieve => ByPhase(PhaseInput::Retrieve),
        Input::Move => ByPhase(PhaseInput::Move),
        Input::Goto => ByPhase(PhaseInput::Goto),
        Input::RetakePhoto => ByPhase(PhaseInput::RetakePhoto),
        Input::Strategy => ByPhase(PhaseInput::Strategy),
        Input::Done => ByPhase(PhaseInput::Done),
        Input::Blocked => ByPhase(PhaseInput::Blocked),
        Input::AtPiece => ByPhase(PhaseInput::AtPiece),
        Input::PhotoTaken => ByPhase(PhaseInput::PhotoTaken),
        Input::PhotoFailed => ByPhase(PhaseInput::PhotoFailed),
        Input::LuggageRecorded => ByPhase(PhaseInput::LuggageRecorded),
        Input::SafeRecorded => ByPhase(PhaseInput::SafeRecorded),
        Input::DangerRecorded => ByPhase(PhaseInput::DangerRecorded),
        Input::CameHome => ByPhase(PhaseInput::CameHome),
        Input::AllExplored => ByPhase(PhaseInput::AllExplored),
        Input::DriveEnded => ByPhase(PhaseInput::DriveEnded),
        Input::NoWayHome => ByPhase(PhaseInput::NoWayHome),
        Input::Unanswered => ByPhase(PhaseInput::Unanswered),
        Input::RobotFailed => ByPhase(PhaseInput::RobotFailed),
    }
}
