//! Mission §4 on several bombs: the search goes on after a danger, keep-out rings, and the order of the retrievals.

use std::collections::BTreeSet;
use std::sync::Arc;

use hallsweep_core::command::{Command, LuggageRef, Strategy, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::place::Place;
use hallsweep_core::refused::Refused;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::settings::{AfterDanger, Rules, Settings};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::snapshot::said::Said;
use hallsweep_core::units::{Cell, Heading, LuggageId};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_sim::headless::Run;
use hallsweep_sim::pair::PairSettings;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::operator::{Operator, PLENTY};

const THREE_BAGS: &[&str] = &["S.....", "......", "..a...", "......", "....b.", "c....."];

fn begun(rows: &[&str], after_danger: AfterDanger, keep_out_m: f64, pair: bool) -> Run {
    let hall = Arc::new(Hall::from_rows("drawn", rows).expect("the tests draw sound halls"));
    let settings = Settings { rules: Rules { after_danger, keep_out_m, ..Rules::default() }, ..Settings::default() };
    let sim = SimSettings { sonar_noise_cm: 0.0, ..SimSettings::new(1, Camera::Stub) };
    let mut run = if pair {
        let pair = PairSettings { way_out: true, ..PairSettings::new(1, Place::ENTRANCE) };
        Run::with_pair(hall, sim, settings, Strategy::Auto, pair)
    } else {
        Run::new(hall, sim, settings, Strategy::Auto)
    };
    run.give(Command::Start).expect("nothing holds it");
    run
}

/// Answers with `verdict` for the piece in each cell until the robot waits for somebody.
fn judge(run: &mut Run, verdict: impl Fn(Cell) -> Verdict) {
    let rests = |state: &Snapshot| {
        matches!(
            state.mission.phase,
            PhaseName::BombLocated | PhaseName::Explored | PhaseName::BagSecured | PhaseName::AtHome | PhaseName::Fault
        )
    };
    loop {
        run.until("a piece or the end", |state| state.mission.inspected.is_some() || rests(state));
        let state = run.state();
        let Some(id) = state.mission.inspected else { return };
        let cell = state.luggage(id).expect("it is inspected").cell;
        run.verdict(id.0, verdict(cell)).expect("it waits");
    }
}

fn bombs(run: &mut Run) -> Vec<u64> {
    run.state().luggage.bombs_left().map(|bomb| bomb.id.0).collect()
}

fn acknowledge_all(run: &mut Run) {
    for alarm in run.state().alarms.iter().filter_map(|alarm| alarm.id) {
        run.give(Command::Acknowledge(alarm)).expect("it is on record");
    }
}

/// Rules 4 and 7.
#[test]
fn where_the_search_goes_on_every_piece_is_found_before_any_is_fetched_and_each_in_the_order_of_the_operator() {
    let mut run = begun(THREE_BAGS, AfterDanger::GoOn, 0.0, true);
    judge(&mut run, |_| Verdict::Danger);
    assert_eq!((run.phase(), bombs(&mut run)), (PhaseName::BombLocated, vec![1, 2, 3]));
    assert_eq!(run.state().map.unsearched(), 0, "the whole hall is searched");
    assert!(!run.state().robot.led_blinking);
    acknowledge_all(&mut run);
    for (n, id) in [2, 3, 1].into_iter().enumerate() {
        run.give(Command::Retrieve(Some(LuggageId(id)))).expect("it is a bomb in the hall");
        run.until("fetched", |state| !matches!(state.mission.phase, PhaseName::Retrieving));
        let expected = if n == 2 { PhaseName::BagSecured } else { PhaseName::BombLocated };
        assert_eq!(run.phase(), expected, "{:?}", run.state().mission.fault);
        assert!(run.state().luggage(LuggageId(id)).expect("it is on record").secured.is_some());
        assert_eq!(run.state().luggage.secured().count(), n + 1);
    }
}

/// Rule 7.
#[test]
fn only_a_dangerous_piece_in_the_hall_is_fetched() {
    let mut run = begun(THREE_BAGS, AfterDanger::Return, 0.0, true);
    run.until_pending();
    run.verdict(1, Verdict::Safe).unwrap();
    run.until("the next piece", |state| state.mission.inspected == Some(LuggageId(2)));
    run.verdict(2, Verdict::Danger).unwrap();
    run.until_phase(PhaseName::BombLocated);
    let named = |id| Command::Retrieve(Some(LuggageId(id)));
    assert_eq!(run.give(named(1)), Err(Refused::NotABomb(LuggageId(1))));
    assert_eq!(run.give(named(9)), Err(Refused::UnknownLuggage(LuggageId(9))));
    run.give(named(2)).unwrap();
    run.until_phase(PhaseName::BagSecured);
}

/// Rules 3, 4 and 7: the command GO ON under the usual settings.
#[test]
fn the_search_can_go_on_from_a_located_bomb_and_from_a_secured_one() {
    let mut run = begun(THREE_BAGS, AfterDanger::Return, 0.0, true);
    judge(&mut run, |_| Verdict::Danger);
    assert_eq!((run.phase(), bombs(&mut run)), (PhaseName::BombLocated, vec![1]));
    assert_eq!(run.give(Command::Start), Err(Refused::NotInPhase(PhaseName::BombLocated)));
    run.give(Command::GoOn).unwrap();
    assert!(run.state().robot.led_blinking && run.phase() == PhaseName::Exploring);
    run.wait(1.0);
    run.give(Command::Stop).unwrap();
    run.stands_still();
    run.give(Command::Start).unwrap();
    judge(&mut run, |_| Verdict::Danger);
    assert_eq!((run.phase(), bombs(&mut run)), (PhaseName::BombLocated, vec![1, 2]), "a second danger brings it home again");
    acknowledge_all(&mut run);
    for _ in 0..2 {
        run.give(Command::Retrieve(None)).unwrap();
        run.until("fetched", |state| !matches!(state.mission.phase, PhaseName::Retrieving));
    }
    assert_eq!(run.phase(), PhaseName::BagSecured);
    run.give(Command::GoOn).unwrap();
    judge(&mut run, |_| Verdict::Safe);
    let state = run.state();
    assert_eq!((run.phase(), state.luggage.len(), state.luggage.secured().count()), (PhaseName::Explored, 3, 2));
}

/// Rules 3 and 7: BACK HOME leads to the bomb's retrieval, and after it the rest of the search waits.
#[test]
fn a_bomb_can_be_fetched_before_the_search_goes_on() {
    let mut run = begun(THREE_BAGS, AfterDanger::GoOn, 0.0, true);
    run.until_pending();
    run.verdict(1, Verdict::Danger).unwrap();
    run.wait(1.0);
    assert_eq!(run.phase(), PhaseName::Exploring);
    assert_eq!(run.give(Command::Retrieve(None)), Err(Refused::NotInPhase(PhaseName::Exploring)));
    run.give(Command::BackHome).unwrap();
    run.until_phase(PhaseName::BombLocated);
    acknowledge_all(&mut run);
    run.give(Command::Retrieve(None)).unwrap();
    run.until_phase(PhaseName::AtHome);
    assert!(run.state().robot.led_blinking, "the search is not over");
    run.stands_still();
    run.give(Command::GoOn).unwrap();
    judge(&mut run, |_| Verdict::Safe);
    assert_eq!(run.phase(), PhaseName::Explored);
}

/// Watches a run until it rests. No step leads into a ring, except on a way home about which the robot has said so.
fn keeps_out(run: &mut Run, bomb: &BTreeSet<Cell>, seed: u64) {
    let (mut before, mut went_home) = (run.cell(), false);
    for _ in 0..PLENTY {
        let state = run.state();
        let (cell, rings) = (state.robot.pose.cell, &state.mission.keep_out);
        let enters = rings.contains(cell) && !rings.contains(before);
        let must = went_home && !leads_home_round_the_rings(&state, before);
        assert!(!enters || must, "seed {seed}: {before} → {cell} enters a ring");
        (before, went_home) = (cell, goes_home_through_a_ring(&state));
        if matches!(state.mission.phase, PhaseName::BombLocated | PhaseName::Explored) {
            return;
        }
        if let Some(id) = state.mission.inspected {
            let is_bomb = bomb.contains(&state.luggage(id).expect("it is inspected").cell);
            let verdict = if is_bomb { Verdict::Danger } else { Verdict::Safe };
            run.give(Command::Verdict { luggage: LuggageRef::Id(id), verdict, note: None, hot: Default::default() })
                .expect("it waits");
        } else {
            assert!(run.advance(), "seed {seed}: nothing happens any more in {:?}", state.mission);
        }
    }
    let state = run.state();
    panic!(
        "seed {seed}: it never rests: {:?} at {:?}, {:?}",
        state.mission,
        state.robot.pose,
        state.log.iter().rev().take(9).map(|line| line.said.to_string()).collect::<Vec<_>>()
    );
}

/// Whether visited cells outside the rings lead home from here.
fn leads_home_round_the_rings(state: &Snapshot, from: Cell) -> bool {
    let (mut reached, mut open) = (BTreeSet::from([from]), vec![from]);
    while let Some(cell) = open.pop() {
        let next = Heading::ALL.map(|heading| cell.ahead(heading));
        let is_free = |next: &Cell| state.map.at(*next) == Mark::Visited && !state.mission.keep_out.contains(*next);
        open.extend(next.into_iter().filter(is_free).filter(|next| reached.insert(*next)));
    }
    reached.contains(&Cell::HOME)
}

fn goes_home_through_a_ring(state: &Snapshot) -> bool {
    state.mission.goal == Some(Cell::HOME) && state.log.iter().any(|line| line.said == Said::HomeThroughRings)
}

/// A robot that was inside a ring goes home outside it, although the way through the ring is shorter.
#[test]
fn on_the_way_home_a_robot_does_not_come_back_into_the_ring_that_it_has_left() {
    let rows = ["S........", ".........", "......#..", ".....#a..", "......#..", ".........", "........."];
    for radius in [1.0, 1.2] {
        let mut run = begun(&rows, AfterDanger::Return, radius, false);
        keeps_out(&mut run, &BTreeSet::from([Cell::new(6, 3)]), 0);
        assert_eq!((run.cell(), run.phase()), (Cell::HOME, PhaseName::BombLocated), "{radius}");
    }
}

/// Rule 7: what lies inside a ring can be searched after the fetch, so the search is not over before.
#[test]
fn places_inside_a_ring_wait_for_the_fetch_of_its_bomb() {
    let rows = ["S.......", "........", "........", "...a....", "........", "........"];
    let mut run = begun(&rows, AfterDanger::GoOn, 1.0, true);
    judge(&mut run, |_| Verdict::Danger);
    let state = run.state();
    assert_eq!((run.phase(), state.robot.led_blinking), (PhaseName::BombLocated, true));
    assert!(state.mission.progress.kept_out > 0);
    acknowledge_all(&mut run);
    run.give(Command::Retrieve(None)).unwrap();
    run.until_phase(PhaseName::AtHome);
    let mission = run.state().mission.id;
    run.stands_still();
    run.give(Command::Start).unwrap();
    judge(&mut run, |_| Verdict::Safe);
    let state = run.state();
    assert_eq!((run.phase(), state.mission.id, state.mission.progress.kept_out), (PhaseName::Explored, mission, 0));
}

#[test]
fn the_search_leaves_a_ring_and_enters_none_and_says_what_it_left_out() {
    // Cells of half a metre: a ring of 1 m takes in two cells on each side.
    let mut run = begun(&["S.......", "........", "........", "...a....", "........", "........"], AfterDanger::GoOn, 1.0, false);
    let bomb = BTreeSet::from([Cell::new(3, 3)]);
    keeps_out(&mut run, &bomb, 0);
    let state = run.state();
    let progress = state.mission.progress;
    assert_eq!((progress.unknown, progress.percent()), (0, None));
    assert!(progress.kept_out > 0, "cells in the ring are named");
    let outside =
        (0..6).flat_map(|y| (0..8).map(move |x| Cell::new(x, y))).filter(|cell| !state.mission.keep_out.contains(*cell));
    assert!(outside.into_iter().all(|cell| state.map.at(cell) == Mark::Visited), "everything outside is searched");
}

/// Random halls with several bombs and rings of random width. In some of them, the only way home leads through a ring.
#[test]
fn in_random_halls_no_search_enters_a_ring_and_every_robot_comes_home() {
    let (mut through_rings, mut kept_out) = (0, 0);
    for seed in 0..40 {
        let mut dice = RandomStream::new(seed, "rings");
        let rows: Vec<String> = (0..9)
            .map(|y| {
                (0..11)
                    .map(|x| match dice.below(100) {
                        _ if (x, y) == (0, 0) => 'S',
                        0..12 => 'T',
                        12..18 => '#',
                        _ => '.',
                    })
                    .collect()
            })
            .collect();
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let luggage: Vec<Cell> = (0..9i32)
            .flat_map(|y| (0..11i32).map(move |x| (x, y)))
            .filter(|(x, y)| rows[usize::try_from(*y).unwrap()].as_bytes()[usize::try_from(*x).unwrap()] == b'T')
            .map(|(x, y)| Cell::new(x, y))
            .collect();
        let bomb: BTreeSet<Cell> = luggage.iter().copied().filter(|_| dice.below(5) == 0).collect();
        let radius = [0.5, 1.0, 2.0][usize::try_from(dice.below(3)).unwrap()];
        let mut run = begun(&rows, AfterDanger::GoOn, radius, false);
        keeps_out(&mut run, &bomb, seed);
        assert_eq!(run.cell(), Cell::HOME, "seed {seed}");
        let state = run.state();
        through_rings += usize::from(state.log.iter().any(|line| line.said == Said::HomeThroughRings));
        kept_out += usize::from(state.mission.progress.kept_out > 0);
    }
    assert!(through_rings > 0 && kept_out > 5, "{through_rings} and {kept_out} of 40 halls");
}
