//! The same questions answered by the crate `pathfinding`, over the same states (cell and heading) at the same costs.

use hallsweep_core::search::costs::{Costs, STEP};
use hallsweep_core::search::grid::{Grid, Square};
use hallsweep_core::units::{Cell, Pose};
use pathfinding::prelude::{astar, bfs, dijkstra};

/// Cost of the cheapest way over visited cells; the heuristic is the smallest number of remaining steps.
pub(crate) fn way(grid: &Grid, costs: Costs, start: Pose, goal: Cell) -> Option<u32> {
    let left = |pose: &Pose| (pose.cell.x.abs_diff(goal.x) + pose.cell.y.abs_diff(goal.y)) * STEP;
    astar(&start, |pose| next(grid, costs, *pose), left, |pose| pose.cell == goal).map(|(_, cost)| cost)
}

/// Smallest number of steps to a cell.
pub(crate) fn steps(grid: &Grid, start: Cell, goal: Cell) -> Option<usize> {
    let next = |cell: &Cell| cell.neighbours().into_iter().filter(|cell| grid.at(*cell) == Square::Visited).collect::<Vec<_>>();
    bfs(&start, next, |cell| *cell == goal).map(|cells| cells.len() - 1)
}

/// Cost of reaching a pose that faces the nearest unknown cell.
pub(crate) fn nearest(grid: &Grid, costs: Costs, start: Pose) -> Option<u32> {
    let opens = |pose: &Pose| matches!(grid.at(pose.ahead()), Square::Unknown | Square::Seen | Square::Target);
    dijkstra(&start, |pose| next(grid, costs, *pose), opens).map(|(_, cost)| cost)
}

/// Poses after one move, with the cost of the move.
fn next(grid: &Grid, costs: Costs, pose: Pose) -> impl Iterator<Item = (Pose, u32)> + use<> {
    let ahead = Pose { cell: pose.ahead(), ..pose };
    let step = (grid.at(ahead.cell) == Square::Visited).then_some((ahead, STEP));
    let turns = [pose.heading.left(), pose.heading.right()].map(|heading| (Pose { heading, ..pose }, costs.turn));
    step.into_iter().chain(turns)
}
