//! Mission §12: a searched area is searched again.

use std::collections::BTreeSet;
use std::sync::Arc;

use hallsweep_core::command::{Again, Command, Door, Issuer, LuggageRef, Request, Strategy, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::settings::{AfterDanger, Rules, Settings};
use hallsweep_core::units::{Cell, Epoch};
use hallsweep_core::world::hall_map::{Bounds, Mark};
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::mortal::Mortal;
use crate::operator::{Operator, in_drawn};

fn again(least: (i32, i32), most: (i32, i32)) -> Command {
    Command::SearchAgain(Again::Within(Bounds { least: Cell::new(least.0, least.1), most: Cell::new(most.0, most.1) }))
}

fn drawn(rows: &[&str]) -> Arc<Hall> {
    Arc::new(Hall::from_rows("drawn", rows).expect("the tests draw sound halls"))
}

/// Returns the cells that the robot enters until it has come to the end of the search.
fn entered_until(run: &mut Run, end: PhaseName) -> BTreeSet<Cell> {
    let mut entered = BTreeSet::new();
    run.until(end.name(), |state| {
        entered.insert(state.robot.pose.cell);
        assert!(state.mission.again.is_empty() || state.robot.led_blinking, "the search is under way");
        state.mission.phase == end
    });
    entered
}

#[test]
fn every_cell_of_an_area_is_visited_once_more_and_the_way_home_stays_known() {
    let mut run = in_drawn(&["S....", ".....", "..#..", "....."]);
    run.give(Command::Start).unwrap();
    run.until_explored();
    let before = run.state();
    run.give(again((1, 1), (3, 3))).unwrap();
    let state = run.state();
    assert_eq!((run.phase(), state.mission.again.len(), state.mission.id), (PhaseName::Exploring, 8, before.mission.id));
    assert_eq!(state.map.visited(), before.map.visited(), "the map is as it was");
    let entered = entered_until(&mut run, PhaseName::Explored);
    let area = (1..=3).flat_map(|x| (1..=3).map(move |y| Cell::new(x, y))).filter(|cell| *cell != Cell::new(2, 2));
    assert!(area.into_iter().all(|cell| entered.contains(&cell)), "{entered:?}");
    let state = run.state();
    assert!(state.mission.again.is_empty() && !state.robot.led_blinking && run.cell() == Cell::HOME);
}

/// Somebody has put a bag down since the first search.
#[test]
fn what_was_put_down_since_is_found() {
    let mut run = in_drawn(&["S....", ".....", ".....", "....."]);
    run.give(Command::Start).unwrap();
    run.until_explored();
    run.sim.handle_hall(drawn(&["S....", ".....", "...a.", "....."]));
    run.give(again((0, 0), (4, 3))).unwrap();
    let id = run.until_pending();
    assert_eq!(run.state().luggage(id).expect("it waits").cell, Cell::new(3, 2));
    assert!(!run.state().mission.again.contains(&Cell::new(3, 2)), "it is an obstacle now");
    run.verdict(id.0, Verdict::Safe).unwrap();
    run.until_explored();
    assert!(run.state().mission.again.is_empty());
}

/// A sonar sees it from a distance, so the robot does not touch it.
#[test]
fn a_sonar_sees_what_was_put_down_since() {
    let settings = Settings { sonar_cells: 8, ..Settings::default() };
    let sim = SimSettings { sonar_cells: 8, sonar_noise_cm: 0.0, ..SimSettings::new(1, Camera::Stub) };
    let mut run = Run::new(drawn(&["S.....", "......", "......", "......"]), sim, settings, Strategy::Auto);
    run.give(Command::Start).unwrap();
    run.until_explored();
    run.sim.handle_hall(drawn(&["S.....", "......", "...a..", "......"]));
    run.give(again((0, 0), (5, 3))).unwrap();
    run.until("a piece that waits", |state| {
        assert!(!state.robot.off_centre, "it touched the piece");
        state.pending().is_some()
    });
    assert_eq!(run.state().pending().expect("it waits").cell, Cell::new(3, 2));
}

/// While the robot goes round a piece for an unsure judge, an area can be named. It follows after the verdict.
#[test]
fn an_area_that_is_named_during_an_inspection_follows_after_it() {
    let mut run = in_drawn(&["S....", ".....", "..a..", "....."]);
    run.give(Command::Start).unwrap();
    let id = run.until_pending();
    run.give(Command::Unsure { luggage: LuggageRef::Id(id), note: None, hot: Default::default() }).unwrap();
    run.give(again((0, 0), (4, 3))).unwrap();
    let noted = run.state().mission.again.len();
    assert!(noted > 0 && run.phase() == PhaseName::Inspecting);
    run.until("asked again", |state| !state.mission.is_viewing);
    assert_eq!(run.give(again((0, 0), (4, 3))), Err(Refused::VerdictPending(id)));
    run.verdict(id.0, Verdict::Safe).unwrap();
    run.until_explored();
    assert_eq!(run.state().mission.open.again, 0);
}

#[test]
fn an_area_needs_searched_cells_and_not_too_many() {
    let mut run = in_drawn(&["S....", ".....", "....."]);
    assert_eq!(run.give(again((0, 0), (4, 2))), Err(Refused::NotInPhase(PhaseName::Idle)));
    run.give(Command::Start).unwrap();
    run.until_explored();
    for nowhere in [again((0, 0), (0, 0)), again((9, 9), (12, 12)), again((3, 2), (1, 0)), again((-8192, -8192), (-1, 8192))] {
        assert_eq!(run.give(nowhere), Err(Refused::NothingSearched));
    }
    run.give(again((-8192, -8192), (8192, 8192))).unwrap();
    assert_eq!(run.state().mission.again.len(), 14);
    run.give(again((1, 1), (4, 2))).expect("it waits already, so nothing changes");
    assert_eq!(run.state().mission.again.len(), 14);
    let rows = vec![".".repeat(80); 60];
    let rows: Vec<String> =
        rows.iter().enumerate().map(|(y, row)| if y == 0 { format!("S{}", &row[1..]) } else { row.clone() }).collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let mut run = in_drawn(&rows);
    run.give(Command::Start).unwrap();
    run.until_explored();
    assert_eq!(run.give(again((0, 0), (79, 59))), Err(Refused::AreaTooLarge(4096)));
    run.give(again((0, 0), (63, 59))).unwrap();
    assert_eq!(run.give(again((64, 0), (79, 59))), Err(Refused::AreaTooLarge(4096)), "those that wait count, too");
}

/// The command moves the robot, so it is refused like START: under a hold, after a STOP that its sender has not seen,
/// and while a piece waits.
#[test]
fn searching_again_is_a_movement_command() {
    let mut run = in_drawn(&["S....", ".a...", "....."]);
    run.give(Command::Start).unwrap();
    let id = run.until_pending();
    assert_eq!(run.give(again((0, 0), (4, 2))), Err(Refused::VerdictPending(id)));
    run.verdict(id.0, Verdict::Safe).unwrap();
    run.until("some way", |state| state.mission.progress.visited > 6);
    run.give(Command::Stop).unwrap();
    let old = Request { epoch: Some(Epoch(0)), ..Request::new(again((0, 0), (4, 2)), Issuer::operator(Door::LOCAL)) };
    assert_eq!(run.ask(old), Err(Refused::Outdated { sent: Epoch(0), now: Epoch(1) }));
    run.stands_still();
    run.reading(40.0).unwrap();
    assert!(matches!(run.give(again((0, 0), (4, 2))), Err(Refused::Held(..))));
    run.reading(20.0).unwrap();
    run.give(again((0, 0), (4, 2))).unwrap();
    assert!(run.holds().is_empty(), "it clears what waits for an operator");
    run.give(Command::BackHome).unwrap();
    assert_eq!(run.give(again((0, 0), (4, 2))), Err(Refused::NotInPhase(PhaseName::ReturningHome)));
    run.until_phase(PhaseName::AtHome);
    let left = run.state().mission.again.len();
    assert!(left > 0 && run.state().mission.open.again == left, "BACK HOME leaves the rest open");
    run.give(Command::Start).unwrap();
    run.until_explored();
    assert_eq!(run.state().mission.open.again, 0);
    run.give(again((0, 0), (4, 2))).unwrap();
    run.give(Command::Stop).unwrap();
    run.give(Command::BackHome).unwrap();
    run.until_phase(PhaseName::AtHome);
    run.give(Command::Reset).unwrap();
    assert!(run.state().mission.again.is_empty(), "the next mission begins anew");
}

/// A bomb's ring is not entered. What lies in it is searched again after the fetch, so the search is not over before.
#[test]
fn no_ring_is_entered_and_cells_that_cannot_be_reached_stay_open() {
    let rules = Rules { after_danger: AfterDanger::GoOn, keep_out_m: 0.5, ..Rules::default() };
    let hall = drawn(&["S......", ".......", ".......", "...a...", "......."]);
    let settings = Settings { rules, ..Settings::default() };
    let mut run = Run::new(hall, SimSettings::new(1, Camera::Stub), settings, Strategy::Auto);
    run.give(Command::Start).unwrap();
    let id = run.until_pending();
    run.verdict(id.0, Verdict::Danger).unwrap();
    run.until_phase(PhaseName::BombLocated);
    let ring = run.state().mission.keep_out.clone();
    let visited_in_ring = |run: &mut Run| {
        let state = run.state();
        state.map.known().filter(|(cell, mark)| *mark == Mark::Visited && ring.contains(*cell)).count()
    };
    let inside = visited_in_ring(&mut run);
    assert!(inside > 0, "the robot stood beside the bomb before it was one");
    run.give(again((0, 0), (6, 4))).unwrap();
    run.until("the end", |state| {
        assert!(!ring.contains(state.robot.pose.cell), "it entered the ring at {}", state.robot.pose.cell);
        state.mission.phase == PhaseName::BombLocated
    });
    let state = run.state();
    assert_eq!((state.mission.again.len(), state.robot.led_blinking), (inside, true), "the search is not over");
    // A wall across the hall: the cells beyond it cannot be reached, and the search ends all the same.
    let mut run = in_drawn(&["S....", ".....", "....."]);
    run.give(Command::Start).unwrap();
    run.until_explored();
    run.sim.handle_hall(drawn(&["S.#..", "..#..", "..#.."]));
    run.give(again((3, 0), (4, 2))).unwrap();
    loop {
        run.until("an obstacle or the end", |state| state.pending().is_some() || state.mission.phase == PhaseName::Explored);
        match run.state().pending().map(|piece| piece.id.0) {
            Some(id) => drop(run.verdict(id, Verdict::Safe).unwrap()),
            None => break,
        }
    }
    assert_eq!((run.state().mission.open.again, run.cell()), (6, Cell::HOME));
}

/// Safety R1: the cells are on record, and the robot goes on only after a START.
#[test]
fn after_a_kill_the_same_cells_are_left() {
    let mut mortal = Mortal::born(
        Arc::new(Hall::named_or_file("empty-8x8").expect("the hall comes with the program")),
        SimSettings::new(1, Camera::Stub),
    );
    mortal.give(Command::Start).unwrap();
    let explored = |mortal: &mut Mortal| mortal.state().mission.phase == PhaseName::Explored;
    let go_on = |mortal: &mut Mortal| {
        mortal.keep_all();
        mortal.advance()
    };
    while !explored(&mut mortal) && go_on(&mut mortal) {}
    mortal.give(again((2, 2), (5, 5))).unwrap();
    mortal.keep_all();
    while mortal.state().mission.again.len() > 9 && go_on(&mut mortal) {}
    mortal.keep_all();
    let left = mortal.state().mission.again.clone();
    assert!(!left.is_empty());
    let mut mortal = mortal.killed(0);
    assert_eq!(mortal.state().mission.again, left);
    mortal.wait_a_minute();
    assert_eq!(mortal.state().mission.again, left, "it moved without START");
    mortal.give(Command::Start).unwrap();
    while !explored(&mut mortal) && go_on(&mut mortal) {}
    mortal.keep_all();
    assert!(mortal.state().mission.again.is_empty());
}

/// A bomb that stands in a cell that was free stays an obstacle when START tries blocked cells again after a fault.
#[test]
fn a_bomb_found_by_searching_again_stays_on_the_map_after_a_fault() {
    let mut run = in_drawn(&["S......"]);
    run.give(Command::Start).unwrap();
    run.until_explored();
    run.sim.handle_hall(drawn(&["S....a."]));
    run.give(again((0, 0), (6, 0))).unwrap();
    let id = run.until_pending();
    run.verdict(id.0, Verdict::Danger).unwrap();
    run.sim.handle_hall(drawn(&["S.#..a."]));
    run.until_phase(PhaseName::Fault);
    run.sim.handle_hall(drawn(&["S....a."]));
    run.give(Command::Start).unwrap();
    assert_eq!(run.state().map.at(Cell::new(5, 0)), Mark::Luggage);
    run.until_phase(PhaseName::BombLocated);
    assert_eq!(run.state().map.at(Cell::new(5, 0)), Mark::Luggage);
}
