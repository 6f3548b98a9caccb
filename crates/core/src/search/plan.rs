//! The planner: the least number of moves from a pose to a cell, a pose, or the nearest of many cells.
//! A step and a turn cost one move each, so a breadth-first search over cell × heading is exact, and so is A* with the steps that
//! are left at least. What to aim at is a strategy's
//! business; whether the robot may move is the mission's.

use crate::command::Move;
use crate::units::{Cell, Pose};
use crate::world::hall_map::{Bounds, HallMap, Mark};

/// Which cells a way may lead through. The goal itself may also be unknown, or an obstacle that is still to be inspected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Through {
    Known,
    /// Unknown cells too, taken to be free until they prove not to be.
    Unknown,
}

/// Finds ways; keeps its working memory from one search to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Planner {
    /// For each state the search that last saw it, so that nothing needs to be wiped.
    seen: Vec<u32>,
    /// For each state the move that led to it.
    came_by: Vec<u8>,
    /// For each state the moves it takes.
    cost: Vec<u32>,
    search: u32,
    /// The cells that the memory has room for: what is known and a margin, so that it need not be laid out anew at every step.
    room: Option<Bounds>,
}

/// How far beyond the known the memory reaches when it is laid out anew, in cells.
const MARGIN: i32 = 64;

const MOVES: [Move; 3] = [Move::Forward, Move::TurnLeft, Move::TurnRight];

impl Planner {
    /// The shortest way to `goal`; empty when the robot stands there, `None` when there is none. A goal beyond what is known is
    /// approached by way of the edge of the known, as if all beyond were free.
    pub(crate) fn way_to_cell(&mut self, map: &HallMap, start: Pose, goal: Cell, through: Through) -> Option<Vec<Move>> {
        let area = map.known_bounds().including(start.cell).grown(1);
        if !area.contains(goal) {
            return if through == Through::Unknown { self.towards(map, start, goal, area) } else { None };
        }
        let passable = |cell: Cell, mark: Mark| may_enter(mark, through) || (cell == goal && may_aim_at(mark));
        self.guided(map, area, start, goal, passable).map(|end| self.way(start, end))
    }

    pub(crate) fn way_to_pose(&mut self, map: &HallMap, start: Pose, goal: Pose) -> Option<Vec<Move>> {
        let area = map.known_bounds().including(start.cell).grown(1);
        let end = self.search(map, area, start, |_, mark| mark == Mark::Visited, |pose, _| pose == goal)?;
        Some(self.way(start, end))
    }

    /// The cell that is reached with the fewest moves through visited cells among those that are unknown, or still to be
    /// inspected, and `wanted`.
    pub(crate) fn nearest(&mut self, map: &HallMap, start: Pose, wanted: impl Fn(Cell) -> bool) -> Option<Cell> {
        let area = map.known_bounds().including(start.cell).grown(1);
        let target = |cell: Cell, mark: Mark| mark != Mark::Visited && may_aim_at(mark) && wanted(cell);
        let found = |pose: Pose, _| target(pose.cell, map.at(pose.cell));
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
                false
            },
        );
        best.map(|(_, end)| self.way(start, end))
    }

    /// Breadth-first from `start`; returns the pose at which it is `found`.
    fn search(
        &mut self,
        map: &HallMap,
        area: Bounds,
        start: Pose,
        passable: impl Fn(Cell, Mark) -> bool,
        mut found: impl FnMut(Pose, u32) -> bool,
    ) -> Option<Pose> {
        self.prepare(area);
        let mut level = vec![start];
        self.improve(start, 0, 0);
        let mut depth = 0;
        while !level.is_empty() {
            let mut next = Vec::with_capacity(level.len() * 2);
            for pose in level {
                if found(pose, depth) {
                    return Some(pose);
                }
                for (by, step) in (0..).zip(MOVES) {
                    let to = after(pose, step);
                    let open = step != Move::Forward || (area.contains(to.cell) && passable(to.cell, map.at(to.cell)));
                    if open && self.improve(to, by, depth + 1) {
                        next.push(to);
                    }
                }
            }
            level = next;
            depth += 1;
        }
        None
    }

    /// A* from `start` to `goal`, guided by the steps that are left at least; among equals the one furthest on goes first, so that
    /// in the open it runs straight. Costs grow by whole moves, so a row of buckets is queue enough.
    fn guided(
        &mut self,
        map: &HallMap,
        area: Bounds,
        start: Pose,
        goal: Cell,
        passable: impl Fn(Cell, Mark) -> bool,
    ) -> Option<Pose> {
        self.prepare(area);
        let left = |pose: Pose| pose.cell.x.abs_diff(goal.x) + pose.cell.y.abs_diff(goal.y);
        let at_least = left(start);
        let mut buckets = vec![vec![(start, 0)]];
        self.improve(start, 0, 0);
        let mut extra = 0;
        while extra < buckets.len() {
            let Some((pose, cost)) = buckets[extra].pop() else {
                extra += 1;
                continue;
            };
            if pose.cell == goal {
                return Some(pose);
            }
            if self.cost[self.state(pose)] != cost {
                continue;
            }
            for (by, step) in (0..).zip(MOVES) {
                let to = after(pose, step);
                let open = step != Move::Forward || (area.contains(to.cell) && passable(to.cell, map.at(to.cell)));
                if open && self.improve(to, by, cost + 1) {
                    let bucket = (cost + 1 + left(to) - at_least) as usize;
                    buckets.resize_with(buckets.len().max(bucket + 1), Vec::new);
                    buckets[bucket].push((to, cost + 1));
                }
            }
        }
        None
    }

    fn prepare(&mut self, area: Bounds) {
        let fits = self.room.is_some_and(|room| room.contains(area.least) && room.contains(area.most));
        if !fits || self.search == u32::MAX {
            let room = area.grown(MARGIN);
            let states =
                usize::try_from(i64::from(room.width()) * i64::from(room.height()) * 4).expect("a room has a positive size");
            (self.seen, self.came_by, self.cost) = (vec![0; states], vec![0; states], vec![0; states]);
            (self.room, self.search) = (Some(room), 0);
        }
        self.search += 1;
    }

    /// Notes a way to `pose` of so many moves, the last of them move number `by`; false when one as short was known.
    fn improve(&mut self, pose: Pose, by: u8, cost: u32) -> bool {
        let state = self.state(pose);
        let better = self.seen[state] != self.search || cost < self.cost[state];
        if better {
            self.seen[state] = self.search;
            self.came_by[state] = by;
            self.cost[state] = cost;
        }
        better
    }

    fn state(&self, pose: Pose) -> usize {
        let room = self.room.expect("prepare has laid out the memory of this search");
        let cell = i64::from(pose.cell.y - room.least.y) * i64::from(room.width()) + i64::from(pose.cell.x - room.least.x);
        usize::try_from(cell * 4 + pose.heading as i64).expect("a pose inside the room has a place")
    }

    /// The moves from `start` to `end`, read backwards from where the search came.
    fn way(&self, start: Pose, end: Pose) -> Vec<Move> {
        let mut moves = Vec::new();
        let mut pose = end;
        while pose != start {
            let step = MOVES[usize::from(self.came_by[self.state(pose)])];
            pose = after(pose, step.reversed());
            moves.push(step);
        }
        moves.reverse();
        moves
    }
}

/// Where a move leads when nothing is in the way.
pub(crate) fn after(pose: Pose, step: Move) -> Pose {
    match step {
        Move::Forward => Pose { cell: pose.ahead(), ..pose },
        Move::Backward => Pose { cell: pose.cell.ahead(pose.heading.opposite()), ..pose },
        Move::TurnLeft => Pose { heading: pose.heading.left(), ..pose },
        Move::TurnRight => Pose { heading: pose.heading.right(), ..pose },
        Move::NudgeLeft | Move::NudgeRight => pose,
    }
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
pub(crate) fn cells_along(start: Pose, moves: impl IntoIterator<Item = Move>) -> Vec<Cell> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::{Heading, Revision};

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
        let way = Planner::default().way_to_cell(&map(&["..", ".."]), Pose::START, Cell::new(1, 1), Through::Known).unwrap();
        assert_eq!(way, [Move::Forward, Move::TurnLeft, Move::Forward]);
    }

    #[test]
    fn a_known_way_never_enters_the_unknown() {
        let map = map(&["...", "#?.", "..."]);
        let mut planner = Planner::default();
        let known = planner.way_to_cell(&map, Pose::START, Cell::new(0, 2), Through::Known).unwrap();
        let daring = planner.way_to_cell(&map, Pose::START, Cell::new(0, 2), Through::Unknown).unwrap();
        assert!(known.len() > daring.len());
        assert!(cells_along(Pose::START, known).iter().all(|cell| map.at(*cell) == Mark::Visited));
    }

    #[test]
    fn a_bag_is_a_goal_but_never_a_way() {
        let map = map(&[".", "b", "."]);
        let mut planner = Planner::default();
        assert_eq!(planner.way_to_cell(&map, Pose::START, Cell::new(0, 1), Through::Known), Some(vec![Move::Forward]));
        assert_eq!(planner.way_to_cell(&map, Pose::START, Cell::new(0, 2), Through::Known), None);
        assert_eq!(planner.nearest(&map, Pose::START, |_| true), Some(Cell::new(0, 1)));
    }

    #[test]
    fn a_wall_is_not_a_goal() {
        let found = Planner::default().way_to_cell(&map(&[".", "#"]), Pose::START, Cell::new(0, 1), Through::Unknown);
        assert_eq!(found, None);
    }

    #[test]
    fn a_goal_far_beyond_the_known_is_approached_straight() {
        let way = Planner::default().way_to_cell(&map(&["."]), Pose::START, Cell::new(0, 8000), Through::Unknown).unwrap();
        assert_eq!(way, [Move::Forward]);
    }

    /// The guided search is as exact as the plain one.
    #[test]
    fn the_way_to_a_cell_is_the_shortest_there_is() {
        let mut dice = crate::rng::RandomStream::new(1, "planner");
        for _ in 0..200 {
            let rows: Vec<String> =
                (0..12).map(|_| (0..12).map(|_| if dice.below(4) == 0 { '#' } else { '.' }).collect()).collect();
            let mut map = map(&rows.iter().map(String::as_str).collect::<Vec<_>>());
            map.mark(Cell::HOME, Mark::Visited, Revision(3));
            let goal = Cell::new(i32::try_from(dice.below(12)).unwrap(), i32::try_from(dice.below(12)).unwrap());
            let mut planner = Planner::default();
            let guided = planner.way_to_cell(&map, Pose::START, goal, Through::Known).map(|way| way.len());
            let turned = Heading::ALL.map(|heading| planner.way_to_pose(&map, Pose::START, Pose { cell: goal, heading }));
            let plain = turned.into_iter().flatten().map(|way| way.len()).min();
            assert_eq!(guided, plain, "to {goal}");
        }
    }

    #[test]
    fn a_pose_is_reached_with_its_heading() {
        let goal = Pose { cell: Cell::new(1, 0), heading: Heading::West };
        let way = Planner::default().way_to_pose(&map(&["..", ".."]), Pose::START, goal).unwrap();
        assert_eq!(ends_at(&way), goal);
    }
}
