//! The cells of the table for the search: from idle to explored, the ways home, and driving by hand. `alarm` has the
//! cells for danger and fault.

use super::everywhere::{PhaseEvent, PhaseInput};
use super::shared::{
    ANOTHER_DANGER, CHOOSE, CLOSE, DANGER_AT_HOME, DANGER_ON_THE_WAY, DRIVE, DRIVE_IF_STOPPED, EXPLORE_AGAIN, EXPLORE_ON,
    GO_HOME, INTO_FAULT, NOT_HERE, NOTHING, RECORDED, RESUME, RETAKE_ELSEWHERE, SEARCH_AGAIN, going_home, waiting,
};
use crate::hold::Hold;
use crate::mission::rule::Act::{
    AlarmDanger, Begin, FacePiece, LedOff, Raise, RecordPiece, RecordRetake, Release, Retake, SearchAgain,
};
use crate::mission::rule::Rule::{AsInterrupted, Go, Never, RefuseIf, When};
use crate::mission::rule::To::{Interrupted, Phase, Stay};
use crate::mission::rule::{Case, Guard, Rule};
use crate::phase::PhaseName;

pub(super) const fn idle(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => {
            &[RefuseIf(Guard::Held), RefuseIf(Guard::ExerciseOver), Go(Phase(PhaseName::Exploring), &[Release, Begin])]
        }
        PhaseInput::BackHome | PhaseInput::GoOn | PhaseInput::Retrieve | PhaseInput::Close | PhaseInput::SearchAgain => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE,
        PhaseInput::Strategy => CHOOSE,
        PhaseInput::Event(event) => waiting(event, ANOTHER_DANGER),
    }
}

pub(super) const fn exploring(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start | PhaseInput::GoOn => EXPLORE_ON,
        PhaseInput::BackHome => GO_HOME,
        PhaseInput::SearchAgain => SEARCH_AGAIN,
        PhaseInput::Retrieve | PhaseInput::Strategy | PhaseInput::Close => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE_IF_STOPPED,
        PhaseInput::Event(event) => match event {
            PhaseEvent::Done
            | PhaseEvent::PhotoTaken
            | PhaseEvent::PhotoFailed
            | PhaseEvent::SafeRecorded
            | PhaseEvent::CameHome
            | PhaseEvent::DriveEnded
            | PhaseEvent::Secured
            | PhaseEvent::NotFetched => NOTHING,
            PhaseEvent::Blocked => &[When(Case::ToBeInspected, Phase(PhaseName::Inspecting), &[]), Go(Stay, &[])],
            PhaseEvent::AtPiece => &[Go(Phase(PhaseName::Inspecting), &[])],
            PhaseEvent::LuggageRecorded => RECORDED,
            PhaseEvent::DangerRecorded => DANGER_ON_THE_WAY,
            PhaseEvent::AllExplored => &[
                When(Case::KeptOutLeft, Phase(PhaseName::BombLocated), &[]),
                When(Case::BombLeft, Phase(PhaseName::BombLocated), &[LedOff]),
                Go(Phase(PhaseName::Explored), &[LedOff]),
            ],
            PhaseEvent::NoWayHome | PhaseEvent::Unanswered | PhaseEvent::RobotFailed => INTO_FAULT,
        },
    }
}

pub(super) const fn inspecting(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start | PhaseInput::GoOn => &[RefuseIf(Guard::Held), RefuseIf(Guard::OperatorAsked), Go(Stay, &[Release])],
        PhaseInput::SearchAgain => &[
            RefuseIf(Guard::Held),
            RefuseIf(Guard::OperatorAsked),
            RefuseIf(Guard::AreaUnfit),
            Go(Stay, &[Release, SearchAgain]),
        ],
        PhaseInput::BackHome => GO_HOME,
        PhaseInput::Retrieve | PhaseInput::Move | PhaseInput::Goto | PhaseInput::Strategy | PhaseInput::Close => NOT_HERE,
        PhaseInput::RetakePhoto => {
            &[RefuseIf(Guard::NotInspected), RefuseIf(Guard::PhotoUnderWay), RefuseIf(Guard::PhotoHeld), Go(Stay, &[Retake])]
        }
        PhaseInput::Event(event) => match event {
            PhaseEvent::Done => &[When(Case::BackedUp, Stay, &[FacePiece]), Go(Stay, &[])],
            PhaseEvent::Blocked
            | PhaseEvent::AtPiece
            | PhaseEvent::CameHome
            | PhaseEvent::AllExplored
            | PhaseEvent::DriveEnded
            | PhaseEvent::Secured
            | PhaseEvent::NotFetched
            | PhaseEvent::NoWayHome => NOTHING,
            PhaseEvent::PhotoTaken | PhaseEvent::PhotoFailed => {
                &[When(Case::FirstPhoto, Stay, &[RecordPiece]), Go(Stay, &[RecordRetake])]
            }
            PhaseEvent::LuggageRecorded => RECORDED,
            PhaseEvent::SafeRecorded => &[When(Case::ThisPiece, Phase(PhaseName::Exploring), &[]), Go(Stay, &[])],
            PhaseEvent::DangerRecorded => &[
                When(Case::GoesOnFromHere, Phase(PhaseName::Exploring), &[AlarmDanger]),
                When(Case::GoesOn, Stay, &[AlarmDanger]),
                Go(Phase(PhaseName::ReturningWithAlarm), &[LedOff, AlarmDanger]),
            ],
            PhaseEvent::Unanswered | PhaseEvent::RobotFailed => INTO_FAULT,
        },
    }
}

/// The rules while the robot is driven by hand. Every hold also ends the drive.
pub(super) const fn driving(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start
        | PhaseInput::BackHome
        | PhaseInput::GoOn
        | PhaseInput::SearchAgain
        | PhaseInput::Move
        | PhaseInput::Goto => &[Never(Guard::Driving)],
        PhaseInput::Retrieve | PhaseInput::Strategy | PhaseInput::Close => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Event(event) => match event {
            PhaseEvent::Done
            | PhaseEvent::Blocked
            | PhaseEvent::AtPiece
            | PhaseEvent::CameHome
            | PhaseEvent::AllExplored
            | PhaseEvent::Secured
            | PhaseEvent::NotFetched
            | PhaseEvent::NoWayHome => NOTHING,
            PhaseEvent::PhotoTaken
            | PhaseEvent::PhotoFailed
            | PhaseEvent::LuggageRecorded
            | PhaseEvent::SafeRecorded
            | PhaseEvent::DangerRecorded => &[AsInterrupted],
            PhaseEvent::DriveEnded => &[When(Case::FromIdle, Interrupted, &[]), Go(Interrupted, &[Raise(Hold::Operator)])],
            PhaseEvent::Unanswered | PhaseEvent::RobotFailed => INTO_FAULT,
        },
    }
}

pub(super) const fn returning_home(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start | PhaseInput::BackHome => RESUME,
        PhaseInput::GoOn | PhaseInput::SearchAgain | PhaseInput::Retrieve | PhaseInput::Strategy | PhaseInput::Close => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE_IF_STOPPED,
        PhaseInput::Event(event) => going_home(
            event,
            &[When(Case::BombLeft, Phase(PhaseName::BombLocated), &[]), Go(Phase(PhaseName::AtHome), &[])],
            DANGER_ON_THE_WAY,
        ),
    }
}

pub(super) const fn at_home(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start | PhaseInput::GoOn => {
            &[RefuseIf(Guard::Held), RefuseIf(Guard::VerdictAwaited), Go(Phase(PhaseName::Exploring), &[Release])]
        }
        PhaseInput::BackHome => RESUME,
        PhaseInput::SearchAgain => SEARCH_AGAIN,
        PhaseInput::Retrieve | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::Close => CLOSE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE,
        PhaseInput::Event(event) => waiting(event, DANGER_AT_HOME),
    }
}

pub(super) const fn explored(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => EXPLORE_AGAIN,
        PhaseInput::SearchAgain => SEARCH_AGAIN,
        PhaseInput::BackHome | PhaseInput::GoOn | PhaseInput::Retrieve | PhaseInput::Move | PhaseInput::Goto => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Strategy => CHOOSE,
        PhaseInput::Close => CLOSE,
        PhaseInput::Event(event) => waiting(event, DANGER_AT_HOME),
    }
}
