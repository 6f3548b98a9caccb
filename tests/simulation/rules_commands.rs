//! Commands that are repeated under the same id, that contradict each other, or that come from before a STOP: each
//! acts once, and everything is recorded with its sender and origin (safety S4, V1, A6).

use std::sync::Arc;

use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, CommandId, Door, Issuer, LuggageRef, Note, Request, TemperatureReport, Verdict};
use hallsweep_core::effect::Effect;
use hallsweep_core::engine::IDS;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{Celsius, Epoch, LuggageId};

use crate::bare::{Bare, records};
use crate::operator::{Operator, in_hall};

fn named(id: &str, command: Command) -> Request {
    by("operator", id, command)
}

fn by(who: &str, id: &str, command: Command) -> Request {
    let issuer = Issuer { door: Door("http"), who: Arc::from(who), from: Arc::from("192.0.2.7") };
    Request { id: CommandId::new(id), ..Request::new(command, issuer) }
}

fn verdict(verdict: Verdict) -> Command {
    Command::Verdict { luggage: LuggageRef::Id(LuggageId(1)), verdict, note: None, hot: Default::default() }
}

#[test]
fn a_command_that_comes_again_is_answered_as_before_and_acts_once() {
    let mut run = in_hall("empty-8x8");
    let first = run.ask(named("a", Command::Start));
    run.until("some cells", |state| state.map.visited() > 5);
    run.give(Command::Stop).unwrap();
    run.stands_still();
    assert_eq!(run.ask(named("a", Command::Start)), first, "the same answer, the same revision");
    run.stands_still();
    run.ask(named("b", Command::Start)).unwrap();
    run.until_explored();
}

#[test]
fn a_refused_command_that_comes_again_is_refused_again_although_it_would_be_accepted_now() {
    let mut run = in_hall("empty-8x8");
    run.temperature(TemperatureReport::TooHigh).unwrap();
    let refused = run.ask(named("a", Command::Start));
    assert!(matches!(refused, Err(Refused::Held(..))));
    run.temperature(TemperatureReport::Ok).unwrap();
    assert_eq!(run.ask(named("a", Command::Start)), refused);
    assert_eq!(run.phase(), PhaseName::Idle);
}

#[test]
fn an_id_that_was_used_for_another_command_is_refused() {
    let mut run = in_hall("empty-8x8");
    run.ask(named("a", Command::Start)).unwrap();
    let other = run.ask(named("a", Command::BackHome));
    assert_eq!(other, Err(Refused::OtherContent(CommandId::new("a").unwrap())));
    assert_eq!(run.phase(), PhaseName::Exploring);
    run.ask(by("somebody else", "a", Command::BackHome)).expect("another sender's names are its own");
}

#[test]
fn an_id_that_was_used_in_another_epoch_is_refused() {
    let mut run = in_hall("empty-8x8");
    run.ask(named("a", Command::Start)).unwrap();
    let other = Request { epoch: Some(Epoch(0)), ..named("a", Command::Start) };
    assert!(matches!(run.ask(other), Err(Refused::OtherContent(_))));
}

/// Safety S1: whatever its id, and however often it is repeated.
#[test]
fn a_stop_is_never_taken_for_a_repeat() {
    let mut run = in_hall("empty-8x8");
    for _ in 0..3 {
        run.give(Command::Start).unwrap();
        run.wait(1.0);
        run.ask(named("a", Command::Stop)).unwrap();
        run.stands_still();
    }
    run.ask(named("b", Command::Start)).unwrap();
    run.ask(named("b", Command::Stop)).expect("an id that was used for another command does not refuse a stop");
    run.stands_still();
}

#[test]
fn only_so_many_ids_are_remembered() {
    let mut run = in_hall("empty-8x8");
    run.ask(named("first", Command::Start)).unwrap();
    for n in 0..IDS {
        run.ask(named(&format!("id-{n}"), Command::Temperature(TemperatureReport::Ok))).unwrap();
    }
    assert!(run.ask(named("first", Command::BackHome)).is_ok(), "it was forgotten");
}

/// Two commands that wait for the same record are answered together.
#[test]
fn a_verdict_that_is_sent_twice_before_it_is_kept_is_recorded_once() {
    let mut bare = Bare::at_a_bag();
    bare.keeps = false;
    let first = bare.ask(named("v", verdict(Verdict::Safe))).unwrap();
    let again = bare.ask(named("v", verdict(Verdict::Safe))).unwrap();
    assert_eq!((bare.answer(first), bare.answer(again)), (None, None));
    bare.keep_all();
    assert!(bare.answer(first).unwrap().is_ok());
    assert_eq!(bare.answer(first), bare.answer(again));
    let verdicts = bare.effects.iter().filter(|effect| records(effect, |fact| matches!(fact, Fact::Verdict { .. })));
    assert_eq!(verdicts.count(), 1);
}

/// Safety V1: when two operators press at the same moment, one verdict wins and the other operator gets the record.
#[test]
fn of_two_verdicts_at_the_same_moment_one_wins_and_the_other_is_told_so() {
    for (early, late, stands) in [
        (Verdict::Safe, Verdict::Danger, Verdict::Danger),
        (Verdict::Danger, Verdict::Safe, Verdict::Danger),
        (Verdict::Safe, Verdict::Safe, Verdict::Safe),
        (Verdict::Danger, Verdict::Danger, Verdict::Danger),
    ] {
        let mut bare = Bare::at_a_bag();
        bare.keeps = false;
        let first = bare.ask(by("anna", "1", verdict(early)));
        let second = bare.ask(by("ben", "1", verdict(late)));
        bare.keep_all();
        let answers = [(first, early), (second, late)].map(|(given, said)| {
            (given.and_then(|ticket| bare.answer(ticket).expect("every accepted command is answered")), said)
        });
        for (answer, said) in answers {
            let expected = if said == stands {
                answer.is_ok()
            } else {
                matches!(answer, Err(Refused::Decided { verdict, .. }) if verdict == stands)
            };
            assert!(expected, "{early:?} then {late:?}: {said:?} was answered {answer:?}");
        }
        assert_eq!(bare.state().luggage(LuggageId(1)).unwrap().verdict.as_ref().unwrap().verdict, stands);
    }
}

/// Safety V1: the note is as final as the verdict.
#[test]
fn an_equal_verdict_that_comes_later_does_not_change_the_note() {
    let noted = |verdict, note| Command::Verdict {
        luggage: LuggageRef::Id(LuggageId(1)),
        verdict,
        note: Note::new(note),
        hot: Default::default(),
    };
    for (early, late, stands) in [
        (Verdict::Safe, Verdict::Safe, "early"),
        (Verdict::Danger, Verdict::Danger, "early"),
        (Verdict::Safe, Verdict::Danger, "late"),
        (Verdict::Danger, Verdict::Safe, "early"),
    ] {
        let mut bare = Bare::at_a_bag();
        bare.keeps = false;
        bare.ask(by("anna", "1", noted(early, "early"))).unwrap();
        // Another test checks which verdict is accepted.
        let _ = bare.ask(by("ben", "1", noted(late, "late")));
        bare.keep_all();
        let _ = bare.ask(by("ben", "2", noted(late, "too late")));
        bare.keep_all();
        let state = bare.state();
        let decision = state.luggage(LuggageId(1)).unwrap().verdict.as_ref().unwrap();
        assert_eq!(decision.note.as_ref().map(Note::text), Some(stands), "{early:?} then {late:?}");
    }
}

/// Safety A6.
#[test]
fn accepted_or_refused_every_command_is_on_record_with_who_and_from_where() {
    let mut bare = Bare::linked();
    bare.ask(named("a", Command::Start)).unwrap();
    bare.ask(by("mallory", "b", Command::Retrieve(None))).unwrap_err();
    let outdated = Request { epoch: Some(Epoch(0)), ..named("c", Command::BackHome) };
    bare.give(Command::Stop).unwrap();
    bare.ask(outdated).unwrap_err();
    for (who, command, code) in
        [("operator", "START", None), ("mallory", "RETRIEVE", Some("notInPhase")), ("operator", "BACK HOME", Some("outdated"))]
    {
        let written = |fact: &Fact| match fact {
            Fact::Command { issuer, asked, refused, .. } => {
                let refused = refused.as_ref().map(Refused::code);
                (&*issuer.who, &*asked.to_string(), refused) == (who, command, code) && &*issuer.from == "192.0.2.7"
            }
            _ => false,
        };
        assert!(bare.effects.iter().any(|effect| records(effect, written)), "{who}: {command}");
    }
    let log = bare.state().log.iter().map(|line| line.said.to_string()).collect::<Vec<_>>().join("\n");
    assert!(log.contains("START, by operator (http, 192.0.2.7)"), "{log}");
    assert!(log.contains("RETRIEVE refused, by mallory (http, 192.0.2.7): "), "{log}");
}

/// Safety A6: commands that came while nothing could be written are written afterwards.
#[test]
fn commands_that_came_while_the_store_was_down_are_on_record_when_it_is_back() {
    use hallsweep_core::event::Event;
    let mut bare = Bare::linked();
    bare.keeps = false;
    bare.event(Event::StoreFailed("disk full".to_owned()));
    bare.ask(by("mallory", "b", Command::Start)).unwrap_err();
    bare.effects.clear();
    bare.event(Event::StoreRestored);
    let mallory = |fact: &Fact| matches!(fact, Fact::Command { issuer, .. } if &*issuer.who == "mallory");
    let told = |effect: &&Effect| records(effect, mallory);
    assert_eq!(bare.effects.iter().filter(told).count(), 0, "the store has it still, and keeps it now");
}

/// Safety A6: commands that were lost when the store failed are written once more, as they were answered.
#[test]
fn a_command_that_was_lost_with_the_store_is_on_record_once_and_as_it_was_answered() {
    use hallsweep_core::event::Event;
    let mut bare = Bare::linked();
    bare.keeps = false;
    let start = bare.ask(named("s", Command::Start)).unwrap();
    bare.event(Event::StoreFailed("disk full".to_owned()));
    assert_eq!(bare.answer(start), Some(Err(Refused::NotKept)));
    bare.effects.clear();
    bare.event(Event::StoreRestored);
    let started = |fact: &Fact| matches!(fact, Fact::Command { asked: Asked::Command(Command::Start), .. });
    let refused = |fact: &Fact| started(fact) && matches!(fact, Fact::Command { refused: Some(Refused::NotKept), .. });
    assert_eq!(bare.effects.iter().filter(|effect| records(effect, refused)).count(), 1);
    assert_eq!(bare.effects.iter().filter(|effect| records(effect, started)).count(), 1);
}

/// A sender of endless readings cannot keep the robot from moving.
#[test]
fn a_reading_that_is_not_on_record_yet_does_not_hold_the_robot_up() {
    let mut bare = Bare::linked();
    bare.give(Command::Start).unwrap();
    bare.keeps = false;
    let reading = Command::Temperature(TemperatureReport::Reading(Celsius::new(20.0).unwrap()));
    let order = bare.takes_back().expect("it drives");
    bare.robot(hallsweep_core::event::RobotEvent::Done(order.id));
    bare.keep();
    assert!(bare.order().is_some(), "the move is on record: the next one begins");
    let order = bare.takes_back().expect("it drives");
    bare.give(reading.clone()).unwrap();
    bare.robot(hallsweep_core::event::RobotEvent::Done(order.id));
    let before = bare.written;
    bare.give(reading).unwrap();
    bare.event(hallsweep_core::event::Event::Recorded(before));
    assert!(bare.order().is_some(), "only the reading is not on record yet");
}

/// A client that was told to try again later may use the same id.
#[test]
fn a_danger_that_could_not_be_recorded_is_taken_when_the_store_is_back() {
    use hallsweep_core::event::Event;
    let mut bare = Bare::at_a_bag();
    bare.event(Event::StoreFailed("disk full".to_owned()));
    assert_eq!(bare.ask(named("d", verdict(Verdict::Danger))), Err(Refused::StoreDown));
    bare.event(Event::StoreRestored);
    bare.keep();
    bare.ask(named("d", verdict(Verdict::Danger))).expect("the store is back");
    assert!(bare.state().luggage(LuggageId(1)).unwrap().is_dangerous());
}

/// Nothing is acknowledged that is not recorded, but a command that makes the robot safer still acts.
#[test]
fn while_the_store_is_down_only_a_stop_is_accepted() {
    use hallsweep_core::event::Event;
    use hallsweep_core::hold::Hold;
    use hallsweep_core::units::AlarmId;
    let mut bare = Bare::at_a_bag();
    bare.verdict(Verdict::Danger).unwrap();
    bare.event(Event::StoreFailed("disk full".to_owned()));
    for command in [
        Command::Acknowledge(AlarmId(1)),
        Command::Temperature(TemperatureReport::Ok),
        Command::Temperature(TemperatureReport::TooHigh),
        Command::Start,
        Command::Reset,
    ] {
        assert!(bare.give(command.clone()).is_err(), "{command:?}");
    }
    assert!(bare.holds().contains(&Hold::TooHigh), "the button counts although it is not on record");
    assert!(bare.state().alarms[0].acknowledged.is_none());
    let stop = bare.give(Command::Stop).unwrap();
    bare.halted();
    assert!(bare.answer(stop).unwrap().is_ok());
    let again = bare.verdict(Verdict::Danger).expect("it is on record already");
    assert!(bare.answer(again).unwrap().is_ok());
}

/// Two readings that are printed alike still differ, and so do readings of two sensors.
#[test]
fn an_id_that_was_used_for_another_reading_is_refused() {
    let mut run = in_hall("empty-8x8");
    let reading = |degrees| Command::Temperature(TemperatureReport::Reading(Celsius::new(degrees).unwrap()));
    run.ask(named("r", reading(25.04))).unwrap();
    assert!(matches!(run.ask(named("r", reading(24.96))), Err(Refused::OtherContent(_))));
}
