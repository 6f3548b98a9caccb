//! Tests of late or unrelated arm reports from robots that fetch. The engine must conclude nothing before a report
//! arrives, or from a report about another piece.

use std::collections::BTreeSet;

use super::*;
use crate::arm::{ArmAction, ArmState, Gripper, Parcel};
use crate::not_fetched::Fetcher;
use crate::pair::Which;
use crate::place::Place;
use crate::state::{Retrieval, RetrievalStage};
use crate::units::Piece;
use crate::world::hall_map::Mark;

/// Returns an engine after a restart, with a piece that was recorded as lifted. The journal has the robot's place,
/// but only the robot can report what it holds.
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
    assert!(engine.state.luggage[0].secured.is_some());
}

#[test]
fn what_a_robot_held_before_its_link_was_lost_counts_no_more_until_it_says_so_again() {
    let mut engine = fetching(RetrievalStage::LettingGo, Pose::START);
    assert_eq!(tells(&mut engine, full(Cell::HOME)), [Action::Arm(ArmAction::Release)]);
    let can = engine.robots.searching().controller.capabilities.expect("it is linked");
    let says = |engine: &mut Engine, event| {
        engine.handle_event(Event::Robot(RobotId::discovery(), event), now(2));
        settle(engine)
    };
    says(&mut engine, RobotEvent::LinkLost("gone".to_owned()));
    says(&mut engine, RobotEvent::LinkUp(can));
    engine.state.holds = Holds::default();
    engine.robots.searching_mut().off_centre = false;
    waits(&mut engine);
    tells(&mut engine, ArmState::default());
    assert_eq!(engine.state.phase.name(), PhaseName::BagSecured, "it has let go of it meanwhile");
}

#[test]
fn whoever_has_taken_another_piece_is_at_fault() {
    let mut engine = fetching(RetrievalStage::Fetching, Pose { cell: Cell::new(0, 1), ..Pose::START });
    identify(&mut engine);
    tells(&mut engine, full(Cell::new(0, 1)));
    assert_eq!(engine.state.phase.name(), PhaseName::Fault);
}

/// Records that the camera recognised the piece as number 7.
fn identify(engine: &mut Engine) {
    let luggage = Luggage { piece: Some(Piece(7)), ..Luggage::clone(&engine.state.luggage[0]) };
    engine.state.luggage.insert(Arc::new(luggage));
}

/// Returns an engine with a pair whose piece stands in these cells.
fn paired(piece: &[Cell]) -> Engine {
    let mut engine = fetching(RetrievalStage::Fetching, Pose::START);
    engine.settings.fetcher = Fetcher::Pair;
    Which::ALL.iter().for_each(|which| engine.add_robot(which.robot(), now(0)));
    let begun = engine.state.retrieval.take().expect("it was begun");
    engine.state.retrieval = Some(Retrieval { fetcher: Fetcher::Pair, piece: piece.iter().copied().collect(), ..begun });
    engine
}

fn hears(engine: &mut Engine, event: RobotEvent) -> Vec<Cell> {
    engine.handle_event(Event::Robot(Which::Srm1.robot(), event), now(1));
    settle(engine);
    engine.state.retrieval.as_ref().expect("it is under way").piece.iter().copied().collect()
}

#[test]
fn a_parcel_that_was_lost_moves_the_piece_only_if_it_is_the_piece() {
    let (stood, fell) = (Cell::new(0, 2), Cell::new(3, 3));
    let lost = |piece, cell| RobotEvent::ParcelLost(Parcel { piece: Piece(piece), place: Place::Cell(cell) });
    let mut engine = paired(&[stood]);
    assert_eq!(hears(&mut engine, lost(9, fell)), [stood], "nobody knows its number, and it does not lie where the piece stood");
    assert_eq!(hears(&mut paired(&[]), lost(9, fell)), [fell], "the piece was lifted, and something fell");
    identify(&mut engine);
    assert_eq!(hears(&mut engine, lost(9, stood)), [stood]);
    assert_eq!(engine.state.map.at(stood), Mark::Unknown, "another piece lies there since an earlier retrieval");
    assert_eq!(hears(&mut engine, lost(7, fell)), [fell]);
    assert_eq!(engine.state.map.at(fell), Mark::Luggage);
}

#[test]
fn a_piece_that_was_set_down_while_nobody_listened_stands_where_it_is_held() {
    let cell = Cell::new(2, 2);
    let down = ArmState { lifted: false, on_floor: true, ..full(cell) };
    assert_eq!(hears(&mut paired(&[]), RobotEvent::Arm(down)), [cell]);
    assert_eq!(hears(&mut paired(&[]), RobotEvent::Arm(full(cell))), [], "it is off the floor");
}

#[test]
fn obstacles_that_touch_a_piece_and_that_nobody_has_recognised_may_go_with_it() {
    let (cell, beside, recognised) = (Cell::new(0, 2), Cell::new(1, 2), Cell::new(0, 3));
    let mut engine = paired(&[cell]);
    for marked in [cell, beside, recognised] {
        engine.mark(marked, Mark::Luggage);
    }
    engine.state.met_again.insert(recognised, Piece(9));
    assert_eq!(hears(&mut engine, RobotEvent::Arm(full(cell))), []);
    let marks = [cell, beside, recognised].map(|cell| engine.state.map.at(cell));
    assert_eq!(marks, [Mark::Visited, Mark::Unknown, Mark::Luggage]);
}
