//! Mission §4 and safety R1 on what must not be passed over: a danger that could not be recorded, unacknowledged
//! alarms, and faults whose cause persists; also on what is known after the store failed or the program was killed.

use std::sync::Arc;

use hallsweep_core::command::{Command, CommandId, Door, Issuer, Request, TemperatureReport, Verdict};
use hallsweep_core::effect::Effect;
use hallsweep_core::engine::{Engine, IDS, Recalled};
use hallsweep_core::event::{Event, Obstacle};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::{FaultCause, PhaseName};
use hallsweep_core::refused::Refused;
use hallsweep_core::settings::Settings;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::state::{PersistentState, Phase};
use hallsweep_core::units::{AlarmId, Cell, LuggageId, Now, Pose, Revision, Seq};
use hallsweep_core::world::alarm::Alarm;
use hallsweep_core::world::hall_map::Mark;

use crate::bare::Bare;

/// Program that starts with this state.
fn reborn(state: PersistentState) -> Bare {
    let recalled = Recalled { state, written: Seq(1000), commands: Vec::new(), kept_back: Vec::new(), latest: Vec::new() };
    let mut bare = Bare::unlinked();
    bare.engine = Engine::recall(Settings::default(), "reborn".into(), recalled, Now::default());
    bare.link_up();
    bare
}

fn named(id: &str, command: Command) -> Request {
    Request { id: CommandId::new(id), ..Request::new(command, Issuer::operator(Door("http"))) }
}

/// Robot before a piece that was judged dangerous while nothing could be recorded; the store works again.
fn danger_was_lost() -> Bare {
    let mut bare = Bare::at_a_bag();
    bare.event(Event::StoreFailed("disk full".to_owned()));
    assert_eq!(bare.verdict(Verdict::Danger), Err(Refused::StoreDown));
    bare.event(Event::StoreRestored);
    bare.keep();
    bare
}

/// Mission §4: SAFE and START from another operator do not pass over an earlier danger.
#[test]
fn danger_that_could_not_be_recorded_holds_the_robot_until_its_alarm_is_acknowledged() {
    let mut bare = danger_was_lost();
    assert_eq!(bare.holds(), [Hold::Alarm, Hold::AwaitingStart]);
    bare.verdict(Verdict::Safe).unwrap();
    assert_eq!(bare.phase(), PhaseName::Exploring);
    for command in [Command::Start, Command::BackHome, Command::Goto(Cell::HOME)] {
        assert_eq!(bare.give(command), Err(Refused::Held(vec![Hold::Alarm], None)));
    }
    assert_eq!(bare.order(), None);
    bare.give(Command::Acknowledge(AlarmId(1))).unwrap();
    assert_eq!((bare.holds(), bare.order()), (vec![Hold::AwaitingStart], None), "clearing a hold moves nothing");
    bare.give(Command::Start).unwrap();
    assert!(bare.order().is_some());
}

/// Mission §4.
#[test]
fn the_hold_of_an_alarm_stands_although_that_of_another_piece_is_acknowledged() {
    let mut state = danger_was_lost().engine.persistent_state();
    let other = Alarm { id: AlarmId(2), luggage: Some(LuggageId(2)), ..Alarm::clone(&state.alarms[0]) };
    state.alarms.push(Arc::new(other));
    for (acknowledged, holds) in [(&[2][..], true), (&[2, 1], false), (&[1], true), (&[1, 2], false)] {
        let mut bare = reborn(state.clone());
        for alarm in acknowledged {
            bare.give(Command::Acknowledge(AlarmId(*alarm))).unwrap();
        }
        assert_eq!(bare.holds().contains(&Hold::Alarm), holds, "{acknowledged:?}");
    }
}

#[test]
fn danger_that_is_said_again_and_recorded_ends_the_hold() {
    let mut bare = danger_was_lost();
    bare.verdict(Verdict::Danger).unwrap();
    assert_eq!((bare.phase(), bare.holds()), (PhaseName::ReturningWithAlarm, vec![Hold::AwaitingStart]));
    bare.give(Command::Start).unwrap();
    assert!(bare.order().is_some());
}

#[test]
fn a_danger_whose_record_fails_on_its_way_holds_too() {
    let mut bare = Bare::at_a_bag();
    bare.keeps = false;
    bare.verdict(Verdict::Danger).unwrap();
    bare.event(Event::StoreFailed("disk full".to_owned()));
    assert_eq!(bare.holds(), [Hold::Store, Hold::Alarm, Hold::AwaitingStart]);
}

/// Safety R1.
#[test]
fn the_hold_of_an_alarm_stands_after_a_restart() {
    let mut bare = reborn(danger_was_lost().engine.persistent_state());
    assert_eq!(bare.holds(), [Hold::Restart, Hold::Alarm, Hold::AwaitingStart]);
    bare.verdict(Verdict::Safe).unwrap();
    assert_eq!(bare.give(Command::Start), Err(Refused::Held(vec![Hold::Alarm], None)));
    bare.give(Command::Acknowledge(AlarmId(1))).unwrap();
    bare.give(Command::Start).unwrap();
}

/// Safety R1.
#[test]
fn an_unacknowledged_alarm_stands_after_a_restart_and_an_acknowledged_one_stays_so() {
    let mut bare = Bare::at_a_bag();
    bare.verdict(Verdict::Danger).unwrap();
    let mut bare = reborn(bare.engine.persistent_state());
    let alarms = bare.state().alarms.to_vec();
    assert_eq!((alarms.len(), alarms[0].id, alarms[0].luggage), (1, Some(AlarmId(1)), Some(LuggageId(1))));
    assert!(alarms[0].acknowledged.is_none());
    assert_eq!(bare.give(Command::Reset), Err(Refused::BombUnfetched(LuggageId(1))));
    bare.give(Command::Acknowledge(AlarmId(1))).unwrap();
    assert!(reborn(bare.engine.persistent_state()).state().alarms[0].acknowledged.is_some());
}

/// Safety A6: each lost command, in order, once.
#[test]
fn every_command_lost_with_the_store_is_recorded_again() {
    let mut bare = Bare::linked();
    bare.keeps = false;
    let commands = [Command::Start, Command::Retrieve(None), Command::Stop, Command::Reset, Command::Start, Command::BackHome];
    for (n, command) in commands.into_iter().enumerate() {
        let _ = bare.ask(named(&format!("c{n}"), command));
    }
    bare.event(Event::StoreFailed("disk full".to_owned()));
    bare.effects.clear();
    bare.event(Event::StoreRestored);
    let pages = bare.effects.iter().filter_map(|effect| match effect {
        Effect::Record(page) => Some(&page.entries),
        _ => None,
    });
    let ids: Vec<_> = pages
        .flatten()
        .filter_map(|entry| match &entry.fact {
            Fact::Command { id: Some(id), .. } => Some(id.text().to_owned()),
            _ => None,
        })
        .collect();
    assert_eq!(ids, ["c0", "c1", "c2", "c3", "c4", "c5"]);
}

/// Mission §4, rule 4: the robot is already home.
#[test]
fn danger_on_a_piece_without_a_photo_after_the_end_of_the_search_locates_the_bomb() {
    let mut bare = Bare::in_front_of(Obstacle::Unknown);
    bare.photo_fails();
    let ended =
        PersistentState { phase: Phase::Explored, pose: Pose::START, led_blinking: false, ..bare.engine.persistent_state() };
    let mut bare = reborn(ended);
    assert_eq!(bare.verdict(Verdict::Safe), Err(Refused::NoPhoto(LuggageId(1))));
    bare.verdict(Verdict::Danger).unwrap();
    assert_eq!(bare.phase(), PhaseName::BombLocated);
    assert_eq!(bare.state().alarms.len(), 1);
}

/// Mission §4, rule 2.
#[test]
fn start_is_refused_while_the_cause_of_a_fault_stands_and_goes_back_once_it_is_gone() {
    let mut state = PersistentState::first(Default::default());
    let fault = Phase::Fault { cause: FaultCause::NoWayHome, interrupted: Box::new(Phase::ReturningHome) };
    state.pose = Pose { cell: Cell::new(0, 2), ..Pose::START };
    (state.phase, state.under_way) = (fault, true);
    state.map.mark(Cell::new(0, 2), Mark::Visited, Revision(1));
    let mut bare = reborn(state.clone());
    assert!(matches!(bare.give(Command::Start), Err(Refused::FaultStands(_))));
    assert_eq!((bare.phase(), bare.order()), (PhaseName::Fault, None));
    state.map.mark(Cell::new(0, 1), Mark::Visited, Revision(1));
    let mut bare = reborn(state);
    bare.give(Command::Start).unwrap();
    assert_eq!(bare.phase(), PhaseName::ReturningHome);
}

/// Mission §4: the refusal names the reasons.
#[test]
fn retrieve_while_held_names_the_hold() {
    let mut bare = Bare::at_home_with_a_pending_bag();
    bare.verdict(Verdict::Danger).unwrap();
    assert_eq!(bare.phase(), PhaseName::BombLocated);
    assert_eq!(bare.give(Command::Retrieve(None)), Err(Refused::NoRetrievalRobot));
    bare.give(Command::Temperature(TemperatureReport::TooHigh)).unwrap();
    assert_eq!(bare.give(Command::Retrieve(None)), Err(Refused::Held(vec![Hold::TooHigh], None)));
}

#[test]
fn exactly_1024_commands_are_remembered() {
    assert_eq!(IDS, 1024);
    let mut bare = Bare::linked();
    let ok = || Command::Temperature(TemperatureReport::Ok);
    for n in 0..1024 {
        bare.ask(named(&format!("id-{n}"), ok())).unwrap();
    }
    assert!(matches!(bare.ask(named("id-0", Command::BackHome)), Err(Refused::OtherContent(_))), "the oldest is known");
    bare.ask(named("one-more", ok())).unwrap();
    assert!(matches!(bare.ask(named("id-1", Command::BackHome)), Err(Refused::OtherContent(_))));
    assert!(matches!(bare.ask(named("id-0", Command::BackHome)), Err(Refused::NotInPhase(_))), "the oldest gave way");
}

/// Safety R2: only a robot that may have been moving has to find the centre of its cell.
#[test]
fn killed_at_rest_it_is_not_off_centre() {
    let off_centre = |state| {
        let recalled = Recalled { state, written: Seq(1000), commands: Vec::new(), kept_back: Vec::new(), latest: Vec::new() };
        Engine::recall(Settings::default(), Arc::from("reborn"), recalled, Now::default()).snapshot().robot.off_centre
    };
    let inspecting = Bare::at_a_bag().engine.persistent_state();
    assert!(!off_centre(inspecting.clone()));
    for phase in [Phase::Idle, Phase::AtHome, Phase::BombLocated, Phase::BagSecured, Phase::Explored] {
        let state = PersistentState { phase, ..inspecting.clone() };
        assert!(!off_centre(state.clone()), "{:?}", state.phase);
    }
    for phase in [Phase::Exploring, Phase::ReturningHome, Phase::ReturningWithAlarm, Phase::Retrieving] {
        let state = PersistentState { phase, ..inspecting.clone() };
        assert!(off_centre(state.clone()), "{:?}", state.phase);
    }
}
