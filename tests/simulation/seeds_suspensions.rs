//! The test plans of sprint 0 §1.4 and sprint 6: stop, temperature, backHome and the blinking LED.

use hallsweep_core::command::{Command, TemperatureReport, Verdict};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::units::Cell;
use hallsweep_sim::headless::Run;

use crate::operator::{Operator, in_drawn, in_hall};

/// Robot on its way to (3,3).
fn under_way() -> (Run, Cell) {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Start).unwrap();
    let goal = Cell::new(3, 3);
    run.until("half way to (3,3)", |state| state.mission.goal == Some(goal) && state.robot.pose.cell == Cell::new(0, 2));
    (run, goal)
}

/// Sprint 0: on *stopExplore* the robot stops where it is; on *continueExplore* it continues.
#[test]
fn stop_halts_where_it_is_and_start_goes_on() {
    let (mut run, goal) = under_way();
    run.wait(0.1);
    run.give(Command::Stop).unwrap();
    assert!(run.state().robot.off_centre, "it stands between two cells");
    run.stands_still();
    assert_eq!(run.holds(), [Hold::Operator, Hold::AwaitingStart]);
    run.give(Command::Start).unwrap();
    assert_eq!(run.state().mission.goal, Some(goal));
    run.until("at the goal", |state| state.robot.pose.cell == goal);
}

/// Sprint 0: when the console sees that the temperature is too high, the robot stops exploring.
/// Sprint 6: on *temperatureTooHigh* the exploration is suspended.
#[test]
fn heat_suspends_the_exploration() {
    let (mut run, _) = under_way();
    run.temperature(TemperatureReport::TooHigh).unwrap();
    run.stands_still();
    assert_eq!(run.phase(), PhaseName::Exploring);
    assert_eq!(run.holds(), [Hold::TooHigh, Hold::AwaitingStart]);
}

/// Sprint 6: the exploration continues only after *temperatureOk* and then *startCmd*.
#[test]
fn after_heat_it_takes_ok_and_then_start() {
    let (mut run, _) = under_way();
    run.temperature(TemperatureReport::TooHigh).unwrap();
    assert!(matches!(run.give(Command::Start), Err(Refused::Held(..))));
    run.temperature(TemperatureReport::Ok).unwrap();
    run.stands_still();
    run.give(Command::Start).unwrap();
    run.until_explored();
}

/// Sprint 6: after heat, the robot pursues the same goal as before.
#[test]
fn after_heat_the_goal_is_restored() {
    let (mut run, goal) = under_way();
    run.reading(26.0).unwrap();
    run.reading(23.0).unwrap();
    run.give(Command::Start).unwrap();
    assert_eq!(run.state().mission.goal, Some(goal));
    run.until("at the goal", |state| state.robot.pose.cell == goal);
}

/// Sprint 0: on *backHome* the robot returns to its first position.
/// Sprint 6: on *backHome* the goal is (0,0).
/// Sprint 6: at home the robot waits for *start*.
#[test]
fn back_home_goes_home_and_waits_for_start() {
    let (mut run, _) = under_way();
    run.give(Command::BackHome).unwrap();
    assert_eq!(run.state().mission.goal, Some(Cell::HOME));
    run.until_phase(PhaseName::AtHome);
    assert_eq!(run.cell(), Cell::HOME);
    run.stands_still();
}

/// Sprint 6: after *backHome* and *start*, the robot pursues the same goal as before.
#[test]
fn after_back_home_the_goal_is_restored() {
    let (mut run, goal) = under_way();
    run.give(Command::BackHome).unwrap();
    run.until_phase(PhaseName::AtHome);
    run.give(Command::Start).unwrap();
    assert_eq!(run.state().mission.goal, Some(goal));
    run.until("at the goal", |state| state.robot.pose.cell == goal);
}

/// Sprint 6: the LED begins to blink with the exploration and continues during suspensions.
#[test]
fn the_led_blinks_from_the_first_start_through_every_suspension() {
    let (mut run, _) = under_way();
    assert!(run.state().robot.led_blinking && run.sim.led());
    run.give(Command::Stop).unwrap();
    assert!(run.state().robot.led_blinking);
    run.give(Command::BackHome).unwrap();
    run.until_phase(PhaseName::AtHome);
    assert!(run.state().robot.led_blinking && run.sim.led());
}

/// Sprint 6: the LED stops blinking when the exploration ends because everything is explored.
#[test]
fn the_led_ends_when_everything_is_explored() {
    let (mut run, _) = under_way();
    run.until_phase(PhaseName::Explored);
    assert!(!run.state().robot.led_blinking && !run.sim.led());
}

/// Sprint 6: the LED stops blinking when the exploration ends because the bomb is found.
#[test]
fn the_led_ends_when_the_bomb_is_found() {
    let mut run = in_drawn(&["S..", ".a.", "..."]);
    run.give(Command::Start).unwrap();
    run.until_pending();
    assert!(run.sim.led());
    run.verdict(1, Verdict::Danger).unwrap();
    assert!(!run.state().robot.led_blinking && !run.sim.led());
}
