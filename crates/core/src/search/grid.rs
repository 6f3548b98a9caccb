//! The occupancy grid that a search reads: one byte per cell in one block of memory. There is spare memory on every
//! side, so the neighbours of a cell can be read without checks. The map that the interfaces show is in
//! `crate::world::hall_map`. The grid and that map get the same marks.

use super::census::Census;
use crate::units::{Cell, Heading};
use crate::world::hall_map::{Bounds, HallMap, Mark, is_in_reach};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Square {
    Unknown = 0,
    /// The cell was seen to be free, but not visited yet.
    Seen = 1,
    Visited = 2,
    /// A wall, or anything else that is not luggage.
    Obstacle = 3,
    Target = 4,
    Luggage = 5,
    /// Inside a keep-out ring, whatever the map shows there.
    KeptOut = 6,
}

impl Square {
    pub(crate) const fn is_open(self) -> bool {
        matches!(self, Square::Unknown | Square::Seen | Square::Target)
    }

    /// Whether nothing can be found out by entering the cell.
    #[must_use]
    pub const fn is_settled(self) -> bool {
        matches!(self, Square::Obstacle | Square::Luggage | Square::KeptOut)
    }
}

/// Minimum distance of a cell from the edge of the memory. The cells round a cell at this distance can be read
/// without a check of the bounds.
pub(crate) const RIM: i32 = 8;

/// Number of spare cells on every side of the known cells in a new grid.
const SPARE: i32 = 32;

pub(crate) type Spot = usize;

#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    open: usize,
    /// Cells that are blocked by something other than luggage.
    obstacles: u32,
    census: Census,
}

#[derive(Clone, Debug)]
pub struct Grid {
    squares: Vec<Square>,
    room: Bounds,
    known: Bounds,
    counts: Counts,
    /// The distance in memory of one step to the north, east, south and west.
    steps: [isize; 4],
}

impl Grid {
    #[must_use]
    pub fn with_room_for(bounds: Bounds) -> Grid {
        let room = bounds.grown(RIM + 1);
        let size = usize::try_from(i64::from(room.width()) * i64::from(room.height())).expect("a room has a positive size");
        let width = isize::try_from(room.width()).expect("a room is narrower than a memory");
        let mut grid = Grid {
            squares: vec![Square::Unknown; size],
            room,
            known: Bounds::of(Cell::HOME),
            counts: Counts::default(),
            steps: [-width, 1, width, -1],
        };
        if !is_in_reach(room.least) || !is_in_reach(room.most) {
            // Cells beyond the reach are never stored. If they counted as unknown, a search would never end.
            for spot in 0..size {
                if !is_in_reach(grid.cell(spot)) {
                    grid.squares[spot] = Square::Obstacle;
                }
            }
        }
        grid
    }

    #[must_use]
    pub fn of(map: &HallMap) -> Grid {
        let mut grid = Grid::with_room_for(map.known_bounds().grown(SPARE));
        for (cell, mark) in map.known() {
            grid.mark(cell, mark);
        }
        grid
    }

    pub fn mark(&mut self, cell: Cell, mark: Mark) {
        let square = match mark {
            Mark::Unknown => Square::Unknown,
            Mark::Seen => Square::Seen,
            Mark::Visited => Square::Visited,
            Mark::Wall => Square::Obstacle,
            Mark::Luggage => Square::Luggage,
            Mark::NotInspected => Square::Target,
        };
        self.set(cell, square);
    }

    /// Shuts a cell inside a ring. The cell does not count as known.
    pub(crate) fn keep_out_of(&mut self, cell: Cell) {
        let known = self.known;
        self.set(cell, Square::KeptOut);
        self.known = known;
    }

    pub fn set(&mut self, cell: Cell, square: Square) {
        if self.at(cell) == square || !is_in_reach(cell) {
            return;
        }
        self.make_room(cell);
        let spot = self.spot(cell);
        let before = self.counts_round(spot);
        self.squares[spot] = square;
        let after = self.counts_round(spot);
        self.counts = Counts {
            open: self.counts.open - before.open + after.open,
            obstacles: self.counts.obstacles - before.obstacles + after.obstacles,
            census: self.counts.census.less(before.census).and(after.census),
        };
        self.known = self.known.including(cell);
    }

    pub(crate) const fn has_open(&self) -> bool {
        self.counts.open > 0
    }

    pub(crate) const fn obstacles(&self) -> u32 {
        self.counts.obstacles
    }

    pub const fn census(&self) -> Census {
        self.counts.census
    }

    /// Returns what a cell and its neighbours contribute to the counts.
    fn counts_round(&self, spot: Spot) -> Counts {
        let around = |spot: Spot| self.steps.into_iter().map(move |step| onward(spot, step));
        let is_at_edge =
            |spot: Spot| self.squares[spot].is_open() && around(spot).any(|next| self.squares[next] == Square::Visited);
        Counts {
            open: around(spot).chain([spot]).filter(|spot| is_at_edge(*spot)).count(),
            obstacles: u32::from(self.squares[spot] == Square::Obstacle),
            census: self.census_round(spot),
        }
    }

    /// Returns what a cell and the eight cells round it contribute to the census.
    fn census_round(&self, spot: Spot) -> Census {
        let down = self.steps[2];
        let around = |spot: Spot| {
            [-down - 1, -down, -down + 1, -1, 1, down - 1, down, down + 1].into_iter().map(move |by| onward(spot, by))
        };
        let mut census = Census::default();
        for spot in around(spot).chain([spot]) {
            let is_along = || around(spot).any(|next| self.squares[next] == Square::Obstacle);
            match self.squares[spot] {
                Square::Visited if is_along() => census.visited_along += 1,
                Square::Luggage if is_along() => census.luggage_along += 1,
                Square::Visited => census.visited_inside += 1,
                Square::Luggage => census.luggage_inside += 1,
                Square::Unknown | Square::Seen | Square::Obstacle | Square::Target | Square::KeptOut => {}
            }
        }
        census
    }

    /// Returns the smallest rectangle that contains home and every cell that was ever known.
    pub(crate) const fn known(&self) -> Bounds {
        self.known
    }

    /// Whether there is memory for a cell. A damaged journal may put the robot anywhere.
    pub(crate) fn has_room_for(&self, cell: Cell) -> bool {
        self.room.contains(cell)
    }

    #[must_use]
    pub fn at(&self, cell: Cell) -> Square {
        if self.has_room_for(cell) { self.squares[self.spot(cell)] } else { Square::Unknown }
    }

    /// Doubles the memory on every side whose edge is too near to the cell.
    pub(crate) fn make_room(&mut self, cell: Cell) {
        if self.room.grown(-RIM).contains(cell) {
            return;
        }
        let (room, more) = (self.room, self.room.width().max(self.room.height()));
        let mut wider = room.grown(-RIM - 1).including(cell);
        if wider.least.x < room.least.x + RIM {
            wider.least.x -= more;
        }
        if wider.least.y < room.least.y + RIM {
            wider.least.y -= more;
        }
        if wider.most.x > room.most.x - RIM {
            wider.most.x += more;
        }
        if wider.most.y > room.most.y - RIM {
            wider.most.y += more;
        }
        let mut larger = Grid::with_room_for(wider);
        let width = usize::try_from(room.width()).expect("a room has a positive width");
        for (y, row) in (room.least.y..).zip(self.squares.chunks(width)) {
            let to = larger.spot(Cell::new(room.least.x, y));
            larger.squares[to..to + width].copy_from_slice(row);
        }
        (larger.known, larger.counts) = (self.known, self.counts);
        *self = larger;
    }

    /// Number of cells for which there is memory.
    pub(crate) const fn size(&self) -> usize {
        self.squares.len()
    }

    pub(crate) fn spot(&self, cell: Cell) -> Spot {
        let (column, row) = (i64::from(cell.x - self.room.least.x), i64::from(cell.y - self.room.least.y));
        usize::try_from(row * i64::from(self.room.width()) + column).expect("a cell inside the room has a place")
    }

    pub(crate) fn cell(&self, spot: Spot) -> Cell {
        let width = usize::try_from(self.room.width()).expect("a room has a positive width");
        let number = |n: usize| i32::try_from(n).expect("a room is smaller than the reach of a robot");
        Cell::new(self.room.least.x + number(spot % width), self.room.least.y + number(spot / width))
    }

    pub(crate) fn here(&self, spot: Spot) -> Square {
        self.squares[spot]
    }

    /// Returns the distance in memory to the next cell in this direction.
    pub(crate) const fn step(&self, heading: Heading) -> isize {
        self.steps[heading as usize]
    }
}

pub(crate) const fn onward(spot: Spot, by: isize) -> Spot {
    spot.wrapping_add_signed(by)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::RandomStream;

    /// Counts that are updated with each mark must equal a fresh count, even if the memory has grown meanwhile.
    #[test]
    fn the_counts_follow_every_mark() {
        const SQUARES: [Square; 6] =
            [Square::Visited, Square::Obstacle, Square::Luggage, Square::Target, Square::Unknown, Square::Seen];
        let mut dice = RandomStream::new(1, "census");
        let mut grid = Grid::with_room_for(Bounds::of(Cell::HOME));
        let side = 60;
        let mut place = || i32::try_from(dice.below(side)).expect("a small number") - 30;
        for n in 0..20_000 {
            grid.set(Cell::new(place(), place()), SQUARES[n % 6]);
        }
        let cells = (-31..=30).flat_map(|y| (-31..=30).map(move |x| Cell::new(x, y)));
        let mut counted = Census::default();
        let (mut open, mut obstacles) = (0, 0);
        for cell in cells {
            let is_reached = cell.neighbours().into_iter().any(|next| grid.at(next) == Square::Visited);
            open += usize::from(grid.at(cell).is_open() && is_reached);
            obstacles += u32::from(grid.at(cell) == Square::Obstacle);
            let round = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| Cell::new(cell.x + dx, cell.y + dy)));
            let is_along = round.filter(|next| *next != cell).any(|next| grid.at(next) == Square::Obstacle);
            counted = counted.and(match (grid.at(cell), is_along) {
                (Square::Visited, true) => Census { visited_along: 1, ..Census::default() },
                (Square::Visited, false) => Census { visited_inside: 1, ..Census::default() },
                (Square::Luggage, true) => Census { luggage_along: 1, ..Census::default() },
                (Square::Luggage, false) => Census { luggage_inside: 1, ..Census::default() },
                _ => Census::default(),
            });
        }
        assert_eq!((grid.counts.open, grid.obstacles()), (open, obstacles));
        assert_eq!(grid.census(), counted);
        assert!(counted.luggage_inside > 0 && counted.visited_along > 0, "{counted:?}");
    }
}
