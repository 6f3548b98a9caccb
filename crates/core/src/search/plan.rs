//! The planner: the engine's occupancy grid, and the cheapest ways on it to a cell or a pose. The strategy decides
//! where to go. The mission decides whether the robot may move.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

use super::Search;
use super::areas::AreaPlan;
use super::costs::{Costs, STEP};
use super::far::{Steps, turn};
use super::grid::{Grid, Spot, Square};
use super::view::{Gait, NextGoal, Objective, Terms, View};
use super::ways::Ways;
use crate::command::Move;
use crate::units::{Cell, Heading, Pose};
use crate::world::hall_map::{Bounds, HallMap, Mark};
use crate::world::keep_out::KeepOut;

/// Which cells a way may lead through. The goal itself may also be unknown, or an obstacle that is not inspected yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Through {
    Known,
    /// Unknown cells too, which are assumed to be free.
    Unknown,
}

#[derive(Clone, Debug)]
pub(crate) struct Planner {
    pub(crate) grid: Grid,
    pub(crate) ways: Ways,
    pub(crate) costs: Costs,
    /// The rings that no way enters. `set_keep_out` changes them.
    pub(crate) keep_out: KeepOut,
    /// `None` if the hall has no areas. `set_areas` changes it.
    pub(crate) areas: Option<AreaPlan>,
}

impl Planner {
    pub(crate) fn of(map: &HallMap) -> Planner {
        Planner { grid: Grid::of(map), ways: Ways::default(), costs: Costs::EVEN, keep_out: KeepOut::default(), areas: None }
    }

    pub(crate) fn learn(&mut self, map: &HallMap) {
        self.grid = Grid::of(map);
        // With this room, a way towards an area is found before the robot is near.
        if let Some(AreaPlan { bounds, .. }) = &self.areas {
            self.grid.make_room(bounds.least);
            self.grid.make_room(bounds.most);
        }
        self.shut_rings();
    }

    pub(crate) fn set_areas(&mut self, areas: Option<AreaPlan>, map: &HallMap) {
        self.areas = areas;
        self.learn(map);
    }

    pub(crate) fn set_keep_out(&mut self, keep_out: KeepOut, map: &HallMap) {
        self.keep_out = keep_out;
        self.learn(map);
    }

    /// Shuts the cells of the rings as far as ways may lead, which is one cell beyond the known area.
    fn shut_rings(&mut self) {
        for cell in self.keep_out.cells_within(self.grid.known().grown(1)) {
            self.grid.keep_out_of(cell);
        }
    }

    pub(crate) fn mark(&mut self, cell: Cell, map: &HallMap) {
        let known = self.grid.known();
        self.grid.mark(cell, map.at(cell));
        if self.grid.known() != known || self.keep_out.contains(cell) {
            self.shut_rings();
        }
    }

    pub(crate) fn ask(&mut self, search: &mut Search, pose: Pose, gait: Gait, objective: Objective, sonar_cells: u8) -> NextGoal {
        let Planner { grid, ways, costs, areas, .. } = self;
        if !grid.has_room_for(pose.cell) {
            return NextGoal::GoHome;
        }
        let terms = Terms { objective, sonar_cells, costs: *costs };
        search.next(&View { grid, pose, gait, terms, areas: areas.as_ref().map(AreaPlan::focus) }, ways)
    }

    /// Whether a way over visited cells leads to the goal.
    pub(crate) fn knows_way(&self, start: Pose, goal: Cell) -> bool {
        let passable = |spot: Spot| self.grid.here(spot) == Square::Visited;
        Ways::default().way_to_cell(&self.grid, self.costs, start, goal, passable).is_some()
    }

    /// Returns a way over visited cells to a cell for which `is_goal` holds. It is the way with the least exposure, and
    /// among equal ways a shortest one. A cell in a ring exposes the robot by the radius divided by the distance.
    pub(crate) fn way_through_rings(&self, map: &HallMap, start: Pose, is_goal: impl Fn(Cell) -> bool) -> Option<Vec<Move>> {
        let mut open = BinaryHeap::from([Reverse((0, 0, self.grid.spot(start.cell), None))]);
        let mut before = BTreeMap::new();
        let end = loop {
            let Reverse((exposure, length, spot, from)) = open.pop()?;
            if before.contains_key(&spot) {
                continue;
            }
            before.insert(spot, from);
            if is_goal(self.grid.cell(spot)) {
                break spot;
            }
            for heading in Heading::ALL {
                let next = self.grid.cell(spot).ahead(heading);
                if map.at(next) == Mark::Visited {
                    let exposure = exposure + self.keep_out.exposure(next);
                    open.push(Reverse((exposure, length + 1, self.grid.spot(next), Some(spot))));
                }
            }
        };
        let way: BTreeSet<Spot> = std::iter::successors(Some(end), |spot| before[spot]).collect();
        Steps::default().way(&self.grid, start, |spot| way.contains(&spot), |spot| spot == end).map(|(_, way)| way)
    }

    /// Returns the cheapest way to `goal`. It is empty if the robot stands there, and `None` if there is no way. If
    /// the goal is beyond the known cells, the way leads over their edge, as if everything beyond were free.
    pub(crate) fn way_to_cell(&mut self, start: Pose, goal: Cell, through: Through) -> Option<Vec<Move>> {
        way(&self.grid, &mut self.ways, self.costs, start, goal, through)
    }

    /// Returns the nearest cell for which `is_goal` holds, and the way there over free cells. Only steps count, so that
    /// a way across a large hall is found quickly.
    pub(crate) fn way_to_nearest(&mut self, start: Pose, is_goal: impl Fn(Cell) -> bool) -> Option<(Cell, Vec<Move>)> {
        let Planner { grid, ways, .. } = self;
        if !grid.has_room_for(start.cell) {
            return None;
        }
        let is_free = |spot: Spot| matches!(grid.here(spot), Square::Visited | Square::Seen);
        let (end, way) = ways.steps.way(grid, start, is_free, |spot| is_goal(grid.cell(spot)))?;
        Some((end.cell, way))
    }

    /// Returns the cheapest way to a pose, over unknown cells too. They are assumed to be free.
    pub(crate) fn way_to_look(&mut self, start: Pose, goal: Pose) -> Option<Vec<Move>> {
        let mut way = self.way_to_cell(start, goal.cell, Through::Unknown)?;
        let end = way.iter().fold(start, |pose, step| after(pose, *step));
        turn(&mut way, end.heading, goal.heading);
        (end.cell == goal.cell).then_some(way)
    }

    pub(crate) fn way_to_pose(&mut self, start: Pose, goal: Pose) -> Option<Vec<Move>> {
        let Planner { grid, ways, costs, .. } = self;
        if grid.at(goal.cell) != Square::Visited {
            return None;
        }
        let (at, mut is_found) = ((grid.spot(goal.cell), goal.heading), false);
        let all = ways.spread(grid, *costs, start, |here| {
            is_found |= (here.spot, here.heading) == at;
            if is_found { 0 } else { u32::MAX }
        });
        if is_found || all {
            return is_found.then(|| ways.way_to(grid, at));
        }
        let passable = |spot: Spot| grid.here(spot) == Square::Visited;
        let (end, mut way) = ways.steps.way(grid, start, passable, |spot| spot == at.0)?;
        turn(&mut way, end.heading, goal.heading);
        Some(way)
    }
}

impl Ways {
    /// Returns the cheapest way to a cell. Unknown cells are assumed to be free. If the cell is beyond the known
    /// cells, the way leads towards it.
    #[must_use]
    pub fn way_over_unknown(&mut self, grid: &Grid, costs: Costs, start: Pose, goal: Cell) -> Option<Vec<Move>> {
        way(grid, self, costs, start, goal, Through::Unknown)
    }
}

fn way(grid: &Grid, ways: &mut Ways, costs: Costs, start: Pose, goal: Cell, through: Through) -> Option<Vec<Move>> {
    if !grid.has_room_for(start.cell) {
        return None;
    }
    let area = grid.known().including(start.cell).grown(1);
    if !area.contains(goal) {
        return if through == Through::Unknown { towards(grid, ways, costs, start, goal, area) } else { None };
    }
    let target = grid.spot(goal);
    let passable = |spot: Spot| may_enter(grid, area, spot, through) || (spot == target && !grid.here(spot).is_settled());
    ways.way_to_cell(grid, costs, start, goal, passable)
}

/// Returns the way towards a goal outside `area`. The way leads to the cell of the edge from which the rest is
/// cheapest, if all cells outside are free.
fn towards(grid: &Grid, ways: &mut Ways, costs: Costs, start: Pose, goal: Cell, area: Bounds) -> Option<Vec<Move>> {
    let inner = area.grown(-1);
    let mut best: Option<(u32, (Spot, Heading))> = None;
    let all = ways.search(
        grid,
        costs,
        start,
        |_| 0,
        |spot| may_enter(grid, area, spot, Through::Unknown),
        |here| {
            let cell = grid.cell(here.spot);
            let whole = here.cost + (cell.x.abs_diff(goal.x) + cell.y.abs_diff(goal.y)) * STEP;
            if !inner.contains(cell) && best.is_none_or(|(least, _)| whole < least) {
                best = Some((whole, (here.spot, here.heading)));
            }
            u32::MAX
        },
    );
    if let Some((_, end)) = best {
        return Some(ways.way_to(grid, end));
    }
    if all {
        return None;
    }
    // The goal is too far away for a search over all pairs of cell and heading.
    let passable = |spot: Spot| may_enter(grid, area, spot, Through::Unknown);
    ways.steps.way(grid, start, passable, |spot| !inner.contains(grid.cell(spot))).map(|(_, way)| way)
}

fn may_enter(grid: &Grid, area: Bounds, spot: Spot, through: Through) -> bool {
    match grid.here(spot) {
        Square::Visited => true,
        Square::Unknown | Square::Seen => through == Through::Unknown && area.contains(grid.cell(spot)),
        Square::Obstacle | Square::Luggage | Square::Target | Square::KeptOut => false,
    }
}

/// Returns the pose after a move if nothing is in the way.
pub(crate) fn after(pose: Pose, step: Move) -> Pose {
    match step {
        Move::Forward => Pose { cell: pose.ahead(), ..pose },
        Move::Backward => Pose { cell: pose.cell.ahead(pose.heading.opposite()), ..pose },
        Move::TurnLeft => Pose { heading: pose.heading.left(), ..pose },
        Move::TurnRight => Pose { heading: pose.heading.right(), ..pose },
        Move::NudgeLeft | Move::NudgeRight => pose,
    }
}

/// Returns the cells that a way passes, without the start.
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
    use crate::units::{LuggageId, Revision};
    use crate::world::keep_out::Ring;

    /// Returns a map from a drawing: `.` is visited, `?` unknown, `#` wall, `b` a bag that is not inspected yet. The
    /// first cell is (0, 0).
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
        let way = Planner::of(&map(&["..", ".."])).way_to_cell(Pose::START, Cell::new(1, 1), Through::Known).unwrap();
        assert_eq!(way, [Move::Forward, Move::TurnLeft, Move::Forward]);
    }

    #[test]
    fn a_known_way_never_enters_the_unknown() {
        let map = map(&["...", "#?.", "..."]);
        let mut planner = Planner::of(&map);
        let known = planner.way_to_cell(Pose::START, Cell::new(0, 2), Through::Known).unwrap();
        let daring = planner.way_to_cell(Pose::START, Cell::new(0, 2), Through::Unknown).unwrap();
        assert!(known.len() > daring.len());
        assert!(cells_along(Pose::START, known).iter().all(|cell| map.at(*cell) == Mark::Visited));
    }

    #[test]
    fn a_bag_is_a_goal_but_never_a_way() {
        let map = map(&[".", "b", "."]);
        let mut planner = Planner::of(&map);
        assert_eq!(planner.way_to_cell(Pose::START, Cell::new(0, 1), Through::Known), Some(vec![Move::Forward]));
        assert_eq!(planner.way_to_cell(Pose::START, Cell::new(0, 2), Through::Known), None);
    }

    #[test]
    fn a_wall_is_not_a_goal() {
        let found = Planner::of(&map(&[".", "#"])).way_to_cell(Pose::START, Cell::new(0, 1), Through::Unknown);
        assert_eq!(found, None);
    }

    #[test]
    fn a_goal_far_beyond_the_known_is_approached_straight() {
        let way = Planner::of(&map(&["."])).way_to_cell(Pose::START, Cell::new(0, 8000), Through::Unknown).unwrap();
        assert_eq!(way, [Move::Forward]);
    }

    /// The known hall is too large for a search over all pairs of cell and heading.
    #[test]
    fn a_goal_beyond_a_large_known_hall_is_approached_too() {
        let row = ".".repeat(300);
        let rows: Vec<&str> = (0..300).map(|_| row.as_str()).collect();
        let way = Planner::of(&map(&rows)).way_to_cell(Pose::START, Cell::new(150, 8000), Through::Unknown).unwrap();
        assert!(ends_at(&way).cell != Cell::HOME, "{way:?}");
    }

    /// Checks that the guided search is as exact as the plain search.
    #[test]
    fn the_way_to_a_cell_is_the_shortest_there_is() {
        let mut dice = crate::rng::RandomStream::new(1, "planner");
        for _ in 0..200 {
            let rows: Vec<String> =
                (0..12).map(|_| (0..12).map(|_| if dice.below(4) == 0 { '#' } else { '.' }).collect()).collect();
            let mut map = map(&rows.iter().map(String::as_str).collect::<Vec<_>>());
            map.mark(Cell::HOME, Mark::Visited, Revision(3));
            let goal = Cell::new(i32::try_from(dice.below(12)).unwrap(), i32::try_from(dice.below(12)).unwrap());
            let mut planner = Planner::of(&map);
            let guided = planner.way_to_cell(Pose::START, goal, Through::Known).map(|way| way.len());
            let turned = Heading::ALL.map(|heading| planner.way_to_pose(Pose::START, Pose { cell: goal, heading }));
            let plain = turned.into_iter().flatten().map(|way| way.len()).min();
            assert_eq!(guided, plain, "to {goal}");
        }
    }

    #[test]
    fn a_pose_is_reached_with_its_heading() {
        let goal = Pose { cell: Cell::new(1, 0), heading: Heading::West };
        let way = Planner::of(&map(&["..", ".."])).way_to_pose(Pose::START, goal).unwrap();
        assert_eq!(ends_at(&way), goal);
    }

    /// A visited room of 5 × 3 cells, with a bomb in the middle of its north wall.
    fn room(radius: f64) -> (Planner, HallMap) {
        let map = map(&[".....", ".....", "....."]);
        let ring = Ring { luggage: LuggageId(1), bomb: vec![Cell::new(2, -1)] };
        let mut planner = Planner::of(&map);
        planner.set_keep_out(KeepOut::new(vec![ring], radius, 1.0), &map);
        (planner, map)
    }

    #[test]
    fn a_way_goes_round_a_ring_and_through_it_only_as_far_from_the_bomb_as_possible() {
        let east = Pose { cell: Cell::new(4, 0), ..Pose::START };
        let (mut planner, _) = room(1.0);
        let round = planner.way_to_cell(east, Cell::HOME, Through::Known).expect("a way leads round");
        assert!(!cells_along(east, round).contains(&Cell::new(2, 0)));
        let (mut planner, map) = room(3.0);
        assert_eq!(planner.way_to_cell(east, Cell::HOME, Through::Known), None, "the ring lies across the room");
        let through = planner.way_through_rings(&map, east, |cell| cell == Cell::HOME).expect("visited cells lead home");
        assert!(cells_along(east, through.clone()).contains(&Cell::new(2, 2)), "along the south wall: {through:?}");
        let (mut planner, _) = room(9.0);
        assert_eq!(planner.way_to_cell(east, Cell::HOME, Through::Unknown), None, "home is in the ring");
    }

    #[test]
    fn what_is_marked_later_inside_a_ring_stays_shut() {
        let (mut planner, mut map) = room(3.0);
        for cell in [Cell::new(2, 0), Cell::new(5, 0)] {
            map.mark(cell, Mark::Visited, Revision(2));
            planner.mark(cell, &map);
        }
        assert_eq!(
            [(2, 0), (4, -1), (5, 0)].map(|(x, y)| planner.grid.at(Cell::new(x, y))),
            [Square::KeptOut, Square::KeptOut, Square::Visited]
        );
    }
}
