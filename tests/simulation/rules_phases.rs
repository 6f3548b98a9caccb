//! Mission §4 on start, stop, backHome and reset, each rule by its number.

use hallsweep_core::command::{Command, Door, Issuer, Request, Verdict};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{AlarmId, Cell, Epoch, LuggageId, MissionId};
use hallsweep_sim::headless::Run;

use crate::operator::{Operator, in_drawn, in_hall};

const BAG_AT_1_1: &[&str] = &["S...", ".a..", "....", "...."];

fn at_the_bag() -> Run {
    let mut run = in_drawn(BAG_AT_1_1);
    run.give(Command::Start).unwrap();
    run.until_pending();
    run
}

/// Rule 1.
#[test]
fn stop_is_accepted_again_and_again_and_raises_the_epoch_each_time() {
    let mut run = in_hall("empty-8x8");
    for n in 1..=3 {
        run.give(Command::Stop).unwrap();
        assert_eq!(run.state().mission.epoch, Epoch(n));
    }
    assert_eq!(run.holds(), [Hold::Operator], "no mission is under way, so nothing awaits a start");
}

/// Rule 2.
#[test]
fn start_while_exploring_is_a_harmless_repeat() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Start).unwrap();
    let mission = run.state().mission.id;
    run.give(Command::Start).unwrap();
    assert_eq!(run.state().mission.id, mission);
    run.until_explored();
}

/// Rule 2.
#[test]
fn start_after_the_end_begins_a_new_mission_with_a_fresh_map() {
    let mut run = in_hall("seed");
    run.give(Command::Start).unwrap();
    run.until_explored();
    run.give(Command::Start).unwrap();
    let state = run.state();
    assert_eq!((state.mission.id, state.map.visited(), state.luggage.len()), (MissionId(2), 1, 0));
    run.until_pending();
    assert_eq!(run.state().luggage[0].id, LuggageId(4), "numbers of luggage are never used again");
    run.until_explored();
}

/// Rule 2.
#[test]
fn start_is_refused_while_a_verdict_is_pending_and_once_the_bomb_is_located() {
    let mut run = at_the_bag();
    assert_eq!(run.give(Command::Start), Err(Refused::VerdictPending(LuggageId(1))));
    run.verdict(1, Verdict::Danger).unwrap();
    run.until_phase(PhaseName::BombLocated);
    assert_eq!(run.give(Command::Start), Err(Refused::NotInPhase(PhaseName::BombLocated)));
    assert_eq!(run.give(Command::Retrieve(None)), Err(Refused::NoRetrievalRobot));
}

/// Rule 2.
#[test]
fn start_on_the_way_home_goes_on_with_what_was_halted() {
    let mut run = at_the_bag();
    run.verdict(1, Verdict::Danger).unwrap();
    run.wait(0.1);
    run.give(Command::Stop).unwrap();
    run.stands_still();
    run.give(Command::Start).unwrap();
    run.until_phase(PhaseName::BombLocated);
}

/// Rule 3.
#[test]
fn back_home_is_refused_once_danger_is_given_and_without_a_mission() {
    let mut run = in_drawn(BAG_AT_1_1);
    assert_eq!(run.give(Command::BackHome), Err(Refused::NotInPhase(PhaseName::Idle)));
    run.give(Command::Start).unwrap();
    run.until_pending();
    run.verdict(1, Verdict::Danger).unwrap();
    assert_eq!(run.give(Command::BackHome), Err(Refused::NotInPhase(PhaseName::ReturningWithAlarm)));
}

/// Rule 3.
#[test]
fn a_verdict_stays_pending_on_the_way_home_and_can_be_given_there() {
    let mut run = at_the_bag();
    run.give(Command::BackHome).unwrap();
    run.until_phase(PhaseName::AtHome);
    assert_eq!(run.give(Command::Start), Err(Refused::VerdictPending(LuggageId(1))));
    run.verdict(1, Verdict::Safe).unwrap();
    assert_eq!(run.phase(), PhaseName::AtHome, "on a backHome trip safe only records");
    run.give(Command::Start).unwrap();
    run.until_explored();
    assert_eq!(run.state().luggage.len(), 1);
}

/// Rules 3 and 4.
#[test]
fn danger_on_a_back_home_trip_turns_it_into_the_alarms() {
    let mut run = at_the_bag();
    run.give(Command::BackHome).unwrap();
    run.verdict(1, Verdict::Danger).unwrap();
    assert_eq!(run.phase(), PhaseName::ReturningWithAlarm);
    run.until_phase(PhaseName::BombLocated);
}

/// Rule 4.
#[test]
fn danger_given_at_home_locates_the_bomb_at_once() {
    let mut run = at_the_bag();
    run.give(Command::BackHome).unwrap();
    run.until_phase(PhaseName::AtHome);
    run.verdict(1, Verdict::Danger).unwrap();
    assert_eq!(run.phase(), PhaseName::BombLocated);
    assert!(!run.state().robot.led_blinking);
}

/// Rule 8.
#[test]
fn reset_needs_a_standing_robot_and_no_pending_verdict() {
    let mut run = in_drawn(BAG_AT_1_1);
    run.give(Command::Start).unwrap();
    assert_eq!(run.give(Command::Reset), Err(Refused::Moving));
    run.until_pending();
    assert_eq!(run.give(Command::Reset), Err(Refused::VerdictPending(LuggageId(1))));
}

/// Rule 8.
#[test]
fn reset_away_from_home_keeps_pose_and_map_and_the_next_mission_goes_on_with_them() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Start).unwrap();
    run.until("at (2,2)", |state| state.robot.pose.cell == Cell::new(2, 2));
    run.give(Command::Stop).unwrap();
    let visited = run.state().map.visited();
    run.give(Command::Reset).unwrap();
    let state = run.state();
    assert_eq!((state.mission.phase, state.map.visited()), (PhaseName::Idle, visited));
    assert!(state.mission.holds.is_empty() && !state.robot.led_blinking);
    run.stands_still();
    run.give(Command::Start).unwrap();
    run.until_explored();
    assert_eq!(run.state().mission.id, MissionId(2));
}

/// Rule 8.
#[test]
fn reset_at_home_empties_the_map() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Start).unwrap();
    run.until_explored();
    run.give(Command::Reset).unwrap();
    assert_eq!(run.state().map.visited(), 1);
}

/// Rule 8.
#[test]
fn a_bomb_stays_on_the_console_until_its_alarm_is_acknowledged() {
    let mut run = at_the_bag();
    run.verdict(1, Verdict::Danger).unwrap();
    run.until_phase(PhaseName::BombLocated);
    assert_eq!(run.give(Command::Reset), Err(Refused::BombUnfetched(LuggageId(1))));
    assert_eq!(run.give(Command::Acknowledge(AlarmId(9))), Err(Refused::UnknownAlarm(AlarmId(9))));
    run.give(Command::Acknowledge(AlarmId(1))).unwrap();
    run.give(Command::Reset).unwrap();
    let left = |fact: &Fact| matches!(fact, Fact::MissionArchived(_, bombs) if bombs == &[LuggageId(1)]);
    assert!(run.journal.iter().any(|entry| left(&entry.fact)), "archived as a bomb left in place");
    assert_eq!(run.phase(), PhaseName::Idle);
}

/// Rule 9, safety S4.
#[test]
fn a_start_from_before_the_last_stop_is_outdated_and_a_verdict_never_is() {
    let mut run = at_the_bag();
    run.give(Command::Stop).unwrap();
    let old = |command| Request { epoch: Some(Epoch(0)), ..Request::new(command, Issuer::operator(Door::LOCAL)) };
    assert_eq!(run.ask(old(Command::BackHome)), Err(Refused::Outdated { sent: Epoch(0), now: Epoch(1) }));
    let luggage = hallsweep_core::command::LuggageRef::Pending;
    run.ask(old(Command::Verdict { luggage, verdict: Verdict::Safe, note: None, hot: Default::default() })).unwrap();
    assert_eq!(run.ask(old(Command::Start)), Err(Refused::Outdated { sent: Epoch(0), now: Epoch(1) }));
}

/// Rule 9.
#[test]
fn an_answer_names_the_revision_that_contains_its_effect() {
    let mut run = in_hall("empty-8x8");
    let accepted = run.give(Command::Start).unwrap();
    assert!(accepted.revision <= run.state().revision);
    let stopped = run.give(Command::Stop).unwrap();
    assert!(stopped.revision > accepted.revision);
}

/// Rule 10.
#[test]
fn the_strategy_is_chosen_only_between_missions() {
    use hallsweep_core::command::Strategy;
    let mut run = in_hall("empty-8x8");
    run.give(Command::ChooseStrategy(Strategy::Snail)).unwrap();
    run.give(Command::Start).unwrap();
    assert_eq!(run.give(Command::ChooseStrategy(Strategy::Snail)), Err(Refused::NotInPhase(PhaseName::Exploring)));
}
