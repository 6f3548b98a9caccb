//! Named cells of the table that several phases share. `search` and `alarm` assign them to phases. `everywhere` has
//! the cells that all phases share.

use super::everywhere::PhaseEvent;
use crate::mission::rule::Act::{
    AlarmDanger, Archive, AskOperator, Begin, ChooseStrategy, Close, EmptyMap, EndSearch, LedOff, LedOn, Release, SearchAgain,
};
use crate::mission::rule::Rule::{Go, Never, RefuseIf, When};
use crate::mission::rule::To::{Phase, Stay};
use crate::mission::rule::{Case, Guard, Rule};
use crate::phase::PhaseName;

pub(super) const NOTHING: &[Rule] = &[Go(Stay, &[])];
pub(super) const NOT_HERE: &[Rule] = &[Never(Guard::NotInPhase)];
/// A piece that does not exist is refused as unknown in every phase.
pub(super) const RETAKE_ELSEWHERE: &[Rule] = &[RefuseIf(Guard::UnknownLuggage), Never(Guard::NotInPhase)];
pub(super) const RESUME: &[Rule] = &[RefuseIf(Guard::Held), Go(Stay, &[Release])];
pub(super) const EXPLORE_ON: &[Rule] = &[RefuseIf(Guard::Held), RefuseIf(Guard::VerdictAwaited), Go(Stay, &[Release])];
/// Searches on from home. Under `mission.after_danger = "go_on"` the LED blinks already.
pub(super) const SEARCH_ON: &[Rule] =
    &[RefuseIf(Guard::Held), RefuseIf(Guard::VerdictAwaited), Go(Phase(PhaseName::Exploring), &[Release, LedOn])];
pub(super) const SEARCH_AGAIN: &[Rule] = &[
    RefuseIf(Guard::Held),
    RefuseIf(Guard::VerdictAwaited),
    RefuseIf(Guard::AreaUnfit),
    Go(Phase(PhaseName::Exploring), &[Release, LedOn, SearchAgain]),
];
pub(super) const EXPLORE_AGAIN: &[Rule] = &[
    RefuseIf(Guard::Held),
    RefuseIf(Guard::VerdictPending),
    RefuseIf(Guard::BombUnfetched),
    RefuseIf(Guard::ExerciseOver),
    Go(Phase(PhaseName::Exploring), &[Archive, Release, EmptyMap, Begin]),
];
pub(super) const GO_HOME: &[Rule] = &[RefuseIf(Guard::Held), Go(Phase(PhaseName::ReturningHome), &[Release])];
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
pub(super) const CLOSE: &[Rule] = &[RefuseIf(Guard::OpenUnseen), RefuseIf(Guard::StoreDown), Go(Stay, &[Close])];
pub(super) const CHOOSE: &[Rule] = &[RefuseIf(Guard::StoreDown), Go(Stay, &[ChooseStrategy])];
pub(super) const RECORDED: &[Rule] = &[Go(Stay, &[AskOperator])];
pub(super) const ANOTHER_DANGER: &[Rule] = &[Go(Stay, &[EndSearch, AlarmDanger])];
pub(super) const DANGER_ON_THE_WAY: &[Rule] =
    &[When(Case::GoesOn, Stay, &[AlarmDanger]), Go(Phase(PhaseName::ReturningWithAlarm), &[LedOff, AlarmDanger])];
pub(super) const DANGER_AT_HOME: &[Rule] = &[
    When(Case::RobotAtHome, Phase(PhaseName::BombLocated), &[EndSearch, AlarmDanger]),
    Go(Phase(PhaseName::ReturningWithAlarm), &[EndSearch, AlarmDanger]),
];
pub(super) const INTO_FAULT: &[Rule] = &[Go(Phase(PhaseName::Fault), &[])];

/// The rules for events while the robot that searches has nothing to do.
pub(super) const fn waiting(event: PhaseEvent, danger: &'static [Rule]) -> &'static [Rule] {
    match event {
        PhaseEvent::Done
        | PhaseEvent::Blocked
        | PhaseEvent::AtPiece
        | PhaseEvent::PhotoTaken
        | PhaseEvent::PhotoFailed
        | PhaseEvent::SafeRecorded
        | PhaseEvent::CameHome
        | PhaseEvent::AllExplored
        | PhaseEvent::DriveEnded
        | PhaseEvent::Secured
        | PhaseEvent::NotFetched
        | PhaseEvent::NoWayHome => NOTHING,
        PhaseEvent::LuggageRecorded => RECORDED,
        PhaseEvent::DangerRecorded => danger,
        PhaseEvent::Unanswered | PhaseEvent::RobotFailed => INTO_FAULT,
    }
}

pub(super) const fn going_home(event: PhaseEvent, arrival: &'static [Rule], danger: &'static [Rule]) -> &'static [Rule] {
    match event {
        PhaseEvent::CameHome => arrival,
        PhaseEvent::NoWayHome => INTO_FAULT,
        PhaseEvent::Done
        | PhaseEvent::Blocked
        | PhaseEvent::AtPiece
        | PhaseEvent::PhotoTaken
        | PhaseEvent::PhotoFailed
        | PhaseEvent::LuggageRecorded
        | PhaseEvent::SafeRecorded
        | PhaseEvent::DangerRecorded
        | PhaseEvent::AllExplored
        | PhaseEvent::DriveEnded
        | PhaseEvent::Secured
        | PhaseEvent::NotFetched
        | PhaseEvent::Unanswered
        | PhaseEvent::RobotFailed => waiting(event, danger),
    }
}
