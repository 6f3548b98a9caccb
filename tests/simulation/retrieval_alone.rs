//! The searching robot fetches the dangerous piece itself (mission §4, rule 7): in the halls that come with the
//! program and in random ones, with stops, heat and kills at random moments. A failure prints its seed.

use std::collections::BTreeSet;
use std::sync::Arc;

use hallsweep_core::command::{Command, LuggageRef, Strategy, TemperatureReport, Verdict};
use hallsweep_core::not_fetched::Fetcher;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::settings::{AfterDanger, Rules, Settings};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{AlarmId, Cell, Piece};
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::halls;
use crate::mortal::Mortal;

/// Number of events that exceeds any of these missions.
const LONG: usize = 400_000;

fn with_hook(seed: u64) -> SimSettings {
    SimSettings { has_hook: true, ..SimSettings::new(seed, Camera::Stub) }
}

/// The verdict danger is given from where the sonar saw the piece. The cells before the piece are entered for the
/// first time when it is fetched.
#[test]
fn a_piece_that_was_photographed_from_afar_is_fetched_as_well() {
    let hall = Arc::new(Hall::from_rows("far", &["S..a"]).unwrap());
    let rules = Settings { fetcher: Fetcher::Discovery, sonar_cells: 3, ..Settings::default() };
    let mut mortal = Mortal::searching_by(Strategy::default(), rules, hall, SimSettings { sonar_cells: 3, ..with_hook(1) });
    assert!(locate(&mut mortal, |_| true));
    let piece = mortal.state().luggage[0].clone();
    assert_eq!((piece.cell, piece.pose.cell), (Cell::new(3, 0), Cell::HOME));
    mortal.give(Command::Acknowledge(AlarmId(1))).unwrap();
    mortal.give(Command::Retrieve(None)).unwrap();
    go_on(&mut mortal, 1);
    assert!(check(&mut mortal, 1));
}

/// The ring of another bomb lies over home. The robot can leave home, but a robot that brought the piece could not come
/// back, so the piece stays where it is.
#[test]
fn a_piece_is_not_taken_if_no_way_leads_home_with_it() {
    let rows = ["S..b...", ".......", ".......", ".......", "...a..."];
    let hall = Arc::new(Hall::from_rows("ringed", &rows).unwrap());
    let keep_out = Rules { after_danger: AfterDanger::GoOn, keep_out_m: 1.5, ..Rules::default() };
    let rules = Settings { fetcher: Fetcher::Discovery, rules: keep_out, ..Settings::default() };
    let mut mortal = Mortal::searching_by(Strategy::default(), rules, hall, with_hook(1));
    assert!(locate(&mut mortal, |_| true));
    let state = mortal.state();
    let far = state.luggage.iter().find(|piece| piece.cell == Cell::new(3, 4)).expect("it was found").id;
    mortal.give(Command::Retrieve(Some(far))).unwrap();
    for _ in 0..LONG {
        mortal.keep_all();
        if mortal.state().mission.phase == PhaseName::Fault || !mortal.advance() {
            break;
        }
    }
    let state = mortal.state();
    let fault = state.mission.fault.as_ref().expect("it gives up").to_string();
    assert!(fault.contains("home"), "{fault}");
    assert_ne!(state.robot.pose.cell, Cell::HOME, "it stands before the piece");
    assert_eq!((mortal.sim.taken_in().count(), state.luggage.bombs_left().count()), (0, 2));
}

/// Searches until such a piece is judged dangerous and the robot is home; false when there is none.
fn locate(mortal: &mut Mortal, is_bomb: impl Fn(&Snapshot) -> bool) -> bool {
    mortal.keep_all();
    mortal.give(Command::Start).expect("nothing holds it");
    for _ in 0..LONG {
        mortal.keep_all();
        let state = mortal.state();
        match (state.pending(), state.mission.phase) {
            (Some(piece), _) => {
                let verdict = if is_bomb(&state) { Verdict::Danger } else { Verdict::Safe };
                mortal
                    .give(Command::Verdict { luggage: LuggageRef::Id(piece.id), verdict, note: None, hot: Default::default() })
                    .expect("it is asked about");
            }
            (None, PhaseName::BombLocated) => return true,
            (None, PhaseName::Explored) => return false,
            (None, _) => assert!(mortal.advance(), "stuck: {:?}", state.mission),
        }
    }
    panic!("the search has no end");
}

/// Checks that the record says secured only for pieces in the container; returns whether the retrieval has ended.
fn check(mortal: &mut Mortal, seed: u64) -> bool {
    let state = mortal.state();
    let inside: BTreeSet<Piece> = mortal.sim.taken_in().collect();
    let secured: BTreeSet<Piece> =
        state.luggage.iter().filter(|luggage| luggage.secured.is_some()).filter_map(|luggage| luggage.piece).collect();
    assert!(secured.is_subset(&inside), "seed {seed}: {secured:?} are said to be in the container, which holds {inside:?}");
    let is_done = state.mission.phase == PhaseName::BagSecured;
    assert!(!is_done || (secured.len() == 1 && state.robot.pose.cell == Cell::HOME), "seed {seed}: {state:?}");
    is_done
}

/// Continues to the end; presses START when that can clear the hold.
fn go_on(mortal: &mut Mortal, seed: u64) {
    for _ in 0..LONG {
        mortal.keep_all();
        if check(mortal, seed) {
            return;
        }
        let state = mortal.state();
        assert_ne!(state.mission.phase, PhaseName::Fault, "seed {seed}: {:?}", state.mission.fault);
        let gave = !state.mission.holds.is_empty() && mortal.give(Command::Start).is_ok();
        assert!(gave || mortal.advance(), "seed {seed}: stuck: {:?}", state.mission);
    }
    panic!("seed {seed}: the retrieval has no end: {:?}", mortal.state().mission);
}

#[test]
fn it_brings_every_bag_of_the_built_in_halls_home() {
    for name in ["airport", "seed"] {
        let hall = Arc::new(Hall::named_or_file(name).expect("it comes with the program"));
        for bag in hall.pieces() {
            let mut mortal = Mortal::born(Arc::clone(&hall), with_hook(1));
            let is_bomb = |state: &Snapshot| state.pending().is_some_and(|piece| piece.piece == Some(bag.piece));
            assert!(locate(&mut mortal, is_bomb), "{name}: {bag:?} is met");
            mortal.give(Command::Retrieve(None)).expect("the robot is home");
            go_on(&mut mortal, 0);
            assert_eq!(mortal.sim.taken_in().collect::<Vec<_>>(), [bag.piece], "{name}");
            mortal.give(Command::Start).expect("a new search begins");
            mortal.keep_all();
            assert_eq!(mortal.state().mission.id.0, 2);
        }
    }
}

#[test]
fn whatever_stops_heats_or_kills_it_the_bag_is_secured_when_it_is_in_the_container_and_never_before() {
    let (mut fetched, mut kills, mut carried) = (0, 0, 0);
    for seed in 0..200 {
        let mut dice = RandomStream::new(seed, "alone");
        let mut mortal = Mortal::born(halls::random(seed, 10), with_hook(seed));
        let bomb = dice.below(3);
        let is_bomb = |state: &Snapshot| state.luggage.len() as u64 > bomb;
        if !locate(&mut mortal, is_bomb) {
            continue;
        }
        fetched += 1;
        mortal.give(Command::Retrieve(None)).expect("the robot is home");
        for _ in 0..dice.below(12) {
            (0..dice.below(12)).for_each(|_| {
                mortal.advance();
                (0..dice.below(3)).for_each(|_| {
                    mortal.keep_one();
                });
            });
            if check(&mut mortal, seed) {
                break;
            }
            match dice.below(3) {
                0 => {
                    drop(mortal.give(Command::Stop));
                    is_not_put_away_with_a_bag_on_its_back(&mut mortal, seed);
                }
                1 => heat(&mut mortal),
                _ => {
                    kills += 1;
                    carried += u32::from(mortal.sim.hook().holds.is_some());
                    mortal = mortal.killed(dice.below(4) as usize);
                }
            }
            stands_still(&mut mortal, seed);
            if check(&mut mortal, seed) {
                break;
            }
            drop(mortal.give(Command::Start));
        }
        go_on(&mut mortal, seed);
    }
    assert!(
        fetched > 80 && kills > 100 && carried > 10,
        "{fetched} fetched, {kills} kills, {carried} of them with a bag on its back"
    );
}

/// A reset with the bag on the robot's back must be refused, because a new search with the bag would be the worst
/// outcome.
fn is_not_put_away_with_a_bag_on_its_back(mortal: &mut Mortal, seed: u64) {
    mortal.keep_all();
    drop(mortal.give(Command::Acknowledge(AlarmId(1))));
    mortal.keep_all();
    if mortal.sim.hook().holds.is_some() {
        assert!(mortal.give(Command::Reset).is_err(), "seed {seed}: the mission is put away with the bag on the robot's back");
    }
}

/// Heats and cools the hall: START is refused between, and nothing moves by itself afterwards.
fn heat(mortal: &mut Mortal) {
    mortal.give(Command::Temperature(TemperatureReport::TooHigh)).expect("anybody may say so");
    mortal.keep_all();
    if mortal.state().mission.phase == PhaseName::Retrieving {
        assert!(mortal.give(Command::Start).is_err(), "it is too hot");
    }
    mortal.give(Command::Temperature(TemperatureReport::Ok)).expect("anybody may say so");
}

fn stands_still(mortal: &mut Mortal, seed: u64) {
    let before = (mortal.body(), mortal.sim.hook());
    mortal.wait_a_minute();
    mortal.keep_all();
    mortal.wait_a_minute();
    assert_eq!((mortal.body(), mortal.sim.hook()), before, "seed {seed}: it moved without a START");
}
