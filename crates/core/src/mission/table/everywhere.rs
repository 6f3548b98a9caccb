//! The inputs that have the same rules in every phase, with these rules. The other inputs are named here too;
//! `search` and `alarm` define them for each phase.

use crate::hold::Hold;
use crate::mission::Input;
use crate::mission::rule::Act::{
    Acknowledge, AlarmUnrecorded, Archive, Clear, CloseArea, EmptyMap, EndRetrieval, HandOver, HearSensor, KeepBack, LedOff,
    NoteReading, OrderAreas, Raise, RecordUnsure, RecordVerdict, Release, Stop,
};
use crate::mission::rule::Rule::{Go, RefuseIf, RefuseIfThen, When};
use crate::mission::rule::To::{Interrupted, Phase, Stay};
use crate::mission::rule::{Case, Guard, Rule};
use crate::phase::PhaseName;

#[derive(Clone, Copy, Debug)]
pub(in crate::mission) enum InputRow {
    Everywhere(&'static [Rule]),
    /// Inputs that halt the robot. They have the same rules in every phase, but they also end a drive by hand.
    Halting {
        elsewhere: &'static [Rule],
        driving: &'static [Rule],
    },
    ByPhase(PhaseInput),
}

/// The inputs whose rules depend on the phase. Each phase must define all of them, one by one.
#[derive(Clone, Copy, Debug)]
pub(in crate::mission) enum PhaseInput {
    Start,
    BackHome,
    GoOn,
    Retrieve,
    Move,
    Goto,
    RetakePhoto,
    Strategy,
    Close,
    SearchAgain,
    Event(PhaseEvent),
}

#[derive(Clone, Copy, Debug)]
pub(in crate::mission) enum PhaseEvent {
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
    Secured,
    NotFetched,
    NoWayHome,
    Unanswered,
    RobotFailed,
}

const SAFE: &[Rule] = &[
    RefuseIf(Guard::UnknownLuggage),
    When(Case::SameVerdict, Stay, &[]),
    RefuseIf(Guard::Decided),
    RefuseIf(Guard::NoKey),
    RefuseIf(Guard::StoreDown),
    RefuseIf(Guard::NoPhoto),
    RefuseIf(Guard::HotUnanswered),
    When(Case::FirstJudge, Stay, &[KeepBack]),
    Go(Stay, &[RecordVerdict]),
];
const DANGER: &[Rule] = &[
    RefuseIf(Guard::UnknownLuggage),
    When(Case::SameVerdict, Stay, &[]),
    RefuseIf(Guard::Decided),
    RefuseIfThen(Guard::StoreDown, &[AlarmUnrecorded]),
    Go(Stay, &[RecordVerdict]),
];
const UNSURE: &[Rule] = &[
    RefuseIf(Guard::UnknownLuggage),
    RefuseIf(Guard::Decided),
    RefuseIf(Guard::NoKey),
    RefuseIf(Guard::NotInspected),
    RefuseIf(Guard::StoreDown),
    Go(Stay, &[RecordUnsure]),
];
const RESET: &[Rule] = &[
    RefuseIf(Guard::Moving),
    RefuseIf(Guard::Unrecorded),
    RefuseIf(Guard::VerdictPending),
    RefuseIf(Guard::BombUnfetched),
    RefuseIf(Guard::FetcherAbroad),
    RefuseIf(Guard::StoreDown),
    When(Case::RobotAtHome, Phase(PhaseName::Idle), &[Archive, EndRetrieval, LedOff, Release, EmptyMap]),
    Go(Phase(PhaseName::Idle), &[Archive, EndRetrieval, LedOff, Release]),
];
/// TOO HIGH and readings make the hall safer, so they take effect even if they cannot be recorded. The sender is told
/// that they are not recorded.
const BUTTON_TOO_HIGH: &[Rule] = &[RefuseIfThen(Guard::StoreDown, &[Raise(Hold::TooHigh)]), Go(Stay, &[Raise(Hold::TooHigh)])];
const READING: &[Rule] = &[RefuseIfThen(Guard::StoreDown, &[NoteReading]), Go(Stay, &[NoteReading])];
const HAND_OVER: &[Rule] = &[RefuseIf(Guard::NoMission), RefuseIf(Guard::StoreDown), Go(Stay, &[HandOver])];
/// Also in idle: the order holds for the next mission.
const ORDER_AREAS: &[Rule] = &[RefuseIf(Guard::UnknownArea), RefuseIf(Guard::StoreDown), Go(Stay, &[OrderAreas])];
const CLOSE_AREA: &[Rule] = &[
    RefuseIf(Guard::NoMission),
    RefuseIf(Guard::UnknownArea),
    RefuseIf(Guard::AreaClosed),
    RefuseIf(Guard::StoreDown),
    Go(Stay, &[CloseArea]),
];
const ACKNOWLEDGE: &[Rule] = &[RefuseIf(Guard::UnknownAlarm), RefuseIf(Guard::StoreDown), Go(Stay, &[Acknowledge])];

/// The rules of an input that raises a hold. If the input ends a drive by hand during a mission, the hold `operator`
/// is raised as well.
macro_rules! raised {
    ($hold:expr) => {
        raised!($hold, &[Go(Stay, &[Raise($hold)])])
    };
    ($hold:expr, $elsewhere:expr) => {
        InputRow::Halting {
            elsewhere: $elsewhere,
            driving: &[
                When(Case::FromIdle, Interrupted, &[Raise($hold)]),
                Go(Interrupted, &[Raise(Hold::Operator), Raise($hold)]),
            ],
        }
    };
}

pub(in crate::mission) const fn row(input: Input) -> InputRow {
    use InputRow::{ByPhase, Everywhere, Halting};
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
        Input::Unsure => Everywhere(UNSURE),
        Input::TemperatureOk => Everywhere(&[RefuseIf(Guard::StoreDown), Go(Stay, &[Clear(Hold::TooHigh)])]),
        Input::Reading => Everywhere(READING),
        Input::SensorReading => Everywhere(&[RefuseIf(Guard::UnknownSensor), Go(Stay, &[HearSensor])]),
        Input::Reset => Everywhere(RESET),
        Input::HandOver => Everywhere(HAND_OVER),
        Input::OrderAreas => Everywhere(ORDER_AREAS),
        Input::CloseArea => Everywhere(CLOSE_AREA),
        Input::Acknowledge => Everywhere(ACKNOWLEDGE),
        Input::LinkUp => Everywhere(&[Go(Stay, &[Clear(Hold::RobotLink)])]),
        Input::Cool => Everywhere(&[Go(Stay, &[Clear(Hold::Temperature)])]),
        Input::SensorBack => Everywhere(&[Go(Stay, &[Clear(Hold::TemperatureStale)])]),
        Input::StoreRestored => Everywhere(&[Go(Stay, &[Clear(Hold::Store)])]),
        Input::Start => ByPhase(PhaseInput::Start),
        Input::BackHome => ByPhase(PhaseInput::BackHome),
        Input::GoOn => ByPhase(PhaseInput::GoOn),
        Input::Retrieve => ByPhase(PhaseInput::Retrieve),
        Input::Move => ByPhase(PhaseInput::Move),
        Input::Goto => ByPhase(PhaseInput::Goto),
        Input::RetakePhoto => ByPhase(PhaseInput::RetakePhoto),
        Input::Strategy => ByPhase(PhaseInput::Strategy),
        Input::Close => ByPhase(PhaseInput::Close),
        Input::SearchAgain => ByPhase(PhaseInput::SearchAgain),
        Input::Done => event(PhaseEvent::Done),
        Input::Blocked => event(PhaseEvent::Blocked),
        Input::AtPiece => event(PhaseEvent::AtPiece),
        Input::PhotoTaken => event(PhaseEvent::PhotoTaken),
        Input::PhotoFailed => event(PhaseEvent::PhotoFailed),
        Input::LuggageRecorded => event(PhaseEvent::LuggageRecorded),
        Input::SafeRecorded => event(PhaseEvent::SafeRecorded),
        Input::DangerRecorded => event(PhaseEvent::DangerRecorded),
        Input::CameHome => event(PhaseEvent::CameHome),
        Input::AllExplored => event(PhaseEvent::AllExplored),
        Input::DriveEnded => event(PhaseEvent::DriveEnded),
        Input::Secured => event(PhaseEvent::Secured),
        Input::NotFetched => event(PhaseEvent::NotFetched),
        Input::NoWayHome => event(PhaseEvent::NoWayHome),
        Input::Unanswered => event(PhaseEvent::Unanswered),
        Input::RobotFailed => event(PhaseEvent::RobotFailed),
    }
}

const fn event(event: PhaseEvent) -> InputRow {
    InputRow::ByPhase(PhaseInput::Event(event))
}
