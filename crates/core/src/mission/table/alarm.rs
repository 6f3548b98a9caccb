//! The table's cells once danger was given, and in fault. The search itself stands in `search`.

use super::everywhere::{PhaseEvent, PhaseInput};
use super::shared::{
    ANOTHER_DANGER, CHOOSE, DANGER_AT_HOME, DRIVE_IF_STOPPED, EXPLORE_AGAIN, NOT_HERE, NOTHING, RESUME, RETAKE_ELSEWHERE,
    going_home, waiting,
};
use crate::mission::PhaseName;
use crate::mission::rule::Act::{Release, RetryBlocked};
use crate::mission::rule::Rule::{AsInterrupted, Go, Never, RefuseIf};
use crate::mission::rule::To::{Interrupted, Phase};
use crate::mission::rule::{Guard, Rule};

pub(super) const fn returning_with_alarm(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => RESUME,
        PhaseInput::BackHome | PhaseInput::Retrieve | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE_IF_STOPPED,
        PhaseInput::Event(event) => going_home(event, &[Go(Phase(PhaseName::BombLocated), &[])], ANOTHER_DANGER),
    }
}

pub(super) const fn bomb_located(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start | PhaseInput::BackHome | PhaseInput::Move | PhaseInput::Goto | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Retrieve => &[RefuseIf(Guard::Held), Never(Guard::NoRetrievalRobot)],
        PhaseInput::Event(event) => waiting(event, ANOTHER_DANGER),
    }
}

pub(super) const fn retrieving(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => RESUME,
        PhaseInput::BackHome | PhaseInput::Retrieve | PhaseInput::Move | PhaseInput::Goto | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Event(event) => waiting(event, ANOTHER_DANGER),
    }
}

pub(super) const fn bag_secured(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => EXPLORE_AGAIN,
        PhaseInput::BackHome | PhaseInput::Retrieve | PhaseInput::Move | PhaseInput::Goto => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Strategy => CHOOSE,
        PhaseInput::Event(event) => waiting(event, DANGER_AT_HOME),
    }
}

pub(super) const fn fault(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => &[
            RefuseIf(Guard::Held),
            RefuseIf(Guard::FaultStands),
            RefuseIf(Guard::VerdictAwaited),
            Go(Interrupted, &[Release, RetryBlocked]),
        ],
        PhaseInput::BackHome | PhaseInput::Retrieve | PhaseInput::Move | PhaseInput::Goto | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Event(event) => match event {
            PhaseEvent::Done
            | PhaseEvent::Blocked
            | PhaseEvent::AtPiece
            | PhaseEvent::CameHome
            | PhaseEvent::AllExplored
            | PhaseEvent::DriveEnded
            | PhaseEvent::NoWayHome
            | PhaseEvent::Unanswered
            | PhaseEvent::RobotFailed => NOTHING,
            PhaseEvent::PhotoTaken
            | PhaseEvent::PhotoFailed
            | PhaseEvent::LuggageRecorded
            | PhaseEvent::SafeRecorded
            | PhaseEvent::DangerRecorded => &[AsInterrupted],
        },
    }
}
