//! The table's cells once danger was given, and in fault. The search itself stands in `search`.

use super::everywhere::PhaseInput;
use super::shared::{
    ANOTHER_DANGER, CHOOSE, DANGER_AT_HOME, DRIVE_IF_STOPPED, EXPLORE_AGAIN, INTO_FAULT, NOT_HERE, NOTHING, RECORDED, RESUME,
    RETAKE_ELSEWHERE,
};
use crate::mission::PhaseName;
use crate::mission::rule::Act::{Release, RetryBlocked};
use crate::mission::rule::Rule::{AsInterrupted, Go, Never, RefuseIf};
use crate::mission::rule::To::{Interrupted, Phase};
use crate::mission::rule::{Guard, Rule};

/// On the way home after danger.
pub(super) const fn returning_with_alarm(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => RESUME,
        PhaseInput::BackHome | PhaseInput::Retrieve | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE_IF_STOPPED,
        PhaseInput::Done
        | PhaseInput::Blocked
        | PhaseInput::AtPiece
        | PhaseInput::PhotoTaken
        | PhaseInput::PhotoFailed
        | PhaseInput::SafeRecorded
        | PhaseInput::AllExplored
        | PhaseInput::DriveEnded => NOTHING,
        PhaseInput::LuggageRecorded => RECORDED,
        PhaseInput::DangerRecorded => ANOTHER_DANGER,
        PhaseInput::CameHome => &[Go(Phase(PhaseName::BombLocated), &[])],
        PhaseInput::NoWayHome | PhaseInput::Unanswered | PhaseInput::RobotFailed => INTO_FAULT,
    }
}

/// Home, and a bomb is in the hall.
pub(super) const fn bomb_located(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start | PhaseInput::BackHome | PhaseInput::Move | PhaseInput::Goto | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Retrieve => &[RefuseIf(Guard::Held), Never(Guard::NoRetrievalRobot)],
        PhaseInput::Done
        | PhaseInput::Blocked
        | PhaseInput::AtPiece
        | PhaseInput::PhotoTaken
        | PhaseInput::PhotoFailed
        | PhaseInput::SafeRecorded
        | PhaseInput::CameHome
        | PhaseInput::AllExplored
        | PhaseInput::DriveEnded
        | PhaseInput::NoWayHome => NOTHING,
        PhaseInput::LuggageRecorded => RECORDED,
        PhaseInput::DangerRecorded => ANOTHER_DANGER,
        PhaseInput::Unanswered | PhaseInput::RobotFailed => INTO_FAULT,
    }
}

/// The bomb is being fetched.
pub(super) const fn retrieving(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => RESUME,
        PhaseInput::BackHome | PhaseInput::Retrieve | PhaseInput::Move | PhaseInput::Goto | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Done
        | PhaseInput::Blocked
        | PhaseInput::AtPiece
        | PhaseInput::PhotoTaken
        | PhaseInput::PhotoFailed
        | PhaseInput::SafeRecorded
        | PhaseInput::CameHome
        | PhaseInput::AllExplored
        | PhaseInput::DriveEnded
        | PhaseInput::NoWayHome => NOTHING,
        PhaseInput::LuggageRecorded => RECORDED,
        PhaseInput::DangerRecorded => ANOTHER_DANGER,
        PhaseInput::Unanswered | PhaseInput::RobotFailed => INTO_FAULT,
    }
}

/// The bomb is in the container.
pub(super) const fn bag_secured(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => EXPLORE_AGAIN,
        PhaseInput::BackHome | PhaseInput::Retrieve | PhaseInput::Move | PhaseInput::Goto => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Strategy => CHOOSE,
        PhaseInput::Done
        | PhaseInput::Blocked
        | PhaseInput::AtPiece
        | PhaseInput::PhotoTaken
        | PhaseInput::PhotoFailed
        | PhaseInput::SafeRecorded
        | PhaseInput::CameHome
        | PhaseInput::AllExplored
        | PhaseInput::DriveEnded
        | PhaseInput::NoWayHome => NOTHING,
        PhaseInput::LuggageRecorded => RECORDED,
        PhaseInput::DangerRecorded => DANGER_AT_HOME,
        PhaseInput::Unanswered | PhaseInput::RobotFailed => INTO_FAULT,
    }
}

/// Something went wrong.
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
        PhaseInput::Done
        | PhaseInput::Blocked
        | PhaseInput::AtPiece
        | PhaseInput::CameHome
        | PhaseInput::AllExplored
        | PhaseInput::DriveEnded
        | PhaseInput::NoWayHome
        | PhaseInput::Unanswered
        | PhaseInput::RobotFailed => NOTHING,
        PhaseInput::PhotoTaken
        | PhaseInput::PhotoFailed
        | PhaseInput::LuggageRecorded
        | PhaseInput::SafeRecorded
        | PhaseInput::DangerRecorded => &[AsInterrupted],
    }
}
