//! Calibrates the simulated camera that can miss luggage, and judges a calibration. A *pass* is a new view of a piece's
//! cell: the robot looks from a place from which it has not looked at this cell before. Whole missions are simulated,
//! so the views are those that the console shows.

use std::fmt::Write as _;
use std::sync::Arc;

use hallsweep_core::command::Strategy;
use hallsweep_core::settings::Settings;
use hallsweep_core::units::Cell;
use hallsweep_core::world::coverage::{Sensor, SensorModel, Views};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_sim::headless::{Verdicts, explore_and_tell};
use hallsweep_sim::{Camera, SimSettings};

use crate::compare::{Halls, Kind};
use crate::family::Family;
use crate::parallel;

/// Families of the halls, which are searched in turns.
const FAMILIES: [Family; 5] = [Family::Luggage(0.05), Family::Luggage(0.1), Family::Luggage(0.2), Family::Walls, Family::Islands];

/// Ranges of the sonar, which are used in turns. With 0 the robot bumps into obstacles.
const RANGES: usize = 8;

/// Number of columns and rows of a hall.
const SIDE: usize = 20;

/// One pass of a piece.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Distance of the new view, in cells.
    distance: u8,
    was_found: bool,
    is_found: bool,
    /// The probability of detection that the console states after this pass.
    stated: f64,
}

/// The passes with about the same stated probability.
#[derive(Clone, Copy, Debug)]
pub struct Bin {
    pub passes: usize,
    /// Mean of the stated probabilities.
    pub stated: f64,
    /// Share of the passes after which the piece was found.
    pub found: f64,
}

/// Makes this number of searches and collects the passes of all pieces.
#[must_use]
pub fn passes(searches: usize, seed: u64) -> Vec<Pass> {
    parallel::each(searches, |n, _| search(n, seed, true)).concat()
}

/// Returns the sweep widths that follow from these passes, as lines of Rust for `hallsweep_core::world::sweep`. A width
/// follows from the share of the passes that find a piece which was not found before.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "no search makes 2^53 passes")]
pub fn widths(passes: &[Pass]) -> String {
    let mut text = String::new();
    for distance in 1..RANGES as u8 {
        let looks = || passes.iter().filter(|pass| pass.distance == distance && !pass.was_found);
        let (all, missed) = (looks().count(), looks().filter(|pass| !pass.is_found).count());
        // Half a miss more keeps the width finite if every look has found its piece.
        let share = (missed as f64 + 0.5) / (all as f64 + 1.0);
        let width_m = -share.ln() * Sensor::CALIBRATED_M;
        let _ = writeln!(text, "    {width_m:.3}, // {distance} cells: {all} looks, {missed} misses");
    }
    text
}

/// Compares the stated probability with the share of found pieces, in ten bins of stated probability. Bins without
/// passes are left out.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "no search makes 2^53 passes")]
pub fn bins(passes: &[Pass]) -> Vec<Bin> {
    let bin = |bin: usize| {
        let is_within = |pass: &&Pass| ((pass.stated * 10.0) as usize).min(9) == bin;
        let within: Vec<&Pass> = passes.iter().filter(is_within).collect();
        let share = |sum: f64| sum / within.len() as f64;
        Bin {
            passes: within.len(),
            stated: share(within.iter().map(|pass| pass.stated).sum()),
            found: share(within.iter().filter(|pass| pass.is_found).count() as f64),
        }
    };
    (0..10).map(bin).filter(|bin| bin.passes > 0).collect()
}

fn search(n: usize, seed: u64, camera_misses: bool) -> Vec<Pass> {
    let (sonar_cells, family) = ((n % RANGES) as u8, FAMILIES[n / RANGES % FAMILIES.len()]);
    let hall = Halls::Random { kind: Kind { family, columns: SIDE, lines: SIDE }, count: n + 1, seed }.hall(n).into_owned();
    let sim = SimSettings { camera_misses, sonar_cells, ..SimSettings::new(seed ^ n as u64, Camera::Stub) };
    let settings = Settings { sonar_cells, ..Settings::default() };
    let sensor = Sensor { cells: sonar_cells, model: Some(SensorModel::SimCamera) };
    let cells = hall.pieces().iter().flat_map(|bag| bag.cells.iter().copied());
    let mut pieces: Vec<(Cell, Views, bool)> = cells.map(|cell| (cell, Views::default(), false)).collect();
    let mut passes = Vec::new();
    explore_and_tell(&Arc::new(hall), sim, settings, Strategy::Auto, Verdicts::AllSafe, |state, _| {
        for (cell, seen, was_found) in &mut pieces {
            let views = state.coverage.at(*cell);
            let new = Views { bits: views.bits & !seen.bits, ..views };
            let Some(distance) = new.nearest() else { continue };
            let is_found = matches!(state.map.at(*cell), Mark::NotInspected | Mark::Luggage);
            let stated = sensor.detection(views).unwrap_or_default();
            passes.push(Pass { distance, was_found: *was_found, is_found, stated });
            (*seen, *was_found) = (views, is_found);
        }
    });
    passes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the probabilities that the console states. The searches are others than those of the calibration.
    #[test]
    fn what_is_stated_is_found_as_often_as_stated() {
        let bins = bins(&passes(1000, 3));
        let judged = bins.iter().filter(|bin| bin.passes >= 400);
        judged.clone().for_each(|bin| assert!((bin.stated - bin.found).abs() <= 0.05, "{bin:?}"));
        assert!(judged.count() >= 7, "the camera must be judged near and far: {bins:?}");
    }

    #[test]
    fn the_shipped_sweep_widths_follow_from_the_searches_that_they_name() {
        let (widths, shipped) = (widths(&passes(1000, 1)), include_str!("../../core/src/world/sweep.rs"));
        assert!(shipped.contains(&format!("[\n{widths}]")), "{widths}");
    }

    /// The bins tell another camera from the calibrated one, so they can fail.
    #[test]
    fn a_camera_that_misses_nothing_is_told_from_the_calibrated_one() {
        let bins = bins(&(0..40).flat_map(|n| search(n, 1, false)).collect::<Vec<_>>());
        assert!(bins.iter().any(|bin| (bin.found - bin.stated).abs() > 0.05), "{bins:?}");
    }
}
