//! Mission §4 on holds: what raises and clears each hold, and that nothing moves while there is one.

use std::time::Duration;

use hallsweep_core::command::{Command, TemperatureReport, Verdict};
use hallsweep_core::event::{Capabilities, Event, RobotEvent};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::{Part, Parts, RobotId};
use hallsweep_core::units::Celsius;
use hallsweep_core::world::temperature::TemperatureStatus;
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::bare::Bare;
use crate::operator::{Operator, in_drawn, in_hall, run_in, sensor_reads};

/// Rule 5.
#[test]
fn the_buttons_concern_their_own_hold_alone() {
    let mut run = in_hall("empty-8x8");
    run.reading(30.0).unwrap();
    run.temperature(TemperatureReport::TooHigh).unwrap();
    run.temperature(TemperatureReport::Ok).unwrap();
    assert_eq!(run.holds(), [Hold::Temperature], "OK does not argue with a reading");
    assert_eq!(run.state().temperature.status, TemperatureStatus::TooHigh);
    run.reading(24.5).unwrap();
    assert_eq!(run.holds(), [Hold::Temperature], "within the hysteresis");
    run.reading(24.0).unwrap();
    assert!(run.holds().is_empty());
}

/// Rule 5.
#[test]
fn the_hold_ends_only_when_the_last_reading_of_every_source_permits() {
    let mut run = in_hall("empty-8x8");
    run.reading(30.0).unwrap();
    let robot = |degrees| RobotEvent::Temperature(Celsius::new(degrees).unwrap());
    let now = run.now();
    run.engine.handle_event(Event::Robot(RobotId::discovery(), robot(20.0)), now);
    assert_eq!(run.holds(), [Hold::Temperature]);
    run.reading(20.0).unwrap();
    assert!(run.holds().is_empty());
}

/// Requirement R-tempOk.
#[test]
fn a_start_before_the_ok_is_refused_with_the_reason_and_not_remembered() {
    let mut run = in_hall("empty-8x8");
    run.temperature(TemperatureReport::TooHigh).unwrap();
    assert_eq!(run.give(Command::Start), Err(Refused::Held(vec![Hold::TooHigh], None)));
    run.temperature(TemperatureReport::Ok).unwrap();
    run.stands_still();
    assert_eq!(run.phase(), PhaseName::Idle);
}

#[test]
fn heat_during_a_drive_home_waits_for_cool_and_start() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Start).unwrap();
    run.until("some cells", |state| state.map.visited() > 12);
    run.give(Command::BackHome).unwrap();
    run.reading(40.0).unwrap();
    run.stands_still();
    run.reading(20.0).unwrap();
    run.stands_still();
    run.give(Command::Start).unwrap();
    run.until_phase(PhaseName::AtHome);
}

#[test]
fn the_end_of_a_cause_alone_never_sets_anything_moving() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Start).unwrap();
    run.wait(1.0);
    type Change = fn(&mut Run);
    let sensor: (Change, Change) = (
        |run| run.engine.watch_sensor("roof".into(), Duration::from_secs(3600), run.now()),
        |run| drop(run.give(sensor_reads("roof", 20.0))),
    );
    let store: (Change, Change) =
        (|run| run.happen(Event::StoreFailed("disk full".to_owned())), |run| run.happen(Event::StoreRestored));
    for (lose, restore) in [sensor, store] {
        lose(&mut run);
        run.wait(1.0);
        assert_eq!(run.holds().len(), 2);
        let held = run.give(Command::Start);
        assert!(matches!(held, Err(Refused::Held(..))), "{held:?}");
        restore(&mut run);
        run.stands_still();
        assert_eq!(run.holds(), [Hold::AwaitingStart]);
        run.give(Command::Start).unwrap();
        run.wait(0.1);
    }
    run.until_explored();
}

#[test]
fn the_halls_own_heat_holds_the_robot_while_it_lasts() {
    let text = "name = \"hot\"\nwidth = 8\nheight = 8\n\
                [[temperature]]\nat_s = 0\ncelsius = 20.0\n[[temperature]]\nat_s = 20\ncelsius = 30.0\n\
                [[temperature]]\nat_s = 60\ncelsius = 20.0\n";
    let mut run = run_in(Hall::parse("hot.toml", text).unwrap(), SimSettings::new(1, Camera::Stub));
    run.give(Command::Start).unwrap();
    run.until("too hot", |state| state.mission.holds.contains(&Hold::Temperature));
    let before = run.state().robot.pose;
    run.until("cool again", |state| !state.mission.holds.contains(&Hold::Temperature));
    assert_eq!((run.state().robot.pose, run.holds()), (before, vec![Hold::AwaitingStart]));
    run.give(Command::Start).unwrap();
    run.until_explored();
}

#[test]
fn photo_and_record_proceed_under_holds_and_verdicts_then_move_nothing() {
    let mut run = in_drawn(&["S...", ".a..", "....", "...."]);
    run.give(Command::Start).unwrap();
    run.until_pending();
    run.temperature(TemperatureReport::TooHigh).unwrap();
    run.give(Command::RetakePhoto(hallsweep_core::units::LuggageId(1))).unwrap();
    run.wait(2.0);
    run.verdict(1, Verdict::Safe).unwrap();
    assert_eq!(run.phase(), PhaseName::Exploring);
    run.stands_still();
    run.temperature(TemperatureReport::Ok).unwrap();
    run.give(Command::Start).unwrap();
    run.until_explored();
}

#[test]
fn a_lost_link_holds_and_the_robot_is_recentred_before_it_goes_on() {
    let mut run = in_hall("empty-8x8");
    run.give(Command::Start).unwrap();
    run.wait(1.1);
    let now = run.now();
    let can = run.sim.capabilities();
    run.sim.handle_halt(now);
    run.engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::LinkLost("cable".to_owned())), now);
    assert_eq!(run.holds(), [Hold::RobotLink, Hold::AwaitingStart]);
    assert!(matches!(run.give(Command::Start), Err(Refused::Held(..))));
    run.engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::LinkUp(can)), now);
    run.stands_still();
    run.give(Command::Start).unwrap();
    run.until_explored();
}

/// A hot robot is exchanged for one without a thermometer. Only an operator can then clear the reading, because no
/// other source can.
#[test]
fn a_thermometer_that_is_taken_away_cools_no_hall_and_the_operator_can_say_that_it_is_cool() {
    let mut run = in_hall("empty-8x8");
    let can = Capabilities { parts: Parts::of(&[Part::Base, Part::Bump]), ..run.sim.capabilities() };
    let hot = RobotEvent::Temperature(Celsius::new(30.0).unwrap());
    for report in [hot, RobotEvent::LinkLost("exchanged".to_owned()), RobotEvent::LinkUp(can)] {
        let now = run.now();
        run.engine.handle_event(Event::Robot(RobotId::discovery(), report), now);
    }
    assert_eq!(run.holds(), [Hold::Temperature]);
    assert!(run.state().log.iter().any(|line| line.said.to_string().contains("discovery has no thermometer now")));
    run.reading(20.0).unwrap();
    run.give(Command::Start).unwrap();
    run.until_explored();
}

#[test]
fn why_there_is_no_link_is_logged_for_every_reason() {
    let mut bare = Bare::unlinked();
    let said = |bare: &mut Bare, words: &str| bare.state().log.iter().any(|line| line.said.to_string().contains(words));
    for words in ["nobody listens there", "no page is open"] {
        bare.robot(RobotEvent::LinkLost(words.to_owned()));
        assert!(said(&mut bare, words), "{words}");
    }
}

/// A silent thermometer is only displayed: only a configured sensor raises a hold (rule 5).
#[test]
fn a_robot_that_says_nothing_any_more_is_not_known_and_holds_no_more_than_before() {
    let mut bare = Bare::linked();
    let read = || RobotEvent::Temperature(Celsius::new(21.5).unwrap());
    let is_silent = |bare: &mut Bare| bare.state().temperature.silent_since.is_some();
    bare.robot(read());
    let held = bare.holds();
    assert!(!is_silent(&mut bare));
    bare.wait_in_vain();
    assert!(is_silent(&mut bare) && bare.holds() == held, "30 s are over");
    assert_eq!(bare.state().temperature.status, TemperatureStatus::Ok);
    bare.robot(read());
    assert!(!is_silent(&mut bare), "the same reading again is one");
    bare.robot(RobotEvent::LinkLost("cable".to_owned()));
    assert!(is_silent(&mut bare) && bare.state().robot.unreached_since.is_some());
    bare.link_up();
    assert!(is_silent(&mut bare), "until it reads again");
    assert_eq!(bare.state().robot.unreached_since, None);
    bare.robot(read());
    assert!(!is_silent(&mut bare));
}
