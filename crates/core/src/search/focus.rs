//! Chooses the areas that are searched next.
//!
//! ```text
//!   map ── flood over visited and unknown cells ─► for each region: the way to it, and what is left of it
//!   areas ─ densities ──────────────────────────► the region with the best probability for its cost, or the ordered one
//!                                                  └─► the strategy chooses among its open places, or goes towards it
//! ```

use super::areas::{AreaPlan, Focus};
use super::entries::Visit;
use super::grid::{Spot, Square};
use super::plan::after;
use super::view::{Objective, View};
use super::ways::Ways;
use crate::command::Move;

/// Cost of a region's search, in steps per cell that is left, for a robot without and with a sonar. Tuned like `SIMILAR`
/// with `hallsweep-evaluation evaluate --areas --seed 1`.
const A_CELL: [f64; 2] = [1.8, 0.6];

/// Share of the chosen region's density from which another region is searched together with it.
const SIMILAR: f64 = 0.7;

/// Number of cells after which a flood ends. Areas farther away are chosen when the robot has come closer.
const MOST: usize = 1 << 18;

/// What is left of a region.
#[derive(Clone, Copy, Debug, Default)]
struct Left {
    /// Number of unknown cells that may be reached. A seen cell counts with the probability that looks have missed it.
    cells: f64,
    /// The nearest such cell, and the steps to it.
    nearest: Option<(Spot, u32)>,
}

impl<'a> View<'a> {
    /// Returns this view with the regions that are searched next, or a cell to visit on the way to them.
    pub(super) fn focused(&self, ways: &mut Ways) -> Result<View<'a>, Visit> {
        let view = *self;
        let Some(Focus { plan, .. }) = self.areas else { return Ok(view) };
        let finds = self.terms.objective == Objective::Find;
        if plan.order.is_empty() && !finds {
            return Ok(view);
        }
        let left = self.survey(plan, ways);
        let wanted = match plan.order.iter().find(|n| left[**n].nearest.is_some()) {
            Some(ordered) => 1 << ordered,
            None if finds => self.best(plan, &left),
            None => return Ok(view),
        };
        let nearest = (0..left.len()).filter(|n| wanted >> n & 1 == 1).filter_map(|n| left[n].nearest);
        let Some((end, _)) = nearest.min_by_key(|(_, steps)| *steps) else { return Ok(view) };
        let view = View { areas: Some(Focus { plan, wanted }), ..view };
        let (_, mut route) = ways.steps.trace(self.grid, self.pose, end);
        let mut pose = self.pose;
        let is_new = |step: &Move| {
            pose = after(pose, *step);
            pose.cell != self.pose.cell && self.grid.at(pose.cell) != Square::Visited
        };
        let Some(last) = route.iter().position(is_new) else { return Ok(view) };
        route.truncate(last + 1);
        if view.wants(self.grid.spot(pose.cell)) { Ok(view) } else { Err(Visit { cell: pose.cell, route }) }
    }

    /// Floods the visited cells and the unknown cells, as if these were free.
    fn survey(&self, plan: &AreaPlan, ways: &mut Ways) -> Vec<Left> {
        let grid = self.grid;
        let within = grid.known().including(plan.bounds.least).including(plan.bounds.most).grown(1);
        let passable = |spot: Spot| match grid.here(spot) {
            Square::Visited => true,
            Square::Unknown | Square::Seen | Square::Target => {
                let cell = grid.cell(spot);
                within.contains(cell) && !plan.is_closed(cell)
            }
            Square::Obstacle | Square::Luggage | Square::KeptOut => false,
        };
        let (mut left, mut cells) = (vec![Left::default(); plan.regions.len()], 0);
        let _nowhere = ways.steps.flood(grid, grid.spot(self.pose.cell), passable, |spot, steps| {
            cells += 1;
            let square = grid.here(spot);
            if square.is_open() {
                let region = plan.rows.at(grid.cell(spot));
                let share = if square == Square::Seen { plan.missed } else { 1.0 };
                left[region].cells += share;
                if share > 0.0 || plan.order.contains(&region) {
                    left[region].nearest.get_or_insert((spot, steps));
                }
            }
            cells > MOST
        });
        left
    }

    /// Returns the region with the highest probability for its cost, and those that are about as dense or denser. If no
    /// region has a probability, returns all regions that are not closed.
    fn best(&self, plan: &AreaPlan, left: &[Left]) -> u128 {
        let densities = plan.densities(self.grid);
        let a_cell = A_CELL[usize::from(self.terms.sonar_cells > 0)];
        let value = |n: usize| {
            let Left { cells, nearest: Some((_, steps)) } = left[n] else { return 0.0 };
            densities[n] * cells / (f64::from(steps) + a_cell * cells)
        };
        let best = (0..left.len()).max_by(|one, other| value(*one).total_cmp(&value(*other))).unwrap_or(0);
        if value(best) <= 0.0 {
            return plan.open;
        }
        // Where everything was seen, there is nothing to gain, but a region of the same density may be the way.
        let is_similar = |n: &usize| {
            densities[*n] >= SIMILAR * densities[best] && (left[*n].cells > 0.0 || densities[*n] * SIMILAR <= densities[best])
        };
        let similar = (0..left.len()).filter(is_similar);
        similar.fold(0, |wanted, n| wanted | 1 << n) & plan.open
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::costs::Costs;
    use crate::search::grid::Grid;
    use crate::search::{Gait, NextGoal, Search, Terms};
    use crate::units::{Bounds, Cell, Pose};
    use crate::world::areas::Area;
    use crate::world::coverage::{Sensor, SensorModel};

    /// Six cells in a row.
    fn area(name: &str, probability: f64, x: i32) -> Area {
        Area { name: name.into(), probability, corners: [Cell::new(x, 0), Cell::new(x + 5, 0)].into() }
    }

    fn plan(areas: [Area; 2], sensor: Sensor) -> AreaPlan {
        AreaPlan::new(&areas, &[], |_| false, sensor).expect("there are areas")
    }

    /// A corridor with the robot in its middle. The west was seen, and the bomb is probably there. The east is unknown.
    fn goal(sensor: Sensor) -> Option<Cell> {
        let mut grid = Grid::with_room_for(Bounds { least: Cell::new(-9, -9), most: Cell::new(9, 9) });
        for x in -6..=6 {
            grid.set(Cell::new(x, -1), Square::Obstacle);
            grid.set(Cell::new(x, 1), Square::Obstacle);
            grid.set(Cell::new(-x.abs(), 0), Square::Seen);
        }
        grid.set(Cell::HOME, Square::Visited);
        let plan = plan([area("west", 0.9, -6), area("east", 0.1, 1)], sensor);
        let terms = Terms { objective: Objective::Find, sonar_cells: sensor.cells, costs: Costs::EVEN };
        let view = View { grid: &grid, pose: Pose::START, gait: Gait::default(), terms, areas: Some(plan.focus()) };
        match Search::Of(crate::command::Strategy::Frontier).next(&view, &mut Ways::default()) {
            NextGoal::Visit(cell, _) => Some(cell),
            NextGoal::GoHome | NextGoal::Finished => None,
        }
    }

    #[test]
    fn what_was_only_seen_counts_with_the_probability_that_a_look_misses() {
        let calibrated = Sensor { cells: 8, model: Some(SensorModel::SimCamera) };
        let missed = plan([area("a", 0.5, 0), area("b", 0.5, 6)], calibrated).missed;
        assert!(missed > 0.2, "else this test means nothing: {missed}");
        assert_eq!(goal(calibrated), Some(Cell::new(-1, 0)), "much of the probability is left where the bomb was not seen");
        assert_eq!(goal(Sensor { cells: 8, model: None }), Some(Cell::new(1, 0)), "seen counts as searched");
    }
}
