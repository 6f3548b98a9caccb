//! Searches column by column, in turn up and down (boustrophedon). The robot drives along a column as far as
//! possible, then into the next column. Cells that were left behind an obstacle are visited when nothing is nearer.

use super::entries::{CellEntry, Visit, best_entry};
use super::view::View;
use super::ways::Ways;
use crate::units::Heading;

/// Penalty for entering a cell from the side, in thousandths of a step.
const ASIDE: i32 = 2000;

/// Penalty for each column between a cell and the robot, in thousandths of a step.
const COLUMN: i32 = 1000;

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    let here = view.pose.cell;
    best_entry(view, ways, 0, |entry: &CellEntry| {
        let away = i32::try_from(view.grid.cell(entry.target).x.abs_diff(here.x)).unwrap_or(i32::MAX);
        let aside = if matches!(entry.at.heading, Heading::East | Heading::West) { ASIDE } else { 0 };
        COLUMN.saturating_mul(away).saturating_add(aside)
    })
}
