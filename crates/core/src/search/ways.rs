//! Finds ways from the robot's place, the cheapest first. A state is a cell with a heading, because turns cost as
//! well as steps. The strategy decides where to go. The mission decides whether the robot may move.
//!
//! Waiting states are sorted by cost in a ring of buckets, which is as long as the most expensive move. Costs are
//! whole numbers, so adding and taking a state need constant time. With an estimate of the remaining cost, the same
//! loop is A*. A state is settled when it is taken out for the first time. When a search has settled more than `MOST`
//! states, the goal is searched for by steps alone (`far`). That is several times faster, but not exact.

use super::costs::{Costs, STEP};
use super::far::Steps;
use super::grid::{Grid, Spot, Square, onward};
use crate::command::Move;
use crate::units::{Cell, Heading, Pose};

/// Finds ways. Its working memory is reused for the next search.
#[derive(Clone, Debug, Default)]
pub struct Ways {
    /// For each state, the number of the search that settled it. With this number, nothing needs to be cleared
    /// between searches.
    settled: Vec<u32>,
    came_by: Vec<u8>,
    search: u32,
    ring: Vec<Vec<u64>>,
    pub(super) steps: Steps,
}

/// Number of states that a search may settle before its goal counts as far away. Settling them takes about a
/// millisecond.
const MOST: usize = 1 << 16;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Reached {
    pub(crate) spot: Spot,
    pub(crate) heading: Heading,
    /// The cost of the way to this state, in the units of `Costs`.
    pub(crate) cost: u32,
    /// The last move; `None` for the state where the robot stands.
    pub(crate) by: Option<Move>,
}

const MOVES: [Move; 3] = [Move::Forward, Move::TurnLeft, Move::TurnRight];

/// No move led to this state, because the robot stands there.
const NONE: u8 = 3;

impl Ways {
    /// Visits the states that can be reached over visited cells, the cheapest first. It ends when they cost more than
    /// the limit that `reached` returns. Returns false if there were more than `MOST` states.
    pub(crate) fn spread(&mut self, grid: &Grid, costs: Costs, start: Pose, reached: impl FnMut(Reached) -> u32) -> bool {
        self.search(grid, costs, start, |_| 0, |spot| grid.here(spot) == Square::Visited, reached)
    }

    /// Returns the cheapest way to a cell over `passable` cells. The search is guided by the lowest possible number
    /// of remaining steps.
    pub(crate) fn way_to_cell(
        &mut self,
        grid: &Grid,
        costs: Costs,
        start: Pose,
        goal: Cell,
        passable: impl Fn(Spot) -> bool,
    ) -> Option<Vec<Move>> {
        let (at, mut end) = (grid.spot(goal), None);
        let left = |spot: Spot| {
            let cell = grid.cell(spot);
            (cell.x.abs_diff(goal.x) + cell.y.abs_diff(goal.y)) * STEP
        };
        let all = self.search(grid, costs, start, left, &passable, |here| {
            end = end.or((here.spot == at).then_some((here.spot, here.heading)));
            if end.is_some() { 0 } else { u32::MAX }
        });
        match end {
            Some(end) => Some(self.way_to(grid, end)),
            None if all => None,
            None => self.steps.way(grid, start, passable, |spot| spot == at).map(|(_, moves)| moves),
        }
    }

    #[must_use]
    pub fn way_over_visited(&mut self, grid: &Grid, costs: Costs, start: Pose, goal: Cell) -> Option<Vec<Move>> {
        self.way_to_cell(grid, costs, start, goal, |spot| grid.here(spot) == Square::Visited)
    }

    /// Visits states in the order of their total cost. `left` is a lower bound of the cost from a state to the goal.
    /// A move decreases `left` by at most the cost of the move. Returns false if there were more than `MOST` states.
    pub(crate) fn search(
        &mut self,
        grid: &Grid,
        costs: Costs,
        start: Pose,
        left: impl Fn(Spot) -> u32,
        passable: impl Fn(Spot) -> bool,
        mut reached: impl FnMut(Reached) -> u32,
    ) -> bool {
        if !grid.has_room_for(start.cell) {
            return true;
        }
        self.prepare(grid, costs);
        let price = [STEP, costs.turn, costs.turn];
        let length = self.ring.len();
        let from = grid.spot(start.cell);
        // Total costs: the cost so far plus the lower bound of the remaining cost.
        let (mut whole, mut worth) = (left(from), u32::MAX);
        self.ring[whole as usize % length].push(pack(from, start.heading, NONE));
        let (mut waiting, mut settled) = (1usize, 0);
        while waiting > 0 && whole <= worth && settled < MOST {
            let Some(packed) = self.ring[whole as usize % length].pop() else {
                whole += 1;
                continue;
            };
            waiting -= 1;
            let (spot, heading, by) = unpack(packed);
            let state = spot * 4 + heading as usize;
            if self.settled[state] == self.search {
                continue;
            }
            (self.settled[state], self.came_by[state]) = (self.search, by);
            settled += 1;
            let cost = whole - left(spot);
            worth = reached(Reached { spot, heading, cost, by: MOVES.get(usize::from(by)).copied() });
            let ahead = onward(spot, grid.step(heading));
            let next = [(ahead, heading), (spot, heading.left()), (spot, heading.right())];
            for (by, (spot, heading)) in (0u8..).zip(next).skip(usize::from(!passable(ahead))) {
                if self.settled[spot * 4 + heading as usize] != self.search {
                    let whole = cost + price[usize::from(by)] + left(spot);
                    self.ring[whole as usize % length].push(pack(spot, heading, by));
                    waiting += 1;
                }
            }
        }
        self.ring.iter_mut().for_each(Vec::clear);
        settled < MOST
    }

    fn prepare(&mut self, grid: &Grid, costs: Costs) {
        let states = grid.size() * 4;
        if self.settled.len() != states || self.search == u32::MAX {
            (self.settled, self.came_by, self.search) = (vec![0; states], vec![0; states], 0);
        }
        self.search += 1;
        // A step away from the goal raises the total cost by the cost of two steps.
        self.ring.resize_with((2 * STEP).max(costs.turn) as usize + 1, Vec::new);
    }

    /// Returns the moves that led to a state. The last search must have settled this state.
    #[must_use]
    pub fn way_to(&self, grid: &Grid, end: (usize, Heading)) -> Vec<Move> {
        let (mut spot, mut heading) = end;
        let mut moves = Vec::new();
        while let Some(step) = MOVES.get(usize::from(self.came_by[spot * 4 + heading as usize])) {
            moves.push(*step);
            match step {
                Move::TurnLeft => heading = heading.right(),
                Move::TurnRight => heading = heading.left(),
                Move::Forward | Move::Backward | Move::NudgeLeft | Move::NudgeRight => {
                    spot = onward(spot, grid.step(heading.opposite()));
                }
            }
        }
        moves.reverse();
        moves
    }
}

/// Packs a state into one number. The two lowest bits are the move that leads to the state, the next two bits are the
/// heading, and all higher bits are the spot.
const fn pack(spot: Spot, heading: Heading, by: u8) -> u64 {
    ((spot as u64) << 4) | ((heading as u64) << 2) | by as u64
}

const fn unpack(packed: u64) -> (Spot, Heading, u8) {
    let heading = Heading::ALL[(packed >> 2 & 3) as usize];
    ((packed >> 4) as usize, heading, (packed & 3) as u8)
}
