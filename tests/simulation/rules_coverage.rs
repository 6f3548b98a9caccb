//! What a search has looked at, and a camera that can miss luggage.

use std::collections::BTreeSet;

use hallsweep_core::command::Strategy;
use hallsweep_core::settings::Settings;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::Mark;
use hallsweep_sim::headless::{Figures, Verdicts, explore};
use hallsweep_sim::{Camera, SimSettings, Truth};

use crate::halls;

fn search(seed: u64, sonar_cells: u8, camera_misses: bool) -> (Figures, BTreeSet<Cell>) {
    let hall = halls::random(seed, 18);
    let sim = SimSettings { camera_misses, sonar_cells, ..SimSettings::new(seed, Camera::Stub) };
    let settings = Settings { sonar_cells, ..Settings::default() };
    let figures = explore(&hall, sim, settings, Strategy::Auto, Verdicts::AllSafe, |_| {});
    let bounds = hall.bounds();
    let cells = (bounds.least.y..=bounds.most.y).flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)));
    let pieces = cells.filter(|cell| matches!(hall.truth(*cell), Truth::Luggage(_))).collect();
    (figures, pieces)
}

/// Cells whose mark was a wall first and luggage later.
fn found_late(figures: &Figures) -> BTreeSet<Cell> {
    let mut walls = BTreeSet::new();
    let marks = figures.journal.iter().filter_map(|entry| match entry.fact {
        Fact::Mark(cell, mark) => Some((cell, mark)),
        _ => None,
    });
    let mut late = BTreeSet::new();
    for (cell, mark) in marks {
        if mark == Mark::Wall {
            walls.insert(cell);
        } else if walls.contains(&cell) {
            late.insert(cell);
        }
    }
    late
}

#[test]
fn a_piece_that_was_missed_is_inspected_when_it_is_recognised_from_another_place() {
    let mut late = 0;
    for seed in 0..30 {
        let (figures, pieces) = search(seed, 4, true);
        for cell in found_late(&figures) {
            let mark = figures.state.map.at(cell);
            assert!(pieces.contains(&cell) && mark == Mark::Luggage, "seed {seed}: {cell} is {mark:?}");
            late += 1;
        }
    }
    assert!(late > 20, "only {late} pieces were found late");
}

#[test]
fn a_piece_that_is_missed_looks_like_a_wall_and_only_the_camera_that_may_miss_misses() {
    let mut missed = 0;
    for seed in 0..30 {
        let (figures, pieces) = search(seed, 0, true);
        let state = &figures.state;
        missed += pieces.iter().filter(|cell| state.map.at(**cell) == Mark::Wall).count();
        assert!(pieces.iter().all(|cell| state.map.at(*cell) != Mark::Visited), "seed {seed}");
        let (sure, pieces) = search(seed, 0, false);
        assert!(pieces.iter().all(|cell| sure.state.map.at(*cell) != Mark::Wall), "seed {seed}");
        assert_eq!(sure.state.searched().hall.detection, None, "the sensor is not calibrated");
    }
    assert!(missed > 20, "only {missed} pieces were missed");
}

#[test]
fn the_coverage_follows_from_the_journal_and_every_driven_cell_has_a_view() {
    for (seed, sonar_cells) in [(1, 0), (2, 3), (3, 7)] {
        let (figures, _) = search(seed, sonar_cells, true);
        let mut state = PersistentState::first(Strategy::Auto);
        figures.journal.iter().for_each(|entry| state.apply(entry));
        assert_eq!(state.coverage, figures.state.coverage, "seed {seed}");
        let driven = state.map.known().filter(|(cell, mark)| *mark == Mark::Visited && *cell != Cell::HOME);
        for (cell, _) in driven {
            assert!(state.coverage.at(cell).count() > 0, "seed {seed}: {cell}");
        }
        let nearest = state.coverage.iter().filter_map(|(_, views)| views.nearest()).max();
        assert!(nearest <= Some(sonar_cells.max(1)), "seed {seed}: {nearest:?}");
    }
}
