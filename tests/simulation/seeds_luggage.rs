//! The test plans of sprint 0 §1.4 and sprints 4 and 5: luggage is found, marked, photographed and judged.

use hallsweep_core::command::{Command, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::robot::RobotState;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::Mark;
use hallsweep_sim::headless::Run;

use crate::operator::{Operator, in_drawn, in_hall};

fn started(rows: &[&str]) -> Run {
    let mut run = in_drawn(rows);
    run.give(Command::Start).expect("an idle robot in a cool hall starts");
    run
}

/// Sprint 0: START with the temperature below the threshold begins the exploration.
/// Sprint 0: on *explore* the robot searches the whole hall.
#[test]
fn start_in_a_cool_hall_explores_all_of_it() {
    let mut run = in_hall("seed");
    run.reading(20.0).unwrap();
    run.give(Command::Start).unwrap();
    assert_eq!(run.phase(), PhaseName::Exploring);
    run.until_explored();
    assert_eq!(run.state().luggage.len(), 3);
    assert_eq!(run.cell(), Cell::HOME);
}

/// Sprint 0: at luggage that is not analysed yet, the robot stops, takes a photo and sends it.
/// Sprint 5: after it has met an obstacle, the robot waits for the operator's message.
#[test]
fn at_luggage_it_stops_photographs_and_waits_for_the_operator() {
    let mut run = started(&["S..", ".a.", "..."]);
    run.until("taking a photo", |state| state.robot.state == RobotState::TakingPhoto);
    run.until_pending();
    let state = run.state();
    assert_eq!(state.mission.phase, PhaseName::Inspecting);
    assert_eq!(state.luggage[0].cell, Cell::new(1, 1));
    assert!(state.luggage[0].is_pending() && state.luggage[0].has_photo());
    assert!(
        run.journal
            .iter()
            .any(|entry| matches!(&entry.fact, Fact::Luggage { photo: Some(photo), .. } if !photo.bytes.is_empty()))
    );
    run.stands_still();
    assert_eq!(run.phase(), PhaseName::Inspecting);
}

/// Sprint 4: an obstacle met while exploring is marked on the map.
#[test]
fn an_obstacle_is_marked_on_the_map() {
    let mut run = started(&["S..", ".a.", "..."]);
    run.until_pending();
    assert_eq!(run.state().map.at(Cell::new(1, 1)), Mark::Luggage);
}

/// Sprint 4: after an obstacle a new plan is made for the same goal.
#[test]
fn after_an_obstacle_it_plans_again_for_the_same_goal() {
    let mut run = started(&["S..", "a..", "..."]);
    assert_eq!(run.state().mission.goal, Some(Cell::new(1, 1)));
    run.until_pending();
    run.verdict(1, Verdict::Safe).unwrap();
    assert_eq!(run.state().mission.goal, Some(Cell::new(1, 1)));
    run.until("at the goal by another way", |state| state.robot.pose.cell == Cell::new(1, 1));
}

/// Sprint 4: a goal on an obstacle is replaced by the next goal.
#[test]
fn a_goal_that_is_an_obstacle_is_left_for_the_next() {
    let mut run = started(&["S...", ".a..", "....", "...."]);
    run.until_pending();
    run.verdict(1, Verdict::Safe).unwrap();
    run.until("the next ring's goal", |state| state.mission.goal == Some(Cell::new(2, 2)));
    run.until_explored();
}

/// Sprint 4: a goal outside the hall's borders ends the growth of the explored area, and the exploration ends.
/// Sprint 4: once the borders are known, every unvisited cell is explored.
#[test]
fn a_goal_outside_the_hall_ends_the_exploration_with_every_cell_visited() {
    let mut run = started(&["S.....", "......"]);
    run.until_explored();
    let map = run.state().map.clone();
    assert!((0..6).all(|x| (0..2).all(|y| map.at(Cell::new(x, y)) == Mark::Visited)));
}

/// Sprint 5: on *luggageSafe* the exploration continues.
#[test]
fn safe_goes_on_exploring() {
    let mut run = started(&["S..", "a..", "..."]);
    run.until_pending();
    run.verdict(1, Verdict::Safe).unwrap();
    assert_eq!(run.phase(), PhaseName::Exploring);
    run.until_explored();
}

/// Sprint 0: on *backHomeSinceBomb* the robot comes home for the retrieval.
/// Sprint 5: on *luggageDanger* the robot comes home, ends the exploration and visits no new cell.
#[test]
fn danger_comes_home_without_visiting_anything_new() {
    let mut run = started(&["S.....", ".....a", "......"]);
    let visited = |run: &mut Run| run.state().map.visited();
    run.until_pending();
    let before = visited(&mut run);
    run.verdict(1, Verdict::Danger).unwrap();
    assert_eq!(run.phase(), PhaseName::ReturningWithAlarm);
    run.until_phase(PhaseName::BombLocated);
    assert_eq!(visited(&mut run), before);
    assert_eq!(run.cell(), Cell::HOME);
    assert_eq!(run.state().alarms.len(), 1, "the operator is alerted");
    assert_eq!(run.state().mission.progress.percent(), None, "something is open");
}
