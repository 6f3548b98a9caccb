//! Safety R4: effects of commands and finds are shown when they are recorded; warnings, halts, pose and readings are
//! shown at once.

use hallsweep_core::command::{Command, TemperatureReport, Verdict};
use hallsweep_core::effect::Effect;
use hallsweep_core::event::{Event, Obstacle, RobotEvent};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::RobotId;
use hallsweep_core::units::{AlarmId, Celsius, LuggageId, MissionId, Piece};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_core::world::resource::Resource;

use crate::bare::Bare;

/// Robot whose store hangs from now on.
fn hanging(mut bare: Bare) -> Bare {
    bare.keeps = false;
    bare.effects.clear();
    bare
}

#[test]
fn a_start_shows_nothing_before_it_is_on_record() {
    let mut bare = hanging(Bare::linked());
    let before = bare.state();
    let ticket = bare.give(Command::Start).unwrap();
    let state = bare.state();
    assert_eq!((state.mission.id, state.mission.phase, state.robot.led_blinking), (MissionId(0), PhaseName::Idle, false));
    assert_eq!((state.mission.goal, state.mission.route.len()), (None, 0));
    assert_eq!(state.log.len(), before.log.len(), "the log does not tell either");
    assert!(!bare.effects.contains(&Effect::Led(RobotId::discovery(), true)), "nor does the LED");
    assert_eq!(bare.answer(ticket), None);
    bare.keep();
    let state = bare.state();
    assert_eq!((state.mission.id, state.mission.phase, state.robot.led_blinking), (MissionId(1), PhaseName::Exploring, true));
    assert!(state.log.iter().any(|line| line.said.to_string() == "idle → exploring"));
    assert!(bare.effects.contains(&Effect::Led(RobotId::discovery(), true)));
    let answered = bare.answer(ticket).expect("it is on record").unwrap();
    assert!(answered.revision <= state.revision && answered.revision >= state.revision_of(Resource::Log));
}

/// The state that an answer names contains the effect of the command, including the effects of its record.
#[test]
fn the_state_of_an_answered_verdict_has_the_verdict_and_all_that_followed() {
    let mut bare = hanging(Bare::at_a_bag());
    let ticket = bare.verdict(Verdict::Danger).unwrap();
    assert!(bare.state().luggage[0].is_pending());
    let verdict = bare.written;
    bare.event(Event::Recorded(verdict));
    assert_eq!((bare.answer(ticket), bare.phase()), (None, PhaseName::Inspecting));
    assert!(bare.state().alarms.iter().all(|alarm| alarm.id.is_none()) && bare.state().alarms.len() == 1);
    bare.keep();
    assert!(bare.answer(ticket).unwrap().is_ok());
    let state = bare.state();
    assert!(state.luggage[0].is_dangerous() && state.mission.phase == PhaseName::ReturningWithAlarm);
    assert_eq!(state.alarms[0].id, Some(AlarmId(1)));
}

/// The effects of a verdict may be lost although the verdict is stored: the verdict counts and is not answered with
/// 503.
#[test]
fn a_verdict_that_is_kept_is_answered_so_and_shown_although_what_follows_is_lost() {
    let mut bare = hanging(Bare::at_a_bag());
    let ticket = bare.verdict(Verdict::Safe).unwrap();
    bare.event(Event::Recorded(bare.written));
    bare.event(Event::StoreFailed("disk full".to_owned()));
    let answered = bare.answer(ticket).expect("nobody waits for a store that failed").expect("it is on record");
    let state = bare.state();
    assert!(!state.luggage[0].is_pending() && answered.revision <= state.revision);
    assert_eq!(state.mission.phase, PhaseName::Inspecting, "that it goes on is not on record");
    bare.event(Event::StoreRestored);
    bare.keep();
    assert_eq!(bare.phase(), PhaseName::Exploring);
}

#[test]
fn a_piece_is_shown_when_it_is_on_record_and_the_obstacle_at_once() {
    let mut bare = Bare::linked();
    bare.give(Command::Start).unwrap();
    bare.done();
    bare.until_forward();
    let mut bare = hanging(bare);
    bare.meets(Obstacle::Luggage(Piece(1)));
    let state = bare.state();
    assert_eq!(state.mission.phase, PhaseName::Exploring);
    assert!(state.map.known().any(|(_, mark)| mark == Mark::NotInspected), "where it must not drive is shown at once");
    bare.keep();
    bare.done();
    bare.keep();
    bare.photo();
    assert!(bare.state().luggage.is_empty());
    bare.keep();
    bare.keep();
    let state = bare.state();
    assert_eq!((state.luggage[0].id, state.mission.inspected), (LuggageId(1), Some(LuggageId(1))));
}

#[test]
fn what_warns_or_halts_is_shown_at_once() {
    let mut bare = Bare::linked();
    bare.give(Command::Start).unwrap();
    let mut bare = hanging(bare);
    bare.robot(RobotEvent::Temperature(Celsius::new(40.0).unwrap()));
    let state = bare.state();
    assert!(state.mission.holds.contains(&Hold::Temperature) && state.temperature.celsius.is_some());
    assert!(state.mission.refusals.start.as_ref().is_some_and(|refused| matches!(refused, Refused::Held(..))));
    assert!(state.log.iter().any(|line| line.said.to_string().starts_with("held: a reading is above")));
    bare.takes_back();
    bare.wait_in_vain();
    let state = bare.state();
    assert_eq!((state.mission.phase, state.mission.interrupted), (PhaseName::Fault, Some(PhaseName::Exploring)));
    assert!(state.mission.fault.is_some());
    let epoch = state.mission.epoch;
    bare.give(Command::Stop).unwrap();
    let state = bare.state();
    assert!(state.mission.holds.contains(&Hold::Operator) && state.mission.epoch > epoch);
}

#[test]
fn a_hold_that_a_command_cleared_is_shown_until_that_is_on_record() {
    let mut bare = Bare::linked();
    bare.give(Command::Temperature(TemperatureReport::TooHigh)).unwrap();
    let mut bare = hanging(bare);
    bare.give(Command::Temperature(TemperatureReport::Ok)).unwrap();
    assert_eq!(bare.holds(), [Hold::TooHigh]);
    bare.keep();
    assert_eq!(bare.holds(), []);
}

/// The button shown would do what it says, and its refusal reveals nothing that is not recorded.
#[test]
fn what_a_button_is_refused_with_tells_nothing_that_is_not_on_record() {
    let mut bare = hanging(Bare::linked());
    bare.give(Command::Start).unwrap();
    let refusals = bare.state().mission.refusals.clone();
    assert_eq!(refusals.start, None, "a repeat is accepted");
    assert_eq!(refusals.back_home, Some(Refused::NotInPhase(PhaseName::Idle)));
    assert_eq!(refusals.strategy, Some(Refused::NotOnRecord));
    assert!(bare.give(Command::ChooseStrategy(Default::default())).is_err());
}

/// An alarm that is not recorded is shown without a number, because nobody may refer to a number that can still be
/// lost.
#[test]
fn an_alarm_is_shown_at_once_and_has_its_number_when_it_is_on_record() {
    let mut bare = Bare::at_a_bag();
    bare.event(Event::StoreFailed("disk full".to_owned()));
    bare.keeps = false;
    assert_eq!(bare.verdict(Verdict::Danger), Err(Refused::StoreDown));
    let state = bare.state();
    assert_eq!((state.alarms.len(), state.alarms[0].id, state.alarms[0].is_recorded()), (1, None, false));
    assert_eq!(bare.give(Command::Acknowledge(AlarmId(1))), Err(Refused::UnknownAlarm(AlarmId(1))));
    bare.event(Event::StoreRestored);
    assert_eq!(bare.state().alarms[0].id, None);
    bare.keep();
    assert_eq!(bare.state().alarms[0].id, Some(AlarmId(1)));
}

/// The map of the last search stays until the next mission is recorded; then the whole map counts as new.
#[test]
fn the_map_is_emptied_when_the_new_mission_is_on_record() {
    let mut bare = Bare::linked();
    bare.give(Command::Start).unwrap();
    bare.done();
    bare.until_forward();
    bare.give(Command::Stop).unwrap();
    bare.done();
    bare.give(Command::Start).unwrap();
    bare.give(Command::BackHome).unwrap();
    bare.drive_on();
    bare.give(Command::Stop).unwrap();
    let mut bare = hanging(bare);
    let known = bare.state().map.known().count();
    assert!(known > 1);
    bare.give(Command::Reset).unwrap();
    assert_eq!(bare.state().map.known().count(), known);
    let before = bare.state().revision;
    bare.keep();
    let state = bare.state();
    assert_eq!(state.map.known().count(), 1);
    assert!(state.revision_of(Resource::Map) > before && state.map.tiles().all(|(_, tile)| tile.revision > before));
}

/// Entries after a loss are stored before the lost ones are recorded again.
#[test]
fn after_a_loss_nothing_is_shown_before_everything_is_on_record_anew() {
    let mut bare = hanging(Bare::linked());
    bare.give(Command::Start).unwrap();
    bare.event(Event::StoreFailed("disk full".to_owned()));
    bare.give(Command::Stop).unwrap();
    bare.keep();
    assert_eq!((bare.phase(), bare.state().mission.id), (PhaseName::Idle, MissionId(0)), "the stop is kept, the start is not");
    bare.event(Event::StoreRestored);
    assert_eq!(bare.phase(), PhaseName::Idle);
    bare.keep();
    assert_eq!((bare.phase(), bare.state().mission.id), (PhaseName::Exploring, MissionId(1)));
}
