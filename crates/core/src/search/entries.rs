//! The entries of a grid. An entry is a place from which the robot can enter an unknown cell, or can meet a piece
//! that is not inspected yet. Every strategy except the snail weighs entries in its own way.

use super::costs::{affordable, in_thousandths};
use super::far::turn;
use super::grid::{Grid, Spot, Square, onward};
use super::view::{Terms, View};
use super::ways::{Reached, Ways};
use crate::command::Move;
use crate::units::{Cell, Heading};

#[derive(Clone, Copy, Debug)]
pub(crate) struct CellEntry {
    /// The cell and heading from which the target is entered, with the cost of the way there.
    pub(crate) at: Reached,
    pub(crate) target: Spot,
}

/// A cell to enter, and the moves that lead into it, including the last step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Visit {
    pub(crate) cell: Cell,
    pub(crate) route: Vec<Move>,
}

/// Returns the entry with the lowest sum of its way and its `worth`, both in thousandths of a step. `worth` is lower
/// for cells that should be visited sooner. `worth` is never below `least`, so the search ends once no later entry
/// can be better.
pub(crate) fn best_entry(
    view: &View<'_>,
    ways: &mut Ways,
    least: i32,
    mut worth: impl FnMut(&CellEntry) -> i32,
) -> Option<Visit> {
    let View { grid, pose, terms: Terms { costs, .. }, .. } = *view;
    if !grid.has_open() {
        return None;
    }
    let mut best: Option<(i32, Spot, (Spot, Heading))> = None;
    let mut limit = u32::MAX;
    let all = ways.spread(grid, costs, pose, |at| {
        let target = onward(at.spot, grid.step(at.heading));
        if grid.here(target).is_open() && view.wants(target) {
            let score = in_thousandths(at.cost).saturating_add(worth(&CellEntry { at, target }));
            if best.is_none_or(|(so_far, ..)| score < so_far) {
                best = Some((score, target, (at.spot, at.heading)));
                limit = affordable(score.saturating_sub(least));
            }
        }
        limit
    });
    match best {
        Some((_, target, state)) => Some(visit(grid, ways, target, state)),
        None if all => None,
        None => far(view, ways, |_| true),
    }
}

pub(crate) fn nearest(view: &View<'_>, ways: &mut Ways, wanted: impl Fn(Cell) -> bool) -> Option<Visit> {
    let View { grid, pose, terms: Terms { costs, .. }, .. } = *view;
    if !grid.has_open() {
        return None;
    }
    let mut found = None;
    let all = ways.spread(grid, costs, pose, |at| {
        let target = onward(at.spot, grid.step(at.heading));
        if found.is_none() && grid.here(target).is_open() && view.wants(target) && wanted(grid.cell(target)) {
            found = Some((target, (at.spot, at.heading)));
        }
        if found.is_some() { 0 } else { u32::MAX }
    });
    match found {
        Some((target, state)) => Some(visit(grid, ways, target, state)),
        None if all => None,
        None => far(view, ways, wanted),
    }
}

/// Returns the nearest entry by number of steps, at any distance.
fn far(view: &View<'_>, ways: &mut Ways, wanted: impl Fn(Cell) -> bool) -> Option<Visit> {
    let grid = view.grid;
    let opens = |spot: Spot| {
        let is_wanted = |heading: &Heading| {
            let target = onward(spot, grid.step(*heading));
            grid.here(target).is_open() && view.wants(target) && wanted(grid.cell(target))
        };
        Heading::ALL.into_iter().find(is_wanted)
    };
    let passable = |spot: Spot| grid.here(spot) == Square::Visited;
    let (end, mut route) = ways.steps.way(grid, view.pose, passable, |spot| opens(spot).is_some())?;
    let heading = opens(grid.spot(end.cell)).expect("the search ends only where an entry opens");
    turn(&mut route, end.heading, heading);
    route.push(Move::Forward);
    Some(Visit { cell: end.cell.ahead(heading), route })
}

fn visit(grid: &Grid, ways: &Ways, target: Spot, state: (Spot, Heading)) -> Visit {
    let mut route = ways.way_to(grid, state);
    route.push(Move::Forward);
    Visit { cell: grid.cell(target), route }
}
