//! Cells that several phases share, by name. Which phase has which stands in `search` and `alarm`.

use crate::mission::rule::Act::{
    Acknowledge, AlarmDanger, AlarmUnrecorded, Archive, AskOperator, Begin, ChooseStrategy, Clear, EmptyMap, HearSensor, LedOff,
    NoteReading, Raise, RecordVerdict, Release, Stop,
};
use crate::mission::rule::Rule::{Go, Never, RefuseIf, RefuseIfThen, When};
use crate::mission::rule::To::{Phase, Stay};
use crate::mission::rule::{Case, Guard, Rule};
use crate::mission::{Hold, PhaseName};

pub(super) const NOTHING: &[Rule] = &[Go(Stay, &[])];
pub(super) const NOT_HERE: &[Rule] = &[Never(Guard::NotInPhase)];
/// A piece that does not exist is unknown everywhere.
pub(super) const RETAKE_ELSEWHERE: &[Rule] = &[RefuseIf(Guard::UnknownLuggage), Never(Guard::NotInPhase)];
pub(super) const STOP: &[Rule] = &[Go(Stay, &[Stop])];
pub(super) const RESUME: &[Rule] = &[RefuseIf(Guard::Held), Go(Stay, &[Release])];
pub(super) const EXPLORE_ON: &[Rule] = &[RefuseIf(Guard::Held), RefuseIf(Guard::VerdictAwaited), Go(Stay, &[Release])];
pub(super) const EXPLORE_AGAIN: &[Rule] = &[
    RefuseIf(Guard::Held),
    RefuseIf(Guard::VerdictPending),
    RefuseIf(Guard::BombUnfetched),
    Go(Phase(PhaseName::Exploring), &[Archive, Release, EmptyMap, Begin]),
];
pub(super) const GO_HOME: &[Rule] = &[RefuseIf(Guard::Held), Go(Phase(PhaseName::ReturningHome), &[Release])];
pub(super) const SAFE: &[Rule] = &[
    RefuseIf(Guard::UnknownLuggage),
    When(Case::SameVerdict, Stay, &[]),
    RefuseIf(Guard::Decided),
    RefuseIf(Guard::StoreDown),
    RefuseIf(Guard::NoPhoto),
    Go(Stay, &[RecordVerdict]),
];
pub(super) const DANGER: &[Rule] = &[
    RefuseIf(Guard::UnknownLuggage),
    When(Case::SameVerdict, Stay, &[]),
    RefuseIf(Guard::Decided),
    RefuseIfThen(Guard::StoreDown, &[AlarmUnrecorded]),
    Go(Stay, &[RecordVerdict]),
];
pub(super) const BUTTON_OK: &[Rule] = &[RefuseIf(Guard::StoreDown), Go(Stay, &[Clear(Hold::TooHigh)])];
/// What makes it safer is done although it cannot be put on record; its sender is told that it is not.
pub(super) const BUTTON_TOO_HIGH: &[Rule] =
    &[RefuseIfThen(Guard::StoreDown, &[Raise(Hold::TooHigh)]), Go(Stay, &[Raise(Hold::TooHigh)])];
pub(super) const READING: &[Rule] = &[RefuseIfThen(Guard::StoreDown, &[NoteReading]), Go(Stay, &[NoteReading])];
pub(super) const SENSOR_READING: &[Rule] = &[RefuseIf(Guard::UnknownSensor), Go(Stay, &[HearSensor])];
pub(super) const RESET: &[Rule] = &[
    RefuseIf(Guard::Moving),
    RefuseIf(Guard::Unrecorded),
    RefuseIf(Guard::VerdictPending),
    RefuseIf(Guard::BombUnfetched),
    RefuseIf(Guard::StoreDown),
    When(Case::RobotAtHome, Phase(PhaseName::Idle), &[Archive, LedOff, Release, EmptyMap]),
    Go(Phase(PhaseName::Idle), &[Archive, LedOff, Release]),
];
pub(super) const DRIVE: &[Rule] = &[
    RefuseIf(Guard::Held),
    RefuseIf(Guard::NotCapable),
    RefuseIf(Guard::IntoObstacle),
    Go(Phase(PhaseName::Driving), &[Release]),
];
pub(super) const DRIVE_IF_STOPPED: &[Rule] = &[
    RefuseIf(Guard::Held),
    RefuseIf(Guard::NotStopped),
    RefuseIf(Guard::NotCapable),
    RefuseIf(Guard::IntoObstacle),
    Go(Phase(PhaseName::Driving), &[Release]),
];
pub(super) const ACKNOWLEDGE: &[Rule] = &[RefuseIf(Guard::UnknownAlarm), RefuseIf(Guard::StoreDown), Go(Stay, &[Acknowledge])];
pub(super) const CHOOSE: &[Rule] = &[RefuseIf(Guard::StoreDown), Go(Stay, &[ChooseStrategy])];
pub(super) const RECORDED: &[Rule] = &[Go(Stay, &[AskOperator])];
pub(super) const ANOTHER_DANGER: &[Rule] = &[Go(Stay, &[LedOff, AlarmDanger])];
pub(super) const DANGER_ON_THE_WAY: &[Rule] = &[Go(Phase(PhaseName::ReturningWithAlarm), &[LedOff, AlarmDanger])];
/// Home already: the bomb is located. Not quite home, or not at rest there: on the way home with an alarm.
pub(super) const DANGER_AT_HOME: &[Rule] = &[
    When(Case::RobotAtHome, Phase(PhaseName::BombLocated), &[LedOff, AlarmDanger]),
    Go(Phase(PhaseName::ReturningWithAlarm), &[LedOff, AlarmDanger]),
];
pub(super) const INTO_FAULT: &[Rule] = &[Go(Phase(PhaseName::Fault), &[])];
pub(super) const LINK_LOST: &[Rule] = &[Go(Stay, &[Raise(Hold::RobotLink)])];
pub(super) const LINK_UP: &[Rule] = &[Go(Stay, &[Clear(Hold::RobotLink)])];
pub(super) const HEAT: &[Rule] = &[Go(Stay, &[Raise(Hold::Temperature)])];
pub(super) const COOL: &[Rule] = &[Go(Stay, &[Clear(Hold::Temperature)])];
pub(super) const SENSOR_SILENT: &[Rule] = &[Go(Stay, &[Raise(Hold::TemperatureStale)])];
pub(super) const SENSOR_BACK: &[Rule] = &[Go(Stay, &[Clear(Hold::TemperatureStale)])];
pub(super) const STORE_FAILED: &[Rule] = &[Go(Stay, &[Raise(Hold::Store)])];
pub(super) const RESTARTED: &[Rule] = &[Go(Stay, &[Raise(Hold::Restart)])];
pub(super) const STORE_RESTORED: &[Rule] = &[Go(Stay, &[Clear(Hold::Store)])];
