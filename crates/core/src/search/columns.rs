//! To and fro, column after column (boustrophedon): along a column as far as it goes, then into the one beside it. What was left behind
//! an obstacle is fetched when nothing is nearer.

use super::entries::{CellEntry, Visit, best_entry};
use super::view::View;
use super::ways::Ways;
use crate::units::Heading;

/// What it counts against a cell, in thousandths of a step, that it is entered from the side,
const ASIDE: i32 = 2000;

/// and for each column that it lies away from where the robot stands.
const COLUMN: i32 = 1000;

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    let here = view.pose.cell;
    best_entry(view, ways, 0, |entry: &CellEntry| {
        let away = i32::try_from(view.grid.cell(entry.target).x.abs_diff(here.x)).unwrap_or(i32::MAX);
        let aside = if matches!(entry.at.heading, Heading::East | Heading::West) { ASIDE } else { 0 };
        COLUMN.saturating_mul(away).saturating_add(aside)
    })
}
