//! Safety R1 and R2 in the core: the state is what is recorded. A program killed at any moment starts in its last
//! state, held, and continues after a START.

use std::sync::Arc;

use hallsweep_core::command::{Command, CommandId, Door, Issuer, LuggageRef, Request, Strategy, TemperatureReport, Verdict};
use hallsweep_core::effect::{Action, Effect};
use hallsweep_core::engine::{Engine, Recalled};
use hallsweep_core::event::{Obstacle, RobotEvent, Whereabouts};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::settings::{AfterDanger, Rules, Settings};
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::state::{PersistentState, Phase};
use hallsweep_core::units::{AlarmId, Cell, Celsius, LuggageId, Now, Piece, Pose, Seq};
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::bare::Bare;
use crate::halls;
use crate::mortal::Mortal;
use crate::operator::{Operator, in_hall};
use crate::random_commands::{any_command, from_outside};

/// Safety R1, D2.
#[test]
fn what_stands_follows_from_the_journal_alone() {
    for seed in 0..150 {
        let hall = halls::random(seed, 14);
        let mut dice = RandomStream::new(seed, "journal");
        let sim = SimSettings { unknown_rate: 0.1, photo_failure_rate: 0.2, ..SimSettings::new(seed, Camera::Stub) };
        let mut run = Run::new(hall, sim, Settings::default(), Default::default());
        let mut folded = Folded::default();
        for _ in 0..120 {
            let command = any_command(&mut dice, &mut run);
            let _ = run.give(command);
            if dice.below(10) == 0 {
                from_outside(&mut dice, &mut run);
            }
            folded.check(&run, seed);
            for _ in 0..dice.below(30) {
                run.advance();
            }
            folded.check(&run, seed);
        }
    }
}

#[test]
fn a_mission_after_a_mission_is_folded_from_its_own_beginning() {
    let mut run = in_hall("seed");
    for _ in 0..2 {
        run.give(Command::Start).unwrap();
        run.until_explored();
    }
    let fact = |entry: &Entry| matches!(entry.fact, Fact::State(_));
    let last = run.journal.iter().rposition(fact).expect("the second mission begins with everything that stands");
    let mut state = PersistentState::first(Default::default());
    run.journal[last..].iter().for_each(|entry| state.apply(entry));
    assert_eq!(state, run.engine.persistent_state());
    assert_eq!(state.mission.0, 2);
    assert!(state.luggage.iter().all(|luggage| luggage.verdict.as_ref().unwrap().verdict == Verdict::Safe));
}

/// Safety R1: holds that a person must end are as they were; holds with an external cause are raised again by that
/// cause.
#[test]
fn after_a_restart_the_robot_is_held_and_waits_for_a_start() {
    let mut mortal = Mortal::born(hall("empty-8x8"), SimSettings::new(1, Camera::Stub));
    mortal.give(Command::Start).unwrap();
    mortal.keep_all();
    mortal.give(Command::Temperature(TemperatureReport::TooHigh)).unwrap();
    mortal.give(Command::Stop).unwrap();
    mortal.keep_all();
    let before = mortal.state();
    let mut mortal = mortal.killed(0);
    let after = mortal.state();
    assert_eq!(after.mission.holds, [Hold::Operator, Hold::TooHigh, Hold::Restart, Hold::AwaitingStart]);
    assert_eq!((after.mission.phase, after.mission.goal), (before.mission.phase, before.mission.goal));
    assert_eq!((after.mission.epoch, after.mission.id), (before.mission.epoch, before.mission.id));
    assert!(after.robot.led_blinking && mortal.sim.led(), "the LED blinks through a restart");
    assert!(matches!(mortal.give(Command::Start), Err(Refused::Held(..))), "the button still stands");
    mortal.give(Command::Temperature(TemperatureReport::Ok)).unwrap();
    mortal.give(Command::Start).unwrap();
    mortal.keep_all();
    assert!(mortal.state().mission.holds.is_empty());
}

/// Safety R1: an idle robot is idle after a restart.
#[test]
fn an_idle_robot_is_idle_after_a_restart_and_a_start_begins_a_mission() {
    let mut mortal = Mortal::born(hall("empty-8x8"), SimSettings::new(1, Camera::Stub));
    mortal.give(Command::Acknowledge(AlarmId(9))).unwrap_err();
    mortal.keep_all();
    let mut mortal = mortal.killed(0);
    assert_eq!((mortal.state().mission.phase, &mortal.state().mission.holds[..]), (PhaseName::Idle, &[Hold::Restart][..]));
    mortal.give(Command::Start).unwrap();
    mortal.keep_all();
    assert_eq!(mortal.state().mission.phase, PhaseName::Exploring);
}

/// Safety R1: an operator's reading counts until the operator gives another, also across a restart.
#[test]
fn heat_that_the_operator_read_still_holds_after_a_restart() {
    let mut mortal = Mortal::born(hall("empty-8x8"), SimSettings::new(1, Camera::Stub));
    let reading = |degrees| Command::Temperature(TemperatureReport::Reading(Celsius::new(degrees).unwrap()));
    mortal.give(Command::Start).unwrap();
    mortal.give(reading(40.0)).unwrap();
    mortal.keep_all();
    let mut mortal = mortal.killed(0);
    assert!(matches!(mortal.give(Command::Start), Err(Refused::Held(holds, _)) if holds == [Hold::Temperature]));
    mortal.give(reading(20.0)).unwrap();
    mortal.give(Command::Start).unwrap();
}

/// Safety R2: the robot senses and returns to the centre of its cell before anything else.
#[test]
fn a_step_cut_short_by_a_kill_is_undone_first() {
    let mut mortal = Mortal::born(hall("empty-8x8"), SimSettings::new(1, Camera::Stub));
    mortal.give(Command::Start).unwrap();
    mortal.keep_all();
    mortal.advance();
    mortal.keep_all();
    let mut mortal = mortal.killed(0);
    assert!(mortal.state().robot.off_centre, "it was in the middle of a move");
    mortal.give(Command::Start).unwrap();
    mortal.keep_all();
    mortal.advance();
    assert!(!mortal.state().robot.off_centre);
}

/// Safety R1: a repeated command is recognised after a restart too.
#[test]
fn a_command_that_comes_again_after_a_restart_is_answered_and_does_not_act() {
    let named = |command| {
        let issuer = Issuer::operator(Door("http"));
        Request { id: CommandId::new("once"), ..Request::new(command, issuer) }
    };
    let mut mortal = Mortal::born(hall("empty-8x8"), SimSettings::new(1, Camera::Stub));
    mortal.ask(named(Command::Start)).unwrap();
    mortal.keep_all();
    let mut mortal = mortal.killed(0);
    let again = mortal.ask(named(Command::Start)).unwrap();
    assert!(mortal.answers[&again].is_ok());
    assert!(mortal.state().mission.holds.contains(&Hold::Restart), "it has not acted again");
    assert!(matches!(mortal.ask(named(Command::BackHome)), Err(Refused::OtherContent(_))));
}

/// A command that was refused because its id belonged to another does not take over the id after a restart.
#[test]
fn an_id_stands_for_its_first_command_after_a_restart_too() {
    let named = |command| Request { id: CommandId::new("once"), ..Request::new(command, Issuer::operator(Door("http"))) };
    let mut mortal = Mortal::born(hall("empty-8x8"), SimSettings::new(1, Camera::Stub));
    mortal.ask(named(Command::Start)).unwrap();
    mortal.ask(named(Command::BackHome)).unwrap_err();
    mortal.ask(named(Command::Stop)).expect("a stop is no use of an id");
    mortal.keep_all();
    let mut mortal = mortal.killed(0);
    assert!(mortal.ask(named(Command::Start)).is_ok());
    assert!(matches!(mortal.ask(named(Command::BackHome)), Err(Refused::OtherContent(_))));
}

/// Safety R1: a fault persists across a restart, and START returns to what the fault interrupted.
#[test]
fn a_fault_outlives_the_program_with_what_it_interrupted() {
    let mut bare = Bare::linked();
    bare.give(Command::Start).unwrap();
    bare.wait_in_vain();
    assert_eq!(bare.phase(), PhaseName::Fault);
    let recalled = Recalled {
        state: bare.engine.persistent_state(),
        written: Seq(100),
        commands: Vec::new(),
        kept_back: Vec::new(),
        latest: Vec::new(),
    };
    let mut again = Bare::linked();
    again.engine = Engine::recall(Settings::default(), "reborn".into(), recalled, Now::default());
    assert_eq!(again.phase(), PhaseName::Fault);
    assert_eq!(again.state().mission.fault, bare.state().mission.fault);
    again.link_up();
    again.give(Command::Start).unwrap();
    assert_eq!((again.phase(), again.order()), (PhaseName::Exploring, Some(Action::Recentre)));
}

/// A repeated bare command means the piece that it meant first, not the piece that waits now.
#[test]
fn a_bare_safe_that_comes_again_after_a_restart_decides_no_other_piece() {
    let named = |command| Request { id: CommandId::new("bare"), ..Request::new(command, Issuer::operator(Door("http"))) };
    let safe = || Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Safe, note: None, hot: Default::default() };
    let mut mortal = Mortal::born(hall("airport"), SimSettings::new(1, Camera::Stub));
    mortal.give(Command::Start).unwrap();
    let first = until_pending(&mut mortal);
    mortal.ask(named(safe())).unwrap();
    mortal.keep_all();
    let mut mortal = mortal.killed(0);
    mortal.give(Command::Start).unwrap();
    let second = until_pending(&mut mortal);
    assert_ne!(first, second);
    let again = mortal.ask(named(safe())).unwrap();
    assert_eq!(mortal.answers[&again].as_ref().unwrap().luggage, Some(first));
    mortal.keep_all();
    assert!(mortal.state().luggage(second).unwrap().is_pending(), "nobody has looked at it");
}

fn until_pending(mortal: &mut Mortal) -> LuggageId {
    loop {
        mortal.keep_all();
        if let Some(luggage) = mortal.state().pending().map(|luggage| luggage.id) {
            return luggage;
        }
        assert!(mortal.advance());
    }
}

/// A kill between the record of a danger and its effects: the effects follow after the start.
#[test]
fn a_danger_on_record_alarms_after_a_restart_although_nobody_was_told_before() {
    let mut mortal = Mortal::born(hall("seed"), SimSettings::new(1, Camera::Stub));
    mortal.give(Command::Start).unwrap();
    let pending = until_pending(&mut mortal);
    mortal
        .give(Command::Verdict {
            luggage: LuggageRef::Id(pending),
            verdict: Verdict::Danger,
            note: None,
            hot: Default::default(),
        })
        .unwrap();
    let mut mortal = mortal.killed(1);
    assert!(mortal.state().luggage(pending).unwrap().is_dangerous(), "that is on record");
    mortal.keep_all();
    let state = mortal.state();
    assert_eq!(state.mission.phase, PhaseName::ReturningWithAlarm);
    assert!(state.luggage(pending).unwrap().is_dangerous() && !state.robot.led_blinking);
    assert_eq!(state.alarms.len(), 1);
}

/// A search that goes on after a danger: a kill at any moment neither ends the search nor raises a second alarm.
#[test]
fn a_danger_after_which_the_search_goes_on_is_carried_out_once() {
    let rules = Rules { after_danger: AfterDanger::GoOn, ..Rules::default() };
    let settings = Settings { rules, ..Settings::default() };
    let mut carried_out = 0;
    for (told, durable) in (0..4).flat_map(|told| (0..4).map(move |durable| (told, durable))) {
        let mut mortal = Mortal::searching_by(Strategy::Auto, settings, hall("seed"), SimSettings::new(1, Camera::Stub));
        mortal.give(Command::Start).unwrap();
        let pending = until_pending(&mut mortal);
        mortal
            .give(Command::Verdict {
                luggage: LuggageRef::Id(pending),
                verdict: Verdict::Danger,
                note: None,
                hot: Default::default(),
            })
            .unwrap();
        for _ in 0..told {
            mortal.keep_one();
        }
        let mut mortal = mortal.killed(durable);
        mortal.keep_all();
        if mortal.state().luggage(pending).unwrap().is_pending() {
            continue;
        }
        mortal.give(Command::Acknowledge(AlarmId(1))).unwrap();
        mortal.keep_all();
        let mut mortal = mortal.killed(0);
        mortal.keep_all();
        let state = mortal.state();
        assert_eq!((state.mission.phase, state.alarms.len()), (PhaseName::Exploring, 1), "{told}, {durable}");
        assert!(state.robot.led_blinking && state.luggage(pending).unwrap().is_dangerous(), "{told}, {durable}");
        carried_out += 1;
    }
    assert!(carried_out > 8, "{carried_out}");
}

/// A robot that was carried home while the program was down does not photograph a piece that it no longer sees.
#[test]
fn a_robot_that_says_it_stands_elsewhere_has_left_its_inspection() {
    let mut bare = Bare::in_front_of(Obstacle::Luggage(Piece(1)));
    bare.takes_back();
    bare.robot(RobotEvent::LinkLost("carried away".to_owned()));
    bare.robot(RobotEvent::Stands(Whereabouts { pose: Pose::START, off_centre: false }));
    bare.link_up();
    assert_eq!((bare.phase(), bare.cell(), bare.order()), (PhaseName::Exploring, Cell::HOME, None));
    bare.give(Command::Start).unwrap();
    assert!(matches!(bare.order(), Some(Action::Move(_))));
}

/// An ended mission is closed when the robot is put into another hall.
#[test]
fn in_another_hall_everything_begins_anew_but_the_numbers() {
    let mut mortal = Mortal::born(hall("seed"), SimSettings::new(1, Camera::Stub));
    mortal.give(Command::Start).unwrap();
    while mortal.state().mission.phase != PhaseName::Explored {
        mortal.keep_all();
        match mortal.state().pending().map(|luggage| luggage.id) {
            Some(id) => drop(mortal.give(Command::Verdict {
                luggage: LuggageRef::Id(id),
                verdict: Verdict::Safe,
                note: None,
                hot: Default::default(),
            })),
            None => drop(mortal.advance()),
        }
    }
    mortal.keep_all();
    let mut engine = Engine::recall(Settings::default(), "elsewhere".into(), mortal.recalled(), Now::default());
    let before = engine.persistent_state();
    engine.put_down_elsewhere(Now::default());
    let after = engine.persistent_state();
    assert_eq!((after.phase.clone(), after.pose, after.map.visited(), after.luggage.len()), (Phase::Idle, Pose::START, 1, 0));
    assert_eq!((after.last_luggage, after.mission), (before.last_luggage, before.mission));
    let mut folded = before;
    while let Some(effect) = engine.poll_effect() {
        if let Effect::Record(page) = effect {
            page.entries.iter().for_each(|entry| folded.apply(entry));
        }
    }
    assert_eq!(folded, after);
}

fn hall(name: &str) -> Arc<Hall> {
    Arc::new(Hall::named_or_file(name).expect("the hall comes with the program"))
}

/// State folded from a growing journal.
struct Folded {
    state: PersistentState,
    read: usize,
}

impl Default for Folded {
    fn default() -> Folded {
        Folded { state: PersistentState::first(Default::default()), read: 0 }
    }
}

impl Folded {
    fn check(&mut self, run: &Run, seed: u64) {
        run.journal[self.read..].iter().for_each(|entry| self.state.apply(entry));
        self.read = run.journal.len();
        let (folded, live) = (&self.state, &run.engine.persistent_state());
        if folded != live {
            explain(folded, live, seed);
        }
    }
}

fn explain(folded: &PersistentState, live: &PersistentState, seed: u64) {
    assert_eq!(folded.map.changes_since(&live.map), [], "seed {seed}: the maps differ");
    let bare = |state: &PersistentState| format!("{:#?}", PersistentState { map: live.map.clone(), ..state.clone() });
    let (folded, live) = (bare(folded), bare(live));
    let differ: Vec<_> = folded.lines().zip(live.lines()).filter(|(folded, live)| folded != live).collect();
    panic!("seed {seed}: folded and live differ: {differ:#?}");
}
