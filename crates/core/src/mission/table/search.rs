//! The table's cells for the search: from idle to explored, the ways home and driving by hand.
//! Danger and fault stand in `alarm`.

use super::everywhere::PhaseInput;
use super::shared::{
    ANOTHER_DANGER, CHOOSE, DANGER_AT_HOME, DANGER_ON_THE_WAY, DRIVE, DRIVE_IF_STOPPED, EXPLORE_AGAIN, EXPLORE_ON, GO_HOME,
    INTO_FAULT, NOT_HERE, NOTHING, RECORDED, RESUME, RETAKE_ELSEWHERE,
};
use crate::mission::rule::Act::{Begin, FacePiece, LedOff, Raise, RecordPiece, RecordRetake, Release, Retake};
use crate::mission::rule::Rule::{AsInterrupted, Go, Never, RefuseIf, When};
use crate::mission::rule::To::{Interrupted, Phase, Stay};
use crate::mission::rule::{Case, Guard, Rule};
use crate::mission::{Hold, PhaseName};

/// No mission.
pub(super) const fn idle(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => &[RefuseIf(Guard::Held), Go(Phase(PhaseName::Exploring), &[Release, Begin])],
        PhaseInput::BackHome | PhaseInput::Retrieve => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE,
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
        PhaseInput::DangerRecorded => ANOTHER_DANGER,
        PhaseInput::Unanswered | PhaseInput::RobotFailed => INTO_FAULT,
    }
}

/// Searching.
pub(super) const fn exploring(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => EXPLORE_ON,
        PhaseInput::BackHome => GO_HOME,
        PhaseInput::Retrieve | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE_IF_STOPPED,
        PhaseInput::Done
        | PhaseInput::PhotoTaken
        | PhaseInput::PhotoFailed
        | PhaseInput::SafeRecorded
        | PhaseInput::CameHome
        | PhaseInput::DriveEnded => NOTHING,
        PhaseInput::Blocked => &[When(Case::ToBeInspected, Phase(PhaseName::Inspecting), &[]), Go(Stay, &[])],
        PhaseInput::AtPiece => &[Go(Phase(PhaseName::Inspecting), &[])],
        PhaseInput::LuggageRecorded => RECORDED,
        PhaseInput::DangerRecorded => DANGER_ON_THE_WAY,
        PhaseInput::AllExplored => &[Go(Phase(PhaseName::Explored), &[LedOff])],
        PhaseInput::NoWayHome | PhaseInput::Unanswered | PhaseInput::RobotFailed => INTO_FAULT,
    }
}

/// At a piece of luggage.
pub(super) const fn inspecting(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => &[RefuseIf(Guard::Held), RefuseIf(Guard::OperatorAsked), Go(Stay, &[Release])],
        PhaseInput::BackHome => GO_HOME,
        PhaseInput::Retrieve | PhaseInput::Move | PhaseInput::Goto | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => {
            &[RefuseIf(Guard::NotInspected), RefuseIf(Guard::PhotoUnderWay), RefuseIf(Guard::PhotoHeld), Go(Stay, &[Retake])]
        }
        PhaseInput::Done => &[When(Case::BackedUp, Stay, &[FacePiece]), Go(Stay, &[])],
        PhaseInput::Blocked
        | PhaseInput::AtPiece
        | PhaseInput::CameHome
        | PhaseInput::AllExplored
        | PhaseInput::DriveEnded
        | PhaseInput::NoWayHome => NOTHING,
        PhaseInput::PhotoTaken | PhaseInput::PhotoFailed => {
            &[When(Case::FirstPhoto, Stay, &[RecordPiece]), Go(Stay, &[RecordRetake])]
        }
        PhaseInput::LuggageRecorded => RECORDED,
        PhaseInput::SafeRecorded => &[When(Case::ThisPiece, Phase(PhaseName::Exploring), &[]), Go(Stay, &[])],
        PhaseInput::DangerRecorded => DANGER_ON_THE_WAY,
        PhaseInput::Unanswered | PhaseInput::RobotFailed => INTO_FAULT,
    }
}

/// Driven by hand: whatever holds the robot also ends the drive.
pub(super) const fn driving(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start | PhaseInput::BackHome | PhaseInput::Move | PhaseInput::Goto => &[Never(Guard::Driving)],
        PhaseInput::Retrieve | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Done
        | PhaseInput::Blocked
        | PhaseInput::AtPiece
        | PhaseInput::CameHome
        | PhaseInput::AllExplored
        | PhaseInput::NoWayHome => NOTHING,
        PhaseInput::PhotoTaken
        | PhaseInput::PhotoFailed
        | PhaseInput::LuggageRecorded
        | PhaseInput::SafeRecorded
        | PhaseInput::DangerRecorded => &[AsInterrupted],
        PhaseInput::DriveEnded => &[When(Case::FromIdle, Interrupted, &[]), Go(Interrupted, &[Raise(Hold::Operator)])],
        PhaseInput::Unanswered | PhaseInput::RobotFailed => INTO_FAULT,
    }
}

/// On the way home after BACK HOME.
pub(super) const fn returning_home(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start | PhaseInput::BackHome => RESUME,
        PhaseInput::Retrieve | PhaseInput::Strategy => NOT_HERE,
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
        PhaseInput::DangerRecorded => DANGER_ON_THE_WAY,
        PhaseInput::CameHome => &[Go(Phase(PhaseName::AtHome), &[])],
        PhaseInput::NoWayHome | PhaseInput::Unanswered | PhaseInput::RobotFailed => INTO_FAULT,
    }
}

/// Home after BACK HOME, waiting for START.
pub(super) const fn at_home(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => {
            &[RefuseIf(Guard::Held), RefuseIf(Guard::VerdictAwaited), Go(Phase(PhaseName::Exploring), &[Release])]
        }
        PhaseInput::BackHome => RESUME,
        PhaseInput::Retrieve | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE,
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

/// The hall is searched and the robot is home.
pub(super) const fn explored(input: PhaseInput) -> &'static [Rule] {
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
