//! The cells of the table for the phases after a verdict of danger, and for the phase fault. `search` has the cells
//! for the search.

use super::everywhere::{PhaseEvent, PhaseInput};
use super::shared::{
    ANOTHER_DANGER, CHOOSE, CLOSE, DANGER_AT_HOME, DRIVE_IF_STOPPED, EXPLORE_AGAIN, INTO_FAULT, NOT_HERE, NOTHING, RESUME,
    RETAKE_ELSEWHERE, SEARCH_AGAIN, SEARCH_ON, going_home, waiting,
};
use crate::mission::rule::Act::{BeginRetrieval, EndRetrieval, Release, RetryBlocked};
use crate::mission::rule::Rule::{AsInterrupted, Go, RefuseIf, When};
use crate::mission::rule::To::{Interrupted, Phase};
use crate::mission::rule::{Case, Guard, Rule};
use crate::phase::PhaseName;

pub(super) const fn returning_with_alarm(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => RESUME,
        PhaseInput::BackHome
        | PhaseInput::GoOn
        | PhaseInput::SearchAgain
        | PhaseInput::Retrieve
        | PhaseInput::Strategy
        | PhaseInput::Close => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Move | PhaseInput::Goto => DRIVE_IF_STOPPED,
        PhaseInput::Event(event) => going_home(event, &[Go(Phase(PhaseName::BombLocated), &[])], ANOTHER_DANGER),
    }
}

pub(super) const fn bomb_located(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start | PhaseInput::BackHome | PhaseInput::Move | PhaseInput::Goto | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::GoOn => SEARCH_ON,
        PhaseInput::SearchAgain => SEARCH_AGAIN,
        PhaseInput::Close => CLOSE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Retrieve => &[
            RefuseIf(Guard::Held),
            RefuseIf(Guard::NotABomb),
            RefuseIf(Guard::NoRetrievalRobot),
            RefuseIf(Guard::FetcherUnreached),
            Go(Phase(PhaseName::Retrieving), &[Release, BeginRetrieval]),
        ],
        PhaseInput::Event(event) => waiting(event, ANOTHER_DANGER),
    }
}

pub(super) const fn retrieving(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => RESUME,
        PhaseInput::BackHome
        | PhaseInput::GoOn
        | PhaseInput::SearchAgain
        | PhaseInput::Retrieve
        | PhaseInput::Move
        | PhaseInput::Goto
        | PhaseInput::Strategy
        | PhaseInput::Close => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Event(PhaseEvent::Secured) => &[
            When(Case::BombLeft, Phase(PhaseName::BombLocated), &[EndRetrieval]),
            When(Case::SearchUnderWay, Phase(PhaseName::AtHome), &[EndRetrieval]),
            Go(Phase(PhaseName::BagSecured), &[EndRetrieval]),
        ],
        PhaseInput::Event(PhaseEvent::NotFetched) => INTO_FAULT,
        PhaseInput::Event(event) => waiting(event, ANOTHER_DANGER),
    }
}

pub(super) const fn bag_secured(input: PhaseInput) -> &'static [Rule] {
    match input {
        PhaseInput::Start => EXPLORE_AGAIN,
        PhaseInput::GoOn => SEARCH_ON,
        PhaseInput::SearchAgain => SEARCH_AGAIN,
        PhaseInput::BackHome | PhaseInput::Retrieve | PhaseInput::Move | PhaseInput::Goto => NOT_HERE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Strategy => CHOOSE,
        PhaseInput::Close => CLOSE,
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
        PhaseInput::BackHome
        | PhaseInput::GoOn
        | PhaseInput::SearchAgain
        | PhaseInput::Retrieve
        | PhaseInput::Move
        | PhaseInput::Goto
        | PhaseInput::Strategy => NOT_HERE,
        PhaseInput::Close => CLOSE,
        PhaseInput::RetakePhoto => RETAKE_ELSEWHERE,
        PhaseInput::Event(event) => match event {
            PhaseEvent::Done
            | PhaseEvent::Blocked
            | PhaseEvent::AtPiece
            | PhaseEvent::CameHome
            | PhaseEvent::AllExplored
            | PhaseEvent::DriveEnded
            | PhaseEvent::Secured
            | PhaseEvent::NotFetched
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
