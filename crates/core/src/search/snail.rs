//! The *chiocciola* (snail) of the original specification. It goes towards (1,1), (2,2), … in turn. Each time it
//! visits everything unknown in the square [0..k]×[0..k] and returns home. Then it visits whatever is left, nearest
//! first (mission §5).
//!
//! The original says "no plan to (k,k) means that the walls are found". Taken literally, this rule leaves halls
//! incomplete. Here the square stops growing only when nothing unknown outside it can be reached south-east of home.
//! If (k,k) is beyond a far wall, the goal is moved to the last column or row in front of it, as in the original. The
//! search is over when nothing unknown can be reached anywhere.
//!
//! Closed areas are left out. The order and the probabilities of areas are not used.

use super::entries::{Visit, nearest};
use super::grid::{Square, onward};
use super::view::{NextGoal, View};
use super::ways::Ways;
use crate::units::{Cell, Heading};
use crate::world::hall_map::{Bounds, REACH};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Snail {
    ring: i32,
    stage: SnailStage,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SnailStage {
    Corner,
    /// Visit the unknown cells in the square of the ring.
    Fill,
    NextRing,
    /// Both far walls are known. Visit the unknown cells that are left.
    Finish,
    Done,
}

/// The stages, in the order of their numbers in notes. A new stage must be added at the end.
const STAGES: [SnailStage; 5] =
    [SnailStage::Corner, SnailStage::Fill, SnailStage::NextRing, SnailStage::Finish, SnailStage::Done];

impl Default for Snail {
    fn default() -> Snail {
        Snail { ring: 1, stage: SnailStage::Corner }
    }
}

impl Snail {
    /// Returns the snail's progress, as plain numbers for the record.
    pub(super) fn notes(&self) -> Vec<i64> {
        vec![i64::from(self.ring), STAGES.iter().position(|stage| *stage == self.stage).unwrap_or(0) as i64]
    }

    /// Returns the snail that made these notes. Impossible notes give a new snail.
    pub(super) fn from_notes(notes: &[i64]) -> Snail {
        let ring = notes.first().and_then(|ring| i32::try_from(*ring).ok()).filter(|ring| (1..=2 * REACH).contains(ring));
        let stage = notes.get(1).and_then(|place| STAGES.get(usize::try_from(*place).ok()?));
        ring.zip(stage).map_or_else(Snail::default, |(ring, stage)| Snail { ring, stage: *stage })
    }

    /// Returns the next goal. It is called when the last goal is reached, is an obstacle, or cannot be reached.
    pub(super) fn next(&mut self, view: &View<'_>, ways: &mut Ways) -> NextGoal {
        loop {
            match self.stage {
                SnailStage::Corner => {
                    self.stage = SnailStage::Fill;
                    let corner = self.corner(view, ways);
                    if view.wants(view.grid.spot(corner)) {
                        return NextGoal::Visit(corner, Vec::new());
                    }
                }
                SnailStage::Fill => {
                    let square = Bounds { least: Cell::HOME, most: Cell::new(self.ring, self.ring) };
                    if let Some(Visit { cell, route }) = nearest(view, ways, |cell| square.contains(cell)) {
                        return NextGoal::Visit(cell, route);
                    }
                    self.stage = SnailStage::NextRing;
                    return NextGoal::GoHome;
                }
                SnailStage::NextRing => {
                    // Both far walls are known when nothing unknown outside the ring's square can be reached
                    // south-east of home.
                    let ring = self.ring;
                    let beyond = nearest(view, ways, |cell| cell.x >= 0 && cell.y >= 0 && cell.x.max(cell.y) > ring);
                    self.stage = if beyond.is_none() { SnailStage::Finish } else { SnailStage::Corner };
                    self.ring += 1;
                }
                SnailStage::Finish => {
                    if let Some(Visit { cell, route }) = nearest(view, ways, |_| true) {
                        return NextGoal::Visit(cell, route);
                    }
                    self.stage = SnailStage::Done;
                    return NextGoal::GoHome;
                }
                SnailStage::Done if nearest(view, ways, |_| true).is_some() => self.stage = SnailStage::Finish,
                SnailStage::Done => return NextGoal::Finished,
            }
        }
    }

    /// Returns (k,k), or the last column and row in front of a far wall.
    fn corner(&self, view: &View<'_>, ways: &mut Ways) -> Cell {
        let mut most = view.pose.cell;
        let grid = view.grid;
        let passable = |spot| grid.here(spot) == Square::Visited;
        let _nowhere = ways.steps.way(grid, view.pose, passable, |spot| {
            let around = Heading::ALL.map(|heading| onward(spot, grid.step(heading)));
            for spot in around.into_iter().filter(|next| grid.here(*next).is_open()).chain([spot]) {
                let cell = grid.cell(spot);
                most = Cell::new(most.x.max(cell.x), most.y.max(cell.y));
            }
            false
        });
        Cell::new(self.ring.min(most.x), self.ring.min(most.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::Gait;
    use crate::search::costs::Costs;
    use crate::search::grid::Grid;
    use crate::search::{Objective, Terms};
    use crate::units::{Pose, Revision};
    use crate::world::hall_map::{HallMap, Mark};

    /// If a passage is blocked after the robot drove through it, nobody can reach the unknown cells behind it.
    #[test]
    fn a_search_ends_although_a_passage_was_blocked_behind_which_the_unknown_goes_on() {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        for y in 1..6 {
            map.mark(Cell::new(0, y), Mark::Visited, Revision(1));
        }
        for cell in [Cell::new(-1, 0), Cell::new(1, 0), Cell::new(0, -1), Cell::new(0, 1)] {
            map.mark(cell, Mark::Wall, Revision(2));
        }
        let (mut snail, mut ways, grid) = (Snail::default(), Ways::default(), Grid::of(&map));
        let terms = Terms { objective: Objective::Find, sonar_cells: 0, costs: Costs::EVEN };
        let view = View { grid: &grid, pose: Pose::START, gait: Gait::default(), terms, areas: None };
        let finished = (0..100).any(|_| snail.next(&view, &mut ways) == NextGoal::Finished);
        assert!(finished);
    }
}
