//! A robot that fetches by itself and says late what it holds: nothing is concluded before it has.

use std::collections::BTreeSet;

use super::*;
use crate::event::Piece;
use crate::retrieval::{ArmAction, ArmState, Gripper, Parcel, Place};
use crate::settings::Fetcher;
use crate::state::{Retrieval, RetrievalStage};

/// Started again with the piece off the floor: what is on record says where the robot stands, and only the robot what it holds.
fn fetching(stage: RetrievalStage, pose: Pose) -> Engine {
    let mut engine = sweep_in(PhaseName::Retrieving, &[]);
    engine.settings.fetcher = Fetcher::Discovery;
    engine.state.pose = pose;
    let (luggage, fetcher) = (LuggageId(1), Fetcher::Discovery);
    engine.state.retrieval = Some(Retrieval { luggage, fetcher, stage, piece: BTreeSet::new(), call: None, team: None });
    engine
}

fn tells(engine: &mut Engine, arm: ArmState) -> Vec<Action> {
    engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::Arm(arm)), now(1));
    settle(engine)
}

fn waits(engine: &mut Engine) {
    engine.handle_timeout(now(1));
    assert_eq!((settle(engine), engine.state.phase.name()), (Vec::new(), PhaseName::Retrieving));
}

fn full(cell: Cell) -> ArmState {
    let holds = Some(Parcel { piece: Piece(1), place: Place::Cell(cell) });
    ArmState { gripper: Gripper::Closed, holds, lifted: true, ..ArmState::default() }
}

#[test]
fn a_piece_that_was_taken_is_carried_on_once_the_robot_says_that_it_has_it() {
    let pose = Pose { cell: Cell::new(0, 1), ..Pose::START };
    let mut engine = fetching(RetrievalStage::Fetching, pose);
    waits(&mut engine);
    assert!(matches!(tells(&mut engine, full(pose.cell))[..], [Action::Move(_)]), "home");
    let mut engine = fetching(RetrievalStage::Fetching, pose);
    waits(&mut engine);
    tells(&mut engine, ArmState::default());
    assert_eq!(engine.state.phase.name(), PhaseName::Fault, "it is neither on its back nor in the container");
}

#[test]
fn a_piece_is_secured_once_the_robot_says_that_it_has_let_go_of_it() {
    let mut engine = fetching(RetrievalStage::LettingGo, Pose::START);
    waits(&mut engine);
    assert_eq!(tells(&mut engine, full(Cell::HOME)), [Action::Arm(ArmAction::Release)], "it was not let go");
    let mut engine = fetching(RetrievalStage::LettingGo, Pose::START);
    waits(&mut engine);
    tells(&mut engine, ArmState::default());
    assert_eq!(engine.state.phase.name(), PhaseName::BagSecured);
    assert!(engine.state.luggage[&LuggageId(1)].secured.is_some());
}
