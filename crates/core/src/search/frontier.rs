//! The nearest unknown cell, with the pocket rule: a cell with more unvisited neighbours comes later, so that few lone
//! cells are left behind to come back for.

use super::entries::{CellEntry, Visit, best_entry};
use super::grid::onward;
use super::view::View;
use super::ways::Ways;
use crate::units::Heading;

/// Penalty for each unvisited neighbour of a cell, in thousandths of a step; 2000 to 3000 do about as well.
const NEIGHBOUR: i32 = 2500;

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    let grid = view.grid;
    let unvisited = |entry: &CellEntry| {
        Heading::ALL.iter().filter(|side| grid.here(onward(entry.target, grid.step(**side))).is_open()).count()
    };
    best_entry(view, ways, 0, |entry| NEIGHBOUR * i32::try_from(unvisited(entry)).unwrap_or(0))
}
