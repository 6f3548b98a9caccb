//! The planner: the least number of moves from a pose to a cell, a pose, or the nearest of many cells.
//! A step and a turn cost one move each, so a breadth-first search over cell × heading is exact. What to aim at is a strategy's
//! business; whether the robot may move is the mission's.

use std::ops::ControlFlow;

use crate::core::command::Move;
use crate::core::units::{Cell, Heading, Pose};
use crate::core::world::hall_map::{Bounds, HallMap, Mark};

/// Which cells a way may lead through. The goal itself may also be unknown, or an obstacle that is still to be inspected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Through {
    /// Only cells the robot has visited.
    Known,
    /// Unknown cells too, taken to be free until they prove not to be.
    Unknown,
}

/// Finds ways; keeps its working memory from one search to the next.
#[derive(Clone, Debug, Default)]
pub struct Planner {
    /// For each state the search that last saw it, so that nothing needs to be wiped.
    seen: Vec<u32>,
    /// For each state the move that led to it.
    came_by: Vec<u8>,
    search: u32,
    area: Option<Bounds>,
}

const MOVES: [Move; 3] = [Move::Forward, Move::TurnLeft, Move::TurnRight];

impl Planner {
    /// The shortest way to `goal`; empty when the robot stands there, `None` when there is none. A goal beyond what is known is
    /// approached by way of the edge of the known, as if all beyond were free.
    pub fn to_cell(&mut self, map: &HallMap, start: Pose, goal: Cell, through: Through) -> Option<Vec<Move>> {
        let area = map.known_bounds().including(start.cell).grown();
        if !area.contains(goal) {
            return if through == Through::Unknown { self.towards(map, start, goal, area) } else { None };
        }
        let passable = |cell: Cell, mark: Mark| may_enter(mark, through) || (cell == goal && may_aim_at(mark));
        self.search(map, area, start, passable, |pose, _| {
            if pose.cell == goal { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .map(|end| self.way(start, end))
    }

    /// The shortest way through visited cells to a cell and a heading.
    pub fn to_pose(&mut self, map: &HallMap, start: Pose, goal: Pose) -> Option<Vec<Move>> {
        let area = map.known_bounds().including(start.cell).grown();
        let found = |pose: Pose, _| if pose == goal { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        self.search(map, area, start, |_, mark| mark == Mark::Visited, found).map(|end| self.way(start, end))
    }

    /// The cell that is reached with the fewest moves through visited cells among those that are unknown, or still to be
    /// inspected, and `wanted`.
    pub fn nearest(&mut self, map: &HallMap, start: Pose, wanted: impl Fn(Cell) -> bool) -> Option<Cell> {
        let area = map.known_bounds().including(start.cell).grown();
        let target = |cell: Cell, mark: Mark| mark != Mark::Visited && may_aim_at(mark) && wanted(cell);
        let found =
            |pose: Pose, _| if target(pose.cell, map.at(pose.cell)) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        self.search(map, area, start, |cell, mark| mark == Mark::Visited || target(cell, mark), found).map(|pose| pose.cell)
    }

    /// Towards a goal outside `area`: to the edge from which the rest, taken as free, is shortest.
    fn towards(&mut self, map: &HallMap, start: Pose, goal: Cell, area: Bounds) -> Option<Vec<Move>> {
        let mut best: Option<(u64, Pose)> = None;
        let on_edge = |cell: Cell| {
            !Bounds { least: Cell::new(area.least.x + 1, area.least.y + 1), most: Cell::new(area.most.x - 1, area.most.y - 1) }
                .contains(cell)
        };
        let _ = self.search(
            map,
            area,
            start,
            |_, mark| may_enter(mark, Through::Unknown),
            |pose, depth| {
                let rest = u64::from(pose.cell.x.abs_diff(goal.x)) + u64::from(pose.cell.y.abs_diff(goal.y));
                let whole = u64::from(depth) + rest;
                if on_edge(pose.cell) && best.is_none_or(|(least, _)| whole < least) {
                    best = Some((whole, pose));
                }
                ControlFlow::Continue(())
            },
        );
        best.map(|(_, end)| self.way(start, end))
    }

    /// Breadth-first from `start`; returns the pose at which `found` broke off.
    fn search(
        &mut self,
        map: &HallMap,
        area: Bounds,
        start: Pose,
        passable: impl Fn(Cell, Mark) -> bool,
        mut found: impl FnMut(Pose, u32) -> ControlFlow<()>,
    ) -> Option<Pose> {
        self.prepare(area);
        let mut level = vec![start];
        self.note(start, 0);
        let mut depth = 0;
        while !level.is_empty() {
            let mut next = Vec::with_capacity(level.len() * 2);
            for pose in level {
                if found(pose, depth).is_break() {
                    return Some(pose);
                }
                for (by, step) in (0..).zip(MOVES) {
                    let to = after(pose, step);
                    let open = step != Move::Forward || (area.contains(to.cell) && passable(to.cell, map.at(to.cell)));
                    if open && self.note(to, by) {
                        next.push(to);
                    }
                }
            }
            level = next;
            depth += 1;
        }
        None
    }

    fn prepare(&mut self, area: Bounds) {
        let states =
            usize::try_from(i64::from(area.width()) * i64::from(area.height()) * 4).expect("an area has a positive size");
        if self.area != Some(area) || self.search == u32::MAX {
            self.seen.clear();
            self.search = 0;
            self.area = Some(area);
        }
        self.seen.resize(states, 0);
        self.came_by.resize(states, 0);
        self.search += 1;
    }

    /// Notes that this search reached `pose` by move number `by`; false when it had been there before.
    fn note(&mut self, pose: Pose, by: u8) -> bool {
        let state = self.state(pose);
        let fresh = self.seen[state] != self.search;
        if fresh {
            self.seen[state] = self.search;
            self.came_by[state] = by;
        }
        fresh
    }

    fn state(&self, pose: Pose) -> usize {
        let area = self.area.expect("prepare has set the area of this search");
        let cell = i64::from(pose.cell.y - area.least.y) * i64::from(area.width()) + i64::from(pose.cell.x - area.least.x);
        usize::try_from(cell * 4 + pose.heading as i64).expect("a pose inside the area has a place")
    }

    /// The moves from `start` to `end`, read backwards from where the search came.
    fn way(&self, start: Pose, end: Pose) -> Vec<Move> {
        let mut moves = Vec::new();
        let mut pose = end;
        while pose != start {
            let step = MOVES[usize::from(self.came_by[self.state(pose)])];
            pose = before(pose, step);
            moves.push(step);
        }
        moves.reverse();
        moves
    }
}

/// Where a move leads when nothing is in the way.
#[must_use]
pub fn after(pose: Pose, step: Move) -> Pose {
    match step {
        Move::Forward => Pose { cell: pose.ahead(), ..pose },
        Move::Backward => Pose { cell: pose.cell.ahead(pose.heading.opposite()), ..pose },
        Move::TurnLeft => Pose { heading: pose.heading.left(), ..pose },
        Move::TurnRight => Pose { heading: pose.heading.right(), ..pose },
        Move::NudgeLeft | Move::NudgeRight => pose,
    }
}

fn before(pose: Pose, step: Move) -> Pose {
    let undo = match step {
        Move::Forward => Move::Backward,
        Move::Backward => Move::Forward,
        Move::TurnLeft => Move::TurnRight,
        Move::TurnRight => Move::TurnLeft,
        Move::NudgeLeft => Move::NudgeRight,
        Move::NudgeRight => Move::NudgeLeft,
    };
    after(pose, undo)
}

const fn may_enter(mark: Mark, through: Through) -> bool {
    match mark {
        Mark::Visited => true,
        Mark::Unknown => matches!(through, Through::Unknown),
        Mark::Wall | Mark::Luggage | Mark::NotInspected => false,
    }
}

const fn may_aim_at(mark: Mark) -> bool {
    matches!(mark, Mark::Visited | Mark::Unknown | Mark::NotInspected)
}

/// The cells a way passes, the start left out.
#[must_use]
pub fn cells_along(start: Pose, moves: impl IntoIterator<Item = Move>) -> Vec<Cell> {
    let mut pose = start;
    let mut cells = Vec::new();
    for step in moves {
        let next = after(pose, step);
        if next.cell != pose.cell {
            cells.push(next.cell);
        }
        pose = next;
    }
    cells
}

/// The heading in which `cell` lies as seen from its neighbour `from`.
#[must_use]
pub fn heading_to(from: Cell, cell: Cell) -> Option<Heading> {
    Heading::ALL.into_iter().find(|heading| from.ahead(*heading) == cell)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::units::Revision;

    /// A map from a drawing: `.` visited, `?` unknown, `#` wall, `b` a bag still to be inspected; the first cell is (0, 0).
    fn map(rows: &[&str]) -> HallMap {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        for (y, row) in (0..).zip(rows) {
            for (x, mark) in (0..).zip(row.chars()) {
                let mark = match mark {
                    '.' => Mark::Visited,
                    '#' => Mark::Wall,
                    'b' => Mark::NotInspected,
                    _ => continue,
                };
                map.mark(Cell::new(x, y), mark, Revision(2));
            }
        }
        map
    }

    fn ends_at(moves: &[Move]) -> Pose {
        moves.iter().fold(Pose::START, |pose, step| after(pose, *step))
    }

    #[test]
    fn the_way_to_a_cell_counts_turns_and_steps_alike() {
        let way = Planner::default().to_cell(&map(&["..", ".."]), Pose::START, Cell::new(1, 1), Through::Known).unwrap();
        assert_eq!(way, [Move::Forward, Move::TurnLeft, Move::Forward]);
    }

    #[test]
    fn a_known_way_never_enters_the_unknown() {
        let map = map(&["...", "#?.", "..."]);
        let mut planner = Planner::default();
        let known = planner.to_cell(&map, Pose::START, Cell::new(0, 2), Through::Known).unwrap();
        let daring = planner.to_cell(&map, Pose::START, Cell::new(0, 2), Through::Unknown).unwrap();
        assert!(known.len() > daring.len());
        assert!(cells_along(Pose::START, known).iter().all(|cell| map.at(*cell) == Mark::Visited));
    }

    #[test]
    fn a_bag_is_a_goal_but_never_a_way() {
        let map = map(&[".", "b", "."]);
        let mut planner = Planner::default();
        assert_eq!(planner.to_cell(&map, Pose::START, Cell::new(0, 1), Through::Known), Some(vec![Move::Forward]));
        assert_eq!(planner.to_cell(&map, Pose::START, Cell::new(0, 2), Through::Known), None);
        assert_eq!(planner.nearest(&map, Pose::START, |_| true), Some(Cell::new(0, 1)));
    }

    #[test]
    fn a_wall_is_not_a_goal() {
        let found = Planner::default().to_cell(&map(&[".", "#"]), Pose::START, Cell::new(0, 1), Through::Unknown);
        assert_eq!(found, None);
    }

    #[test]
    fn a_goal_far_beyond_the_known_is_approached_straight() {
        let way = Planner::default().to_cell(&map(&["."]), Pose::START, Cell::new(0, 8000), Through::Unknown).unwrap();
        assert_eq!(way, [Move::Forward]);
    }

    #[test]
    fn a_pose_is_reached_with_its_heading() {
        let goal = Pose { cell: Cell::new(1, 0), heading: Heading::West };
        let way = Planner::default().to_pose(&map(&["..", ".."]), Pose::START, goal).unwrap();
        assert_eq!(ends_at(&way), goal);
    }
}
