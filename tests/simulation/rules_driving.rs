//! Mission §4 rule 6: driving by hand, after which the mission never resumes unasked.

use hallsweep_core::command::{Command, Move, TemperatureReport, Verdict};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::units::{Cell, LuggageId};
use hallsweep_core::world::hall_map::Mark;

use crate::operator::{Operator, in_drawn, in_hall};

#[test]
fn on_its_mission_a_robot_is_driven_only_after_a_stop() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Start).unwrap();
    run.wait(1.0);
    assert_eq!(run.drive(Move::Forward), Err(Refused::NotStopped));
    run.give(Command::Stop).unwrap();
    run.drive(Move::TurnLeft).unwrap();
    assert_eq!(run.drive(Move::TurnLeft), Err(Refused::Driving));
    assert_eq!(run.give(Command::Start), Err(Refused::Driving));
    run.until_phase(PhaseName::Exploring);
    assert_eq!(run.holds(), [Hold::Operator, Hold::AwaitingStart]);
    run.stands_still();
    run.give(Command::Start).unwrap();
    run.until_explored();
}

#[test]
fn waiting_at_home_is_over_once_the_robot_is_driven_away() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Start).unwrap();
    run.wait(3.0);
    run.give(Command::BackHome).unwrap();
    run.until_phase(PhaseName::AtHome);
    run.drive(Move::TurnLeft).unwrap();
    run.until_phase(PhaseName::AtHome);
    run.give(Command::Goto(Cell::new(1, 1))).unwrap();
    run.until_phase(PhaseName::Exploring);
    run.stands_still();
}

#[test]
fn any_hold_ends_the_drive() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Goto(Cell::new(5, 5))).unwrap();
    run.wait(0.5);
    run.temperature(TemperatureReport::TooHigh).unwrap();
    assert_eq!(run.phase(), PhaseName::Idle);
    run.stands_still();
    assert_eq!(run.give(Command::Goto(Cell::new(5, 5))), Err(Refused::Held(vec![Hold::TooHigh], None)));
}

#[test]
fn nothing_is_driven_into_a_known_obstacle() {
    let mut run = in_drawn(&["S#", ".."]);
    for step in [Move::TurnLeft, Move::Forward] {
        run.drive(step).unwrap();
        run.until_phase(PhaseName::Idle);
    }
    assert_eq!(run.drive(Move::Forward), Err(Refused::IntoObstacle(Cell::new(1, 0))));
    assert_eq!(run.give(Command::Goto(Cell::new(1, 0))), Err(Refused::IntoObstacle(Cell::new(1, 0))));
}

#[test]
fn a_robot_without_small_turns_refuses_them() {
    let mut run = in_hall("empty-8x8");
    assert_eq!(run.drive(Move::NudgeLeft), Err(Refused::NotCapable));
}

#[test]
fn a_bag_met_by_hand_is_inspected_by_the_next_exploration() {
    let mut run = in_drawn(&["S..", "a..", "..."]);
    run.drive(Move::Forward).unwrap();
    run.until_phase(PhaseName::Idle);
    assert_eq!(run.state().map.at(Cell::new(0, 1)), Mark::NotInspected);
    assert!(run.state().luggage.is_empty());
    run.give(Command::Start).unwrap();
    run.until_explored();
    assert_eq!(run.state().luggage.len(), 1);
}

/// Rule 2: after a drive away from home, a pending verdict still comes before exploring.
#[test]
fn a_pending_verdict_survives_a_drive_by_hand_and_danger_then_acts_on_the_mission() {
    let mut run = in_drawn(&["S...", ".a..", "....", "...."]);
    run.give(Command::Start).unwrap();
    run.until_pending();
    run.give(Command::BackHome).unwrap();
    run.until_phase(PhaseName::AtHome);
    run.drive(Move::TurnLeft).unwrap();
    run.verdict(1, Verdict::Danger).unwrap();
    assert!(!run.state().robot.led_blinking);
    run.until_phase(PhaseName::BombLocated);
    assert_eq!(run.give(Command::RetakePhoto(LuggageId(1))), Err(Refused::NotInPhase(PhaseName::BombLocated)));
}

#[test]
fn a_goal_nobody_can_reach_ends_the_drive_and_says_so() {
    let mut run = in_drawn(&["S.#.", "..#.", "..#."]);
    run.give(Command::Goto(Cell::new(3, 1))).unwrap();
    run.until_phase(PhaseName::Idle);
    assert!(run.state().log.iter().any(|line| line.said.to_string().contains("no way leads to (3, 1)")));
}
