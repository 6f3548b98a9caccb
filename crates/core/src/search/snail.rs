//! The seeds' *chiocciola*: towards (1,1), (2,2), … with everything unknown in the square [0..k]×[0..k] visited and a return
//! home after each, then whatever is left, nearest first (mission §5).
//!
//! Taken literally, "no plan to (k,k) means that the walls are found" leaves halls incomplete. Here a ring ends the growing only
//! when nothing unknown lies next to a visited cell south-east of home; and a ring beyond a far wall aims at the last column or
//! row in front of it, as the seeds clamp their goals. The search is over when nothing unknown can be reached anywhere.

use super::plan::Planner;
use super::{NextGoal, View};
use crate::units::Cell;
use crate::world::hall_map::REACH;

/// Where a snail has come to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Snail {
    ring: i32,
    stage: Stage,
}

/// What comes next in a ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Set out for the ring's corner.
    Corner,
    /// Visit what is unknown in the ring's square.
    Fill,
    /// Home, then the next ring.
    NextRing,
    /// Both far walls are known: visit what is left.
    Finish,
    /// Nothing is left: home.
    Done,
}

/// The stages by their numbers in notes: new ones go to the end.
const STAGES: [Stage; 5] = [Stage::Corner, Stage::Fill, Stage::NextRing, Stage::Finish, Stage::Done];

impl Default for Snail {
    fn default() -> Snail {
        Snail { ring: 1, stage: Stage::Corner }
    }
}

impl Snail {
    /// How far it has come, as plain numbers for the record.
    pub(super) fn notes(&self) -> Vec<i64> {
        vec![i64::from(self.ring), STAGES.iter().position(|stage| *stage == self.stage).unwrap_or(0) as i64]
    }

    /// The snail that made these notes; one that cannot have made them begins anew.
    pub(super) fn from_notes(notes: &[i64]) -> Snail {
        let ring = notes.first().and_then(|ring| i32::try_from(*ring).ok()).filter(|ring| (1..=2 * REACH).contains(ring));
        let stage = notes.get(1).and_then(|place| STAGES.get(usize::try_from(*place).ok()?));
        ring.zip(stage).map_or_else(Snail::default, |(ring, stage)| Snail { ring, stage: *stage })
    }

    /// What to do now that the last goal is reached, or given up.
    pub(super) fn next(&mut self, view: &View<'_>, planner: &mut Planner) -> NextGoal {
        loop {
            match self.stage {
                Stage::Corner => {
                    self.stage = Stage::Fill;
                    return NextGoal::Visit(self.corner(view));
                }
                Stage::Fill => match self.nearest_in_square(view, planner) {
                    Some(cell) => return NextGoal::Visit(cell),
                    None => {
                        self.stage = Stage::NextRing;
                        return NextGoal::GoHome;
                    }
                },
                Stage::NextRing => {
                    self.stage = if nothing_lies_beyond(view, self.ring) { Stage::Finish } else { Stage::Corner };
                    self.ring += 1;
                }
                Stage::Finish => match planner.nearest(view.map, view.pose, |_| true) {
                    Some(cell) => return NextGoal::Visit(cell),
                    None => {
                        self.stage = Stage::Done;
                        return NextGoal::GoHome;
                    }
                },
                Stage::Done if planner.nearest(view.map, view.pose, |_| true).is_some() => self.stage = Stage::Finish,
                Stage::Done => return NextGoal::Finished,
            }
        }
    }

    /// (k,k), or the last column and row in front of a far wall.
    fn corner(&self, view: &View<'_>) -> Cell {
        let most = view.map.visited_bounds().most;
        let frontier = view.map.frontier().iter();
        let most = frontier.fold(most, |most, cell| Cell::new(most.x.max(cell.x), most.y.max(cell.y)));
        Cell::new(self.ring.min(most.x), self.ring.min(most.y))
    }

    fn nearest_in_square(&self, view: &View<'_>, planner: &mut Planner) -> Option<Cell> {
        let square = 0..=self.ring;
        // A search of everything reachable is spared when the frontier has nothing in the square.
        let any = view
            .map
            .frontier()
            .range(Cell::new(0, 0)..)
            .take_while(|cell| cell.x <= self.ring)
            .any(|cell| square.contains(&cell.y));
        let inside = |cell: Cell| square.contains(&cell.x) && square.contains(&cell.y);
        if any || view.map.uninspected() > 0 { planner.nearest(view.map, view.pose, inside) } else { None }
    }
}

/// Whether both far walls are known: south-east of home nothing unknown lies next to a visited cell outside the ring's square.
/// What is left inside it could not be reached.
fn nothing_lies_beyond(view: &View<'_>, ring: i32) -> bool {
    view.map.frontier().range(Cell::new(0, i32::MIN)..).all(|cell| cell.y < 0 || cell.x.max(cell.y) <= ring)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{Pose, Revision};
    use crate::world::hall_map::{HallMap, Mark};

    /// A passage that was driven through and is blocked now leaves unknown cells behind it that nobody can reach.
    #[test]
    fn a_search_ends_although_a_passage_was_blocked_behind_which_the_unknown_goes_on() {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        for y in 1..6 {
            map.mark(Cell::new(0, y), Mark::Visited, Revision(1));
        }
        for cell in [Cell::new(-1, 0), Cell::new(1, 0), Cell::new(0, -1), Cell::new(0, 1)] {
            map.mark(cell, Mark::Wall, Revision(2));
        }
        let (mut snail, mut planner) = (Snail::default(), Planner::default());
        let view = View { map: &map, pose: Pose::START };
        let finished = (0..100).any(|_| snail.next(&view, &mut planner) == NextGoal::Finished);
        assert!(finished);
    }
}
