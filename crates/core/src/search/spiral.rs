//! Round and round from the walls inwards: what is visited or blocked stays on the robot's right hand as long as it can.

use super::entries::{CellEntry, Visit, best_entry};
use super::grid::onward;
use super::view::View;
use super::ways::Ways;

/// What it counts against a cell, in thousandths of a step, that its right side is open.
const OPEN: i32 = 2500;

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    let grid = view.grid;
    best_entry(view, ways, 0, |entry: &CellEntry| {
        let right = onward(entry.target, grid.step(entry.at.heading.right()));
        if grid.here(right).is_open() { OPEN } else { 0 }
    })
}
