//! Tests of the core under the control of a simulator: paused time, and another hall.

use super::*;
use crate::settings::Rules;
use crate::simulated::{Change, Simulated};
use crate::state::{Conditions, Venue};

fn robot(engine: &mut Engine, report: RobotEvent, at: u64) {
    engine.handle_event(Event::Robot(RobotId::discovery(), report), now(at));
}

fn issuer() -> Issuer {
    Issuer::operator(Door::LOCAL)
}

fn venue(name: &str, cell_m: Option<f64>) -> Venue {
    Venue { name: name.into(), cell_m, ..Venue::default() }
}

fn put_down(engine: &mut Engine) -> Result<Ticket, Refused> {
    engine.put_down_in(venue("depot", Some(0.5)), &[RobotId::discovery()], issuer(), now(2))
}

fn recorded(engine: &mut Engine) -> Vec<String> {
    let mut words = Vec::new();
    while let Some(effect) = engine.poll_effect() {
        if let Effect::Record(page) = effect {
            words.extend(page.entries.iter().map(|entry| format!("{:?}", entry.fact)));
            engine.handle_event(Event::Recorded(page.last()), now(3));
        }
    }
    words
}

#[test]
fn a_robot_whose_time_stands_is_never_overdue_and_is_waited_for_when_it_goes_on() {
    let mut engine = sweep_in(PhaseName::Exploring, &[]);
    engine.handle_timeout(now(1));
    assert!(!settle(&mut engine).is_empty(), "it was ordered on");
    robot(&mut engine, RobotEvent::Paused, 1);
    engine.handle_timeout(now(10_000));
    assert_eq!(engine.snapshot().mission.phase, PhaseName::Exploring);
    let can = engine.robots.searching().controller.capabilities.expect("it is linked");
    robot(&mut engine, RobotEvent::LinkUp(can), 10_000);
    engine.handle_timeout(now(10_001));
    assert_eq!(engine.snapshot().mission.phase, PhaseName::Exploring, "it has its time again");
    engine.handle_timeout(now(10_100));
    assert_eq!(engine.snapshot().mission.phase, PhaseName::Fault, "and no more than that");
}

#[test]
fn a_hall_is_left_only_when_no_mission_is_under_way_and_no_robot_moves() {
    for phase in PhaseName::ALL {
        let mut engine = sweep_in(phase, &[]);
        let is_over = matches!(phase, PhaseName::Idle | PhaseName::Explored | PhaseName::BagSecured);
        let bound = engine.snapshot().bound_to_hall();
        let put_down = put_down(&mut engine);
        assert_eq!(put_down.is_ok(), is_over, "{phase:?}");
        assert_eq!(put_down.err(), bound, "{phase:?}: what is shown is what is done");
    }
    assert_eq!(put_down(&mut sweep_in(PhaseName::Idle, &[Hold::Store])), Err(Refused::StoreDown));
    let mut driven = sweep_in(PhaseName::Idle, &[]);
    driven.handle_command(Request::new(Command::Move(Move::TurnLeft), issuer()), now(1)).expect("it may be driven");
    settle(&mut driven);
    assert!(put_down(&mut driven).is_err(), "it moves");
}

#[test]
fn put_down_in_another_hall_the_map_is_empty_who_asked_is_on_record_and_nothing_moves_before_the_robot_is_there() {
    let mut engine = sweep_in(PhaseName::Explored, &[]);
    put_down(&mut engine).expect("nothing is under way");
    let words = recorded(&mut engine);
    assert!(words.iter().any(|fact| fact.contains("PutDown(\"depot\")") && fact.contains("operator")), "{words:?}");
    let state = engine.snapshot();
    assert_eq!((state.mission.phase, state.robot.pose), (PhaseName::Idle, Pose::START));
    assert!(state.mission.holds.contains(&Hold::RobotLink), "it is not there yet");
    assert_eq!((state.mission.progress.visited, state.luggage.len()), (1, 0));
    assert!(engine.handle_command(Request::new(Command::Start, issuer()), now(4)).is_err());
}

#[test]
fn in_which_hall_it_is_goes_on_record_once_and_again_in_another() {
    let mut engine = sweep_in(PhaseName::Idle, &[]);
    let said = |words: &[String]| words.iter().filter(|fact| fact.starts_with("Conditions")).cloned().collect::<Vec<_>>();
    engine.note_venue(venue("airport", None), now(1));
    let first = said(&recorded(&mut engine));
    assert!(first.len() == 1 && first[0].contains("airport"), "{first:?}");
    engine.note_venue(venue("airport", None), now(1));
    assert_eq!(said(&recorded(&mut engine)), Vec::<String>::new());
    put_down(&mut engine).expect("nothing is under way");
    let words = recorded(&mut engine);
    let at = |begin: &str| words.iter().position(|fact| fact.starts_with(begin)).expect("it is on record");
    assert!(at("Conditions") > at("MapEmptied"), "what is of the hall before stands before: {words:?}");
    let conditions = engine.persistent_state().conditions.expect("they are on record");
    let expect =
        Conditions { venue: venue("depot", Some(0.5)), threshold: Settings::default().threshold, rules: Rules::default() };
    assert_eq!(conditions, expect);
}

#[test]
fn what_was_done_to_the_simulator_is_in_log_and_journal() {
    let mut engine = sweep_in(PhaseName::Exploring, &[]);
    let paused = Change { is_paused: Some(true), ..Change::default() };
    engine.note_simulated(issuer(), Simulated::Changed(paused), now(1));
    assert!(recorded(&mut engine).iter().any(|fact| fact.contains("is_paused: Some(true)")));
    let log: Vec<String> = engine.snapshot().log.iter().map(|line| line.said.to_string()).collect();
    assert!(log.contains(&"simulator paused, by operator (local)".to_owned()), "{log:?}");
}
