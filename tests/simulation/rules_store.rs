//! Safety S2, V1–V3: events while a record is being written, and a store that fails during the record.

use hallsweep_core::command::{Command, TemperatureReport, Verdict};
use hallsweep_core::effect::Effect;
use hallsweep_core::event::Event;
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::RobotId;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::LuggageId;

use crate::bare::{Bare, records};

fn fails(bare: &mut Bare) {
    bare.event(Event::StoreFailed("disk full".to_owned()));
}

#[test]
fn a_danger_whose_record_fails_is_answered_503_and_alarms_all_the_same() {
    let mut bare = Bare::at_a_bag();
    bare.keeps = false;
    let ticket = bare.verdict(Verdict::Danger).unwrap();
    fails(&mut bare);
    assert_eq!(bare.answer(ticket), Some(Err(Refused::StoreDown)));
    assert_eq!(bare.state().alarms.len(), 1);
    assert_eq!(bare.verdict(Verdict::Danger), Err(Refused::StoreDown), "a repeat is answered too");
}

#[test]
fn a_safe_that_was_answered_503_never_takes_effect_and_a_danger_after_it_wins() {
    let mut bare = Bare::at_a_bag();
    bare.keeps = false;
    let ticket = bare.verdict(Verdict::Safe).unwrap();
    fails(&mut bare);
    assert_eq!(bare.answer(ticket), Some(Err(Refused::StoreDown)));
    bare.event(Event::StoreRestored);
    bare.keep();
    assert!(bare.state().luggage[0].is_pending());
    bare.keeps = true;
    bare.verdict(Verdict::Danger).unwrap();
    assert_eq!(bare.phase(), PhaseName::ReturningWithAlarm);
}

/// Safety V1: the operator who said SAFE is told of the danger, and the log shows it.
#[test]
fn a_safe_that_a_danger_overtakes_is_refused_and_the_log_says_so() {
    let mut bare = Bare::at_a_bag();
    bare.keeps = false;
    let (safe, danger) = (bare.verdict(Verdict::Safe).unwrap(), bare.verdict(Verdict::Danger).unwrap());
    bare.keep();
    // Confirms the effects of the danger, whose answer waits for them.
    bare.keep();
    let decided = Refused::Decided { luggage: LuggageId(1), verdict: Verdict::Danger };
    assert_eq!(bare.answer(safe), Some(Err(decided)));
    assert!(matches!(bare.answer(danger), Some(Ok(_))));
    assert!(
        bare.state().log.iter().any(|line| line.said.to_string().starts_with("a safe was overtaken, and so refused: luggage #1"))
    );
}

#[test]
fn a_piece_whose_record_was_lost_is_recorded_anew_when_the_store_is_back() {
    let mut bare = Bare::in_front_of(hallsweep_core::event::Obstacle::Unknown);
    bare.keeps = false;
    bare.photo();
    fails(&mut bare);
    assert!(bare.state().luggage.is_empty(), "nobody is asked about what is not on record");
    bare.effects.clear();
    bare.keeps = true;
    bare.event(Event::StoreRestored);
    assert!(bare.effects.iter().any(|effect| records(effect, |fact| matches!(fact, Fact::Luggage { photo: Some(_), .. }))));
    assert_eq!(bare.state().mission.inspected, Some(LuggageId(1)));
}

#[test]
fn a_start_whose_record_fails_is_answered_and_the_robot_stays_where_it_is() {
    let mut bare = Bare::linked();
    bare.keeps = false;
    let ticket = bare.give(Command::Start).unwrap();
    fails(&mut bare);
    assert_eq!(bare.answer(ticket), Some(Err(Refused::NotKept)));
    bare.keeps = true;
    bare.event(Event::StoreRestored);
    assert_eq!((bare.order(), bare.holds()), (None, vec![Hold::AwaitingStart]));
    bare.give(Command::Start).unwrap();
    assert!(bare.order().is_some());
}

#[test]
fn while_the_store_is_down_a_mission_is_not_put_away() {
    let mut bare = Bare::linked();
    bare.give(Command::Start).unwrap();
    bare.give(Command::Stop).unwrap();
    bare.halted();
    fails(&mut bare);
    assert_eq!(bare.give(Command::Reset), Err(Refused::StoreDown));
    assert_eq!(bare.phase(), PhaseName::Exploring);
}

/// Safety S2: every halt precedes every record of the same moment.
#[test]
fn halts_come_before_the_records_of_what_halted() {
    type Halting = fn(&mut Bare);
    let causes: [(&str, Halting); 4] = [
        ("stop", |bare| drop(bare.give(Command::Stop))),
        ("button", |bare| drop(bare.give(Command::Temperature(TemperatureReport::TooHigh)))),
        ("heat", |bare| bare.robot(hallsweep_core::event::RobotEvent::Temperature(hot()))),
        ("store", fails),
    ];
    for (name, cause) in causes {
        let mut bare = Bare::linked();
        bare.give(Command::Start).unwrap();
        bare.effects.clear();
        cause(&mut bare);
        assert_eq!(bare.effects.first(), Some(&Effect::Halt(RobotId::discovery())), "{name}");
    }
}

fn hot() -> hallsweep_core::units::Celsius {
    hallsweep_core::units::Celsius::new(40.0).unwrap()
}

/// A step that was decided but not sent is withdrawn by a halt and never sent after it.
#[test]
fn an_order_that_has_not_gone_out_never_follows_a_halt() {
    let mut bare = Bare::linked();
    bare.keeps = false;
    bare.give(Command::Start).unwrap();
    bare.effects.clear();
    let kept = Event::Recorded(hallsweep_core::units::Seq(1000));
    let now = hallsweep_core::units::Now::default();
    bare.engine.handle_event(kept, now);
    bare.engine.handle_event(Event::StoreFailed("disk full".to_owned()), now);
    let effects: Vec<Effect> = std::iter::from_fn(|| bare.engine.poll_effect()).collect();
    assert!(effects.contains(&Effect::Halt(RobotId::discovery())));
    assert!(!effects.iter().any(|effect| matches!(effect, Effect::Order(..))));
}
