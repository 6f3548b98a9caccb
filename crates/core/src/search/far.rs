//! Finds long ways. Only the number of steps counts, and turns cost nothing. In a hall of a million cells, such a way
//! is found in a few milliseconds. Among ways with equally many steps, a way that goes straight on is chosen.

use super::grid::{Grid, Spot, onward};
use crate::command::Move;
use crate::units::{Heading, Pose};

/// Searches for ways by steps. Its working memory is reused for the next search.
#[derive(Clone, Debug, Default)]
pub(crate) struct Steps {
    /// The state of each cell in this search, in one byte, so that a large hall fits into the processor's cache.
    marks: Vec<u8>,
    wave: Vec<Spot>,
    next: Vec<Spot>,
}

const UNTOUCHED: u8 = 0;

const SHUT: u8 = 1;

/// The marks of the waves. Successive waves get the marks from `FIRST` to `LAST`, then `FIRST` again. Three marks are
/// enough, because neighbours are at most one wave apart.
const FIRST: u8 = 2;
const LAST: u8 = 4;

impl Steps {
    pub(super) fn way(
        &mut self,
        grid: &Grid,
        start: Pose,
        passable: impl Fn(Spot) -> bool,
        mut wanted: impl FnMut(Spot) -> bool,
    ) -> Option<(Pose, Vec<Move>)> {
        let end = self.flood(grid, grid.spot(start.cell), passable, |spot, _| wanted(spot))?;
        Some(self.trace(grid, start, end))
    }

    /// Visits the cells in waves: all cells at distance 1, then 2, … The first wanted cell that is reached is
    /// therefore one of the nearest. `wanted` also gets the distance.
    pub(super) fn flood(
        &mut self,
        grid: &Grid,
        from: Spot,
        passable: impl Fn(Spot) -> bool,
        mut wanted: impl FnMut(Spot, u32) -> bool,
    ) -> Option<Spot> {
        self.marks.clear();
        self.marks.resize(grid.size(), UNTOUCHED);
        let (mut mark, mut distance) = (FIRST, 0);
        self.marks[from] = mark;
        self.wave.clear();
        self.wave.push(from);
        let around = Heading::ALL.map(|heading| grid.step(heading));
        while !self.wave.is_empty() {
            if let Some(end) = self.wave.iter().copied().find(|spot| wanted(*spot, distance)) {
                return Some(end);
            }
            mark = if mark == LAST { FIRST } else { mark + 1 };
            distance += 1;
            self.next.clear();
            for spot in &self.wave {
                for step in around {
                    let to = onward(*spot, step);
                    if self.marks[to] != UNTOUCHED {
                        continue;
                    }
                    if passable(to) {
                        self.marks[to] = mark;
                        self.next.push(to);
                    } else {
                        self.marks[to] = SHUT;
                    }
                }
            }
            std::mem::swap(&mut self.wave, &mut self.next);
        }
        None
    }

    /// Traces the way back from its end. It goes straight on where this needs no more steps.
    pub(super) fn trace(&self, grid: &Grid, start: Pose, end: Spot) -> (Pose, Vec<Move>) {
        let (from, mut spot) = (grid.spot(start.cell), end);
        let mut headings: Vec<Heading> = Vec::new();
        while spot != from {
            let before = if self.marks[spot] == FIRST { LAST } else { self.marks[spot] - 1 };
            let comes_from = |heading: &Heading| self.marks[onward(spot, grid.step(heading.opposite()))] == before;
            let straight = headings.last().copied().filter(comes_from);
            let heading =
                straight.or_else(|| Heading::ALL.into_iter().find(comes_from)).expect("each wave is reached from the one before");
            headings.push(heading);
            spot = onward(spot, grid.step(heading.opposite()));
        }
        let mut moves = Vec::new();
        let mut facing = start.heading;
        for heading in headings.into_iter().rev() {
            turn(&mut moves, facing, heading);
            moves.push(Move::Forward);
            facing = heading;
        }
        (Pose { cell: grid.cell(end), heading: facing }, moves)
    }
}

pub(super) fn turn(moves: &mut Vec<Move>, from: Heading, to: Heading) {
    if to == from.left() {
        moves.push(Move::TurnLeft);
    } else if to == from.right() {
        moves.push(Move::TurnRight);
    } else if to != from {
        moves.extend([Move::TurnLeft, Move::TurnLeft]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::costs::Costs;
    use crate::search::grid::Square;
    use crate::search::plan::after;
    use crate::search::ways::Ways;
    use crate::units::Cell;
    use crate::world::hall_map::Bounds;

    /// Checks that a way by steps has as few steps as the exact way, and leads to the right cell.
    #[test]
    fn a_far_way_takes_as_few_steps_as_there_are() {
        let mut dice = crate::rng::RandomStream::new(3, "far");
        for _ in 0..100 {
            let mut grid = Grid::with_room_for(Bounds { least: Cell::HOME, most: Cell::new(15, 15) });
            for n in 0..256 {
                let is_free = n == 0 || dice.below(4) > 0;
                grid.set(Cell::new(n % 16, n / 16), if is_free { Square::Visited } else { Square::Obstacle });
            }
            let goal = Cell::new(i32::try_from(dice.below(16)).unwrap(), i32::try_from(dice.below(16)).unwrap());
            let passable = |spot| grid.here(spot) == Square::Visited;
            let far = Steps::default().way(&grid, Pose::START, passable, |spot| spot == grid.spot(goal));
            let costs = Costs { turn: 0, bump: 0 };
            let exact = Ways::default().way_over_visited(&grid, costs, Pose::START, goal);
            let steps = |moves: &[Move]| moves.iter().filter(|step| **step == Move::Forward).count();
            assert_eq!(far.as_ref().map(|(_, moves)| steps(moves)), exact.as_ref().map(|moves| steps(moves)), "to {goal}");
            if let Some((pose, moves)) = far {
                assert_eq!(moves.iter().fold(Pose::START, |pose, step| after(pose, *step)), pose);
                assert_eq!(pose.cell, goal);
            }
        }
    }
}
