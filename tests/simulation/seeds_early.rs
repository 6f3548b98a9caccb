//! The test plans of the original's first sprints: a robot that can be driven, finds walls, reaches goals and draws
//! the final map.

use hallsweep_core::command::{Command, Move};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::robot::RobotState;
use hallsweep_core::units::{Cell, Heading, Pose};
use hallsweep_core::world::hall_map::Mark;

use crate::operator::{Operator, in_drawn, in_hall};

/// Sprint 1, `initialStateTest`: before the exploration the robot stands still at (0,0), facing south.
#[test]
fn before_the_exploration_the_robot_stands_at_home_facing_south() {
    let mut run = in_hall("empty-8x8");
    let state = run.state();
    assert_eq!(state.robot.pose, Pose { cell: Cell::new(0, 0), heading: Heading::South });
    assert_eq!(state.robot.state, RobotState::Stopped);
    assert_eq!(state.mission.phase, PhaseName::Idle);
}

/// Sprint 1, `moveTest`: after right, left, forward and backward the robot is where it was.
#[test]
fn right_left_forward_backward_comes_back() {
    let mut run = in_hall("empty-8x8");
    for step in [Move::TurnRight, Move::TurnLeft, Move::Forward, Move::Backward] {
        run.drive(step).expect("an idle robot can be driven");
        run.until_phase(PhaseName::Idle);
    }
    assert_eq!(run.state().robot.pose, Pose::START);
    assert_eq!(run.state().robot.state, RobotState::Stopped);
}

/// Sprint 1, `wallDetectingTest`: at a wall the robot goes back and stops.
#[test]
fn at_a_wall_it_backs_up_and_stops() {
    let mut run = in_drawn(&["S", "."]);
    run.drive(Move::Forward).unwrap();
    run.until_phase(PhaseName::Idle);
    run.drive(Move::Forward).unwrap();
    run.until("backing up", |state| state.robot.state == RobotState::MovingBackward);
    run.until_phase(PhaseName::Idle);
    let state = run.state();
    assert_eq!((state.robot.state, state.robot.pose.cell), (RobotState::Stopped, Cell::new(0, 1)));
    assert_eq!(state.map.at(Cell::new(0, 2)), Mark::Wall);
    assert!(!state.robot.off_centre);
}

/// Sprint 2, `cheGoalTest`: `startTest(1,1)` ends at (1,1).
#[test]
fn a_goal_is_reached() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Goto(Cell::new(1, 1))).unwrap();
    run.until_phase(PhaseName::Idle);
    assert_eq!(run.cell(), Cell::new(1, 1));
}

/// Sprint 2, `checkWallTest`: `startTest(0,8)` meets the wall and ends at (0,7), facing south.
#[test]
fn a_goal_behind_the_wall_ends_in_front_of_it() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Goto(Cell::new(0, 8))).unwrap();
    run.until_phase(PhaseName::Idle);
    assert_eq!(run.state().robot.pose, Pose { cell: Cell::new(0, 7), heading: Heading::South });
}

/// Checks that every cell of a hall of `width` × `height` is visited, and that the walls south and east of it are
/// known.
fn ends_with_the_whole_map(hall: &str, width: i32, height: i32) {
    let mut run = in_hall(hall);
    run.give(Command::Start).unwrap();
    run.until_phase(PhaseName::Explored);
    let map = run.state().map.clone();
    for y in 0..height {
        assert!((0..width).all(|x| map.at(Cell::new(x, y)) == Mark::Visited), "row {y}");
        assert_eq!(map.at(Cell::new(width, y)), Mark::Wall, "row {y}");
    }
    assert!((0..width).all(|x| map.at(Cell::new(x, height)) == Mark::Wall));
    assert_eq!(run.cell(), Cell::HOME);
}

/// Sprint 2, `finalMapTest`, in the room of the original simulator.
#[test]
fn the_final_map_of_the_8x8_hall_is_known() {
    ends_with_the_whole_map("empty-8x8", 8, 8);
}

/// Sprint 2, `finalMapTest`, as the original prints it.
#[test]
fn the_final_map_of_the_9x8_hall_is_known() {
    ends_with_the_whole_map("seed-9x8", 9, 8);
}
