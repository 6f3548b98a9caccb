//! Goes round the hall in rings, from the walls inwards. Visited or blocked cells stay on the robot's right hand for
//! as long as possible.

use super::entries::{CellEntry, Visit, best_entry};
use super::grid::onward;
use super::view::View;
use super::ways::Ways;

/// Penalty for a cell whose right side is open, in thousandths of a step.
const OPEN: i32 = 2500;

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    let grid = view.grid;
    best_entry(view, ways, 0, |entry: &CellEntry| {
        let right = onward(entry.target, grid.step(entry.at.heading.right()));
        if grid.here(right).is_open() { OPEN } else { 0 }
    })
}
