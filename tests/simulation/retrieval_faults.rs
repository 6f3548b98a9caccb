//! Retrievals that cannot continue: each ends in a fault that states the reason, no robot that can leave stays in the
//! hall, and START tries once more.

use std::sync::Arc;
use std::time::Duration;

use behaviour_trees::Status;
use hallsweep_core::arm::{ArmAction, Gripper, Parcel};
use hallsweep_core::command::{Command, LuggageRef, Verdict};
use hallsweep_core::effect::Action;
use hallsweep_core::not_fetched::Fetcher;
use hallsweep_core::pair::Which;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::place::Place;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Cell, Piece};
use hallsweep_sim::pair::{Mishaps, PairSettings};
use hallsweep_sim::{Camera, Hall, SimSettings, Truth};

use crate::trio::{Delays, Spoiled, Spoils, Trio};

/// Number of events that exceeds any retrieval in this hall.
const LONG: usize = 100_000;

/// Delays that separate messages sent at the same moment.
const DELAYS: Delays = Delays { reports_ms: [20; 3], orders_ms: 10, disk_ms: 10 };

/// Command that closes a gripper or a hook.
const CLOSE: Action = Action::Arm(ArmAction::CloseGripper);

fn hall() -> Arc<Hall> {
    Arc::new(Hall::named_or_file("seed").expect("it comes with the program"))
}

fn trio(rules: Settings, sim: SimSettings, mishaps: Mishaps) -> Trio {
    let sim = SimSettings { sonar_noise_cm: 0.0, ..sim };
    let pair = PairSettings { way_out: true, mishaps, ..PairSettings::new(1, Place::ENTRANCE) };
    Trio::ruled(rules, hall(), sim, pair, DELAYS)
}

fn usual() -> SimSettings {
    SimSettings::new(1, Camera::Stub)
}

/// Continues until `is_so` is true.
fn until(trio: &mut Trio, what: &str, is_so: impl Fn(&Trio, &Snapshot) -> bool) {
    for _ in 0..LONG {
        let state = trio.state();
        if is_so(trio, &state) {
            return;
        }
        assert!(trio.advance(), "nothing happens before {what}: {:?}", state.mission);
    }
    panic!("{what} never comes: {:?} {:?}", trio.state().mission, trio.state().retrieval);
}

fn must(trio: &mut Trio, command: Command) {
    let given = trio.give(command.clone());
    assert!(given.is_ok(), "{command:?}: {given:?} {:?}", trio.state().mission);
    let end = trio.now() + Duration::from_millis(DELAYS.disk_ms);
    while trio.advance_to(end) {}
}

fn can_start(state: &Snapshot) -> bool {
    state.mission.refusals.start.is_none()
}

/// Gives the verdict danger to the first piece and sends the robots that fetch.
fn sent(mut trio: Trio) -> Trio {
    until(&mut trio, "all are linked", |_, state| can_start(state));
    must(&mut trio, Command::Start);
    until(&mut trio, "a photo", |_, state| state.pending().is_some_and(|piece| piece.has_photo()));
    let piece = trio.state().pending().expect("it is there").id;
    must(
        &mut trio,
        Command::Verdict { luggage: LuggageRef::Id(piece), verdict: Verdict::Danger, note: None, hot: Default::default() },
    );
    until(&mut trio, "discovery is home", |trio, state| state.mission.phase == PhaseName::BombLocated && trio.is_quiet());
    must(&mut trio, Command::Retrieve(None));
    trio
}

fn stage(state: &Snapshot) -> &'static str {
    state.retrieval.as_ref().map_or("none", |retrieval| retrieval.stage)
}

fn carried(trio: &mut Trio) {
    until(trio, "the bag is lifted", |trio, _| trio.pair.load().is_some() && trio.pair.arm(Which::Srm1).lifted);
}

fn ended(trio: &mut Trio) -> Arc<Snapshot> {
    until(trio, "an end", |trio, state| {
        matches!(state.mission.phase, PhaseName::BagSecured | PhaseName::Fault) && trio.is_quiet()
    });
    trio.state()
}

/// Checks that the pair is outside with open grippers and discovery is home.
fn check_nobody_is_left_inside(trio: &mut Trio, why: &str) {
    let state = trio.state();
    for which in Which::ALL {
        assert!(trio.pair.stands(which).0.place.cell().is_none(), "{why}: {which:?} is in the hall");
        assert_eq!((trio.pair.arm(which).gripper, trio.pair.load()), (Gripper::Open, None), "{why}");
    }
    assert_eq!((state.robot.pose.cell, state.robot.outside), (Cell::HOME, 0), "{why}");
}

fn check_fault(trio: &mut Trio, words: &str) {
    let state = ended(trio);
    assert_eq!(state.mission.phase, PhaseName::Fault, "{:?}", state.retrieval);
    assert!(
        state.mission.fault.as_ref().is_some_and(|fault| fault.to_string().contains(words)),
        "{words}: {:?}",
        state.mission.fault
    );
}

fn check_secured(trio: &mut Trio) {
    let state = ended(trio);
    assert_eq!(state.mission.phase, PhaseName::BagSecured, "{:?}", state.mission.fault);
    assert_eq!(trio.pair.taken_in().len(), 1);
    check_nobody_is_left_inside(trio, "it is secured");
}

/// Retrieval until the trees give up because the loaded pair cannot move.
fn failed_under_way() -> Trio {
    let mut trio = sent(trio(Settings::default(), usual(), Mishaps::default()));
    carried(&mut trio);
    trio.spoils = |index, action| (index > 0 && action.moves_base()).then_some(Spoiled::Fails);
    until(&mut trio, "the trees give up", |_, state| stage(state) == "goingOut");
    trio.spoils = |_, _| None;
    trio
}

#[test]
fn what_is_in_the_grip_when_the_trees_give_up_is_set_down_whenever_a_stop_comes_in_between() {
    let (mut lowering, mut on_the_floor) = (0, 0);
    for pause in 0..45 {
        let mut trio = failed_under_way();
        let end = trio.now() + Duration::from_millis(140 * pause);
        while trio.advance_to(end) {}
        let arm = trio.pair.arm(Which::Srm1);
        lowering += u32::from(arm.holds.is_some() && !arm.lifted && !arm.on_floor);
        on_the_floor += u32::from(arm.holds.is_none());
        if trio.state().mission.phase == PhaseName::Retrieving {
            must(&mut trio, Command::Stop);
            let before = trio.bodies();
            let end = trio.now() + Duration::from_secs(5);
            while trio.advance_to(end) {}
            assert_eq!(trio.bodies(), before, "it moves after STOP");
            must(&mut trio, Command::Start);
        }
        check_fault(&mut trio, "a robot of the pair");
        let why = format!("{} ms", 140 * pause);
        check_nobody_is_left_inside(&mut trio, &why);
        let lies = trio.state().retrieval.as_ref().expect("it can be tried again").piece.clone();
        assert!(!lies.is_empty() && lies.iter().all(|cell| matches!(trio.truth(*cell), Truth::Luggage(_))), "{why}: {lies:?}");
        must(&mut trio, Command::Start);
        check_secured(&mut trio);
    }
    assert!(lowering > 2 && on_the_floor > 5, "{lowering} stops while it is lowered, {on_the_floor} later");
}

#[test]
fn a_robot_that_cannot_go_out_is_a_fault_and_start_sets_down_what_is_in_the_grip_before_anything_else() {
    let mut trio = failed_under_way();
    trio.spoils = |index, _| (index == 1).then_some(Spoiled::Fails);
    for _ in 0..2 {
        check_fault(&mut trio, "; and a robot that fetches cannot do what it is told");
        assert!(trio.pair.load().is_some(), "it cannot be set down");
        must(&mut trio, Command::Start);
    }
    trio.spoils = |_, _| None;
    check_fault(&mut trio, "a robot of the pair");
    check_nobody_is_left_inside(&mut trio, "they could go out");
    must(&mut trio, Command::Start);
    check_secured(&mut trio);
}

#[test]
fn a_gripper_that_does_not_close_is_a_fault_with_everybody_outside_as_often_as_it_is_tried() {
    let mut trio = sent(trio(Settings::default(), usual(), Mishaps { jams: vec![1], ..Mishaps::default() }));
    for _ in 0..3 {
        check_fault(&mut trio, "a robot of the pair");
        check_nobody_is_left_inside(&mut trio, "it is jammed");
        assert!(trio.pair.taken_in().is_empty());
        must(&mut trio, Command::Start);
    }
}

#[test]
fn one_gripper_that_closed_alone_is_opened_before_they_go_out() {
    for other in [1, 2] {
        let mut trio = sent(trio(Settings::default(), usual(), Mishaps::default()));
        let one: Spoils = |index, action| (index == 1 && action == CLOSE).then_some(Spoiled::Fails);
        let two: Spoils = |index, action| (index == 2 && action == CLOSE).then_some(Spoiled::Fails);
        trio.spoils = if other == 1 { one } else { two };
        check_fault(&mut trio, "a robot of the pair");
        check_nobody_is_left_inside(&mut trio, "one of them did not close");
        trio.spoils = |_, _| None;
        must(&mut trio, Command::Start);
        check_secured(&mut trio);
    }
}

#[test]
fn a_piece_that_was_recorded_without_an_identity_is_fetched_from_where_it_stands() {
    let rules = Settings { inspect_everything: true, ..Settings::default() };
    let mut trio = trio(rules, SimSettings { unknown_rate: 1.0, ..usual() }, Mishaps::default());
    until(&mut trio, "all are linked", |_, state| can_start(state));
    must(&mut trio, Command::Start);
    // The operator is also asked about walls.
    let bomb = loop {
        until(&mut trio, "a photo", |_, state| state.pending().is_some_and(|piece| piece.has_photo()));
        let (id, cell) = trio.state().pending().map(|piece| (piece.id, piece.cell)).expect("it is there");
        let bomb = Some(trio.truth(cell)).and_then(|truth| if let Truth::Luggage(piece) = truth { Some(piece) } else { None });
        let verdict = if bomb.is_some() { Verdict::Danger } else { Verdict::Safe };
        must(&mut trio, Command::Verdict { luggage: LuggageRef::Id(id), verdict, note: None, hot: Default::default() });
        if let Some(bomb) = bomb {
            break bomb;
        }
    };
    assert!(trio.state().luggage.iter().all(|piece| piece.piece.is_none()), "nobody could tell what they are");
    until(&mut trio, "discovery is home", |trio, state| state.mission.phase == PhaseName::BombLocated && trio.is_quiet());
    must(&mut trio, Command::Retrieve(None));
    check_secured(&mut trio);
    assert_eq!(trio.pair.taken_in(), [bomb]);
}

#[test]
fn who_began_it_ends_it_although_the_settings_name_somebody_else_since() {
    let mut begun = sent(trio(Settings::default(), usual(), Mishaps::default()));
    carried(&mut begun);
    let before = (begun.bodies(), begun.pair.load());
    for other in [Fetcher::Discovery, Fetcher::None] {
        begun.rules.fetcher = other;
        begun = begun.killed(9);
        until(&mut begun, "all are linked", |_, state| can_start(state));
        must(&mut begun, Command::Start);
        check_fault(&mut begun, "set it back");
        assert_eq!((begun.bodies(), begun.pair.load()), before, "nobody moves");
    }
    begun.rules.fetcher = Fetcher::Pair;
    let mut trio = begun.killed(9);
    until(&mut trio, "all are linked", |_, state| can_start(state));
    must(&mut trio, Command::Start);
    check_secured(&mut trio);
}

#[test]
fn after_a_kill_everybody_sees_the_trees_as_they_stood_before_anything_goes_on() {
    let mut killed = sent(trio(Settings::default(), usual(), Mishaps::default()));
    carried(&mut killed);
    let stood = |trio: &mut Trio| {
        let trees = Arc::clone(&trio.state().retrieval.as_ref().expect("it is under way").trees);
        let nodes = trees.trees.iter().flat_map(|tree| tree.nodes.iter());
        let running: Vec<_> = nodes.filter(|node| node.status == Status::Running).map(|node| Arc::clone(&node.path)).collect();
        let mut blackboard = trees.blackboard.clone();
        blackboard.sort();
        (running, blackboard, trees.ticks)
    };
    must(&mut killed, Command::Stop);
    let before = stood(&mut killed);
    let mut trio = killed.killed(9);
    let after = stood(&mut trio);
    assert!(before.0.len() > 3 && before.1.len() > 3, "{before:?}");
    assert_eq!((&after.0, &after.1), (&before.0, &before.1));
    assert!(after.2 > 0 && after.2 <= before.2, "they are counted on from {} of {}", after.2, before.2);
}

fn alone() -> Trio {
    let rules = Settings { fetcher: Fetcher::Discovery, ..Settings::default() };
    trio(rules, SimSettings { has_hook: true, ..usual() }, Mishaps::default())
}

#[test]
fn a_hook_that_closes_round_nothing_is_a_fault_and_start_tries_once_more() {
    let pretends: Spoils = |_, action| (action == CLOSE).then_some(Spoiled::Pretends);
    let fails: Spoils = |_, action| (action == CLOSE).then_some(Spoiled::Fails);
    for (spoils, words) in [(pretends, "cannot take hold of the piece"), (fails, "could not carry out its order")] {
        let mut trio = alone();
        trio.spoils = spoils;
        let mut trio = sent(trio);
        check_fault(&mut trio, words);
        trio.spoils = |_, _| None;
        must(&mut trio, Command::Start);
        assert_eq!(ended(&mut trio).mission.phase, PhaseName::BagSecured);
        assert_eq!(trio.sim.taken_in().count(), 1);
    }
}

#[test]
fn a_bag_on_the_back_of_a_robot_that_is_out_of_reach_for_a_while_is_brought_home() {
    let mut trio = sent(alone());
    until(&mut trio, "it is on its back", |trio, _| trio.sim.hook().holds.is_some());
    for _ in 0..3 {
        let end = trio.now() + Duration::from_millis(700);
        while trio.advance_to(end) {}
        trio.lose_link(0);
        let end = trio.now() + Duration::from_secs(3);
        while trio.advance_to(end) {}
        trio.find_link(0);
        until(&mut trio, "it may go on", |_, state| can_start(state));
        must(&mut trio, Command::Start);
    }
    assert_eq!(ended(&mut trio).mission.phase, PhaseName::BagSecured, "{:?}", trio.state().mission.fault);
    let bags: Vec<Piece> = trio.sim.taken_in().collect();
    assert_eq!(bags.len(), 1);
}

#[test]
fn a_piece_of_which_everybody_has_lost_all_memory_is_looked_for_where_it_was_found() {
    let is_far = |parcel: Parcel| parcel.place.cell().is_none_or(|cell| cell.x.abs_diff(3) + cell.y.abs_diff(3) > 2);
    let is_on_its_way = |trio: &Trio| trio.pair.load().is_some_and(is_far) || trio.sim.hook().holds.is_some();
    for begun in [trio(Settings::default(), usual(), Mishaps::default()), alone()] {
        let mut begun = sent(begun);
        until(&mut begun, "it is carried", |trio, _| is_on_its_way(trio));
        let end = begun.now() + Duration::from_millis(100);
        while begun.advance_to(end) {}
        begun.forget();
        let mut trio = begun.killed(9);
        let mut faults = 0;
        until(&mut trio, "all are linked", |_, state| can_start(state));
        for _ in 0..6 {
            let end = trio.now() + Duration::from_millis(100);
            while trio.advance_to(end) {}
            let alarm = trio.state().alarms.iter().rfind(|alarm| alarm.acknowledged.is_none()).and_then(|alarm| alarm.id);
            if let Some(alarm) = alarm {
                must(&mut trio, Command::Acknowledge(alarm));
            }
            if trio.state().mission.refusals.start.is_none() {
                must(&mut trio, Command::Start);
            }
            until(&mut trio, "it has gone on", |trio, state| {
                trio.is_quiet() && (state.mission.phase != PhaseName::Retrieving || !state.mission.holds.is_empty())
            });
            match trio.state().mission.phase {
                PhaseName::BagSecured => break,
                PhaseName::Fault => faults += 1,
                _ => {}
            }
        }
        assert_eq!((trio.state().mission.phase, faults), (PhaseName::BagSecured, 1), "{:?}", trio.state().mission.fault);
        assert_eq!(trio.pair.taken_in().len() + trio.sim.taken_in().count(), 1);
    }
}
