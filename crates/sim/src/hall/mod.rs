//! A simulated hall: the truth about every cell, its luggage, and its temperature over time. `files` finds hall files
//! by their formats. `export` writes hall files. Each format is read and written in a file of its own: `toml`,
//! `movingai`, `seed_text`, and `occupancy` with `pixels` and `pgm`. `scene` makes halls from the scene files of the
//! virtual robot's page.
//!
//! In files, columns are counted from the west and rows from the north of the drawing. Everything here is in map
//! coordinates, in which the robot's start is (0, 0).

mod error;
mod exercise;
mod export;
mod files;
mod movingai;
mod occupancy;
mod pgm;
mod pixel;
mod pixels;
mod rows;
mod scene;
mod seed_text;
mod toml;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

pub use error::{HallError, HallFault};
pub use export::{Export, Format, WrittenHall};
pub use scene::{Floor, HallOfScene, MovingObstacle, PLAYER, Player, Scene, SceneSonar, StaticObstacle};

use crate::bag::Bag;
use crate::curve::Curve;
use hallsweep_core::state::Reach;
use hallsweep_core::units::{Cell, Piece};
use hallsweep_core::world::areas::Area;
use hallsweep_core::world::hall_map::Bounds;

/// Maximum number of columns or rows of a hall. With cells of half a metre, this is about a kilometre. The squares of
/// the largest hall take about 34 MB of memory.
pub(super) const MAX_SIDE: usize = 2048;

/// Maximum number of pieces of luggage. It bounds the memory, and no benchmark map has more.
pub const MAX_PIECES: usize = 262_144;

/// The side of a cell in metres, if the file does not set it.
pub(super) const USUAL_CELL_M: f64 = 0.5;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    Free,
    /// A wall, a pillar, or outside the hall.
    Wall,
    Luggage(Piece),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Hall {
    name: Arc<str>,
    description: Option<Arc<str>>,
    cell_m: f64,
    bounds: Bounds,
    squares: Vec<Truth>,
    bags: Vec<Bag>,
    temperature: Option<Curve>,
    /// In map coordinates. None overlaps another one or leaves the hall.
    areas: Arc<[Area]>,
    is_exercise: bool,
}

/// The content of a hall file's cells. Name, cell size, temperature and areas are not included.
#[derive(Debug)]
pub(super) struct Plan {
    /// The rectangle of the hall in map coordinates.
    pub(super) bounds: Bounds,
    /// The squares, row by row from the north. Each row starts in the west.
    pub(super) squares: Vec<Truth>,
    pub(super) bags: Vec<Bag>,
}

impl Hall {
    /// A hall with cells of `USUAL_CELL_M` and no thermometer.
    pub(super) fn of(name: &str, plan: Plan) -> Hall {
        let Plan { bounds, squares, bags } = plan;
        // The name is printed on terminals. Control characters would change what the terminal shows.
        let name: String = name.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect();
        Hall {
            name: name.into(),
            description: None,
            cell_m: USUAL_CELL_M,
            bounds,
            squares,
            bags,
            temperature: None,
            areas: Arc::default(),
            is_exercise: false,
        }
    }

    pub(super) fn measured(self, cell_m: f64, temperature: Option<Curve>) -> Hall {
        Hall { cell_m, temperature, ..self }
    }

    pub(super) fn described(self, description: Option<&str>) -> Hall {
        Hall { description: description.map(Arc::from), ..self }
    }

    #[must_use]
    pub fn called(self, name: &str) -> Hall {
        Hall { name: name.into(), ..self }
    }

    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    #[must_use]
    pub const fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// The named areas, in the order of the hall file.
    #[must_use]
    pub const fn areas(&self) -> &Arc<[Area]> {
        &self.areas
    }

    #[must_use]
    pub const fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The content of a cell. Every cell outside the hall's rectangle is a wall.
    #[must_use]
    pub fn truth(&self, cell: Cell) -> Truth {
        self.place(cell).and_then(|place| self.squares.get(place)).copied().unwrap_or(Truth::Wall)
    }

    fn place(&self, cell: Cell) -> Option<usize> {
        let place = || (cell.y - self.bounds.least.y) * self.bounds.width() + (cell.x - self.bounds.least.x);
        self.bounds.contains(cell).then(|| usize::try_from(place()).ok())?
    }

    /// All pieces, sorted by their numbers.
    #[must_use]
    pub fn pieces(&self) -> &[Bag] {
        &self.bags
    }

    pub(crate) fn bag(&self, piece: Piece) -> Option<&Bag> {
        let index = usize::try_from(piece.0.checked_sub(1)?).ok()?;
        self.bags.get(index)
    }

    /// Whether this piece is dangerous. False if there is no such piece.
    #[must_use]
    pub fn is_dangerous(&self, piece: Piece) -> bool {
        self.bag(piece).is_some_and(|bag| bag.dangerous)
    }

    /// Returns the hall after some luggage was moved. A moved piece lies in one cell, however many cells it had
    /// before. With `None` the piece is removed.
    #[must_use]
    pub fn rearranged(&self, moved: &BTreeMap<Piece, Option<Cell>>) -> Hall {
        let mut hall = self.clone();
        for square in &mut hall.squares {
            if matches!(square, Truth::Luggage(piece) if moved.contains_key(piece)) {
                *square = Truth::Free;
            }
        }
        for (piece, cell) in moved {
            if let Some(place) = cell.and_then(|cell| self.place(cell)) {
                hall.squares[place] = Truth::Luggage(*piece);
            }
            if let Some(bag) = hall.bags.iter_mut().find(|bag| bag.piece == *piece) {
                bag.cells = cell.iter().copied().collect();
            }
        }
        hall
    }

    /// Returns the hall with additional walls in those of the given cells that are free. The robot does not know of
    /// such a wall before it meets or sees the wall.
    #[must_use]
    pub fn blocked(&self, cells: &BTreeSet<Cell>) -> Hall {
        let mut hall = self.clone();
        for place in cells.iter().filter_map(|cell| self.place(*cell)) {
            if hall.squares[place] == Truth::Free {
                hall.squares[place] = Truth::Wall;
            }
        }
        hall
    }

    /// Moves the robot's start to this column and row, counted from 0 in the north-west corner.
    ///
    /// # Errors
    /// When the cell there is not free.
    pub fn starting_at(mut self, (column, row): (u32, u32)) -> Result<Hall, HallFault> {
        let whole = |number: u32| i32::try_from(number).ok().filter(|number| *number < 1 << 16);
        let start = whole(column).zip(whole(row)).map(|(x, y)| Cell::new(x, y).relative_to(self.home()));
        let Some(start) = start.filter(|start| self.truth(*start) == Truth::Free) else {
            let (columns, rows) = (self.bounds.width(), self.bounds.height());
            return Err(HallFault::StartNotFree { column, row, columns, rows });
        };
        self.bounds = Bounds { least: self.bounds.least.relative_to(start), most: self.bounds.most.relative_to(start) };
        for cell in self.bags.iter_mut().flat_map(|bag| &mut bag.cells) {
            *cell = cell.relative_to(start);
        }
        self.areas = relative_to(start, &self.areas);
        Ok(self)
    }

    #[must_use]
    pub fn reach(&self) -> Reach {
        let count = |places: usize| u32::try_from(places).unwrap_or(u32::MAX);
        let free = self.squares.iter().filter(|truth| **truth == Truth::Free).count();
        Reach { reachable: count(self.reached().len()), free: count(free) }
    }

    /// Pieces that share no cell side with a reachable cell.
    #[must_use]
    pub fn unreachable_pieces(&self) -> Vec<&Bag> {
        let reached = self.reachable();
        let is_met = |bag: &&Bag| bag.cells.iter().any(|cell| cell.neighbours().iter().any(|beside| reached.contains(beside)));
        self.bags.iter().filter(|bag| !is_met(bag)).collect()
    }

    #[must_use]
    pub fn unreachable_cells(&self) -> Vec<Cell> {
        let reached = self.reachable();
        let Bounds { least, most } = self.bounds;
        let all = (least.y..=most.y).flat_map(|y| (least.x..=most.x).map(move |x| Cell::new(x, y)));
        all.filter(|cell| self.truth(*cell) == Truth::Free && !reached.contains(cell)).collect()
    }

    /// Every cell that the robot can reach from its start. Each step goes to a free cell that shares a side with the
    /// cell before.
    #[must_use]
    pub fn reachable(&self) -> BTreeSet<Cell> {
        let width = self.rows().next().map_or(1, <[Truth]>::len);
        self.reached().into_iter().map(|place| rows::drawn(place % width, place / width).relative_to(self.home())).collect()
    }

    /// Indices into `squares` of the reachable cells.
    fn reached(&self) -> Vec<usize> {
        let width = self.rows().next().map_or(1, <[Truth]>::len);
        let home = self.place(Cell::HOME).unwrap_or(0);
        rows::part(&self.squares, width, home, &mut vec![false; self.squares.len()])
    }

    /// The column and row of the robot's start in the drawing, counted from 0 in the north-west corner.
    pub(super) const fn home(&self) -> Cell {
        Cell::new(-self.bounds.least.x, -self.bounds.least.y)
    }

    /// The rows from north to south. Each row starts in the west.
    pub(super) fn rows(&self) -> impl Iterator<Item = &[Truth]> {
        self.squares.chunks(usize::try_from(self.bounds.width()).unwrap_or(1))
    }

    pub(super) const fn curve(&self) -> Option<&Curve> {
        self.temperature.as_ref()
    }
}

fn relative_to(origin: Cell, areas: &[Area]) -> Arc<[Area]> {
    let moved = |area: &Area| area.corners.iter().map(|corner| corner.relative_to(origin)).collect();
    areas.iter().map(|area| Area { corners: moved(area), ..area.clone() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hall() -> Hall {
        Hall::from_rows("test", &["#..#", ".Sa#", "..a."]).expect("a valid drawing")
    }

    #[test]
    fn cells_are_counted_from_the_start() {
        let hall = hall();
        assert_eq!(hall.bounds(), Bounds { least: Cell::new(-1, -1), most: Cell::new(2, 1) });
        assert_eq!(hall.truth(Cell::new(-1, -1)), Truth::Wall);
        assert_eq!(hall.truth(Cell::HOME), Truth::Free);
        assert_eq!(hall.truth(Cell::new(1, 0)), Truth::Luggage(Piece(1)));
    }

    #[test]
    fn a_piece_that_was_moved_lies_in_one_cell_and_one_that_is_gone_nowhere() {
        let moved = hall().rearranged(&BTreeMap::from([(Piece(1), Some(Cell::new(-1, 0)))]));
        assert_eq!((moved.truth(Cell::new(1, 0)), moved.truth(Cell::new(1, 1))), (Truth::Free, Truth::Free));
        assert_eq!(moved.truth(Cell::new(-1, 0)), Truth::Luggage(Piece(1)));
        let gone = moved.rearranged(&BTreeMap::from([(Piece(1), None)]));
        assert_eq!(gone.truth(Cell::new(-1, 0)), Truth::Free);
        assert!(gone.pieces()[0].cells.is_empty() && gone.bounds() == hall().bounds());
        assert_eq!(hall().rearranged(&BTreeMap::new()), hall());
    }

    #[test]
    fn outside_everything_is_wall() {
        let hall = hall();
        for cell in [Cell::new(-2, 0), Cell::new(0, 2), Cell::new(i32::MAX, i32::MIN)] {
            assert_eq!(hall.truth(cell), Truth::Wall);
        }
    }

    #[test]
    fn a_pocket_behind_walls_and_luggage_is_not_reachable() {
        let reachable = hall().reachable();
        assert!(reachable.contains(&Cell::new(1, -1)));
        assert!(!reachable.contains(&Cell::new(2, 1)), "the cell behind the bag");
    }

    #[test]
    fn what_cannot_be_reached_is_named_and_a_blocked_cell_is_in_the_way() {
        let hall = hall();
        assert_eq!(hall.unreachable_cells(), vec![Cell::new(2, 1)]);
        assert!(hall.unreachable_pieces().is_empty());
        let blocked = hall.blocked(&BTreeSet::from([Cell::new(0, -1), Cell::new(1, 0), Cell::new(99, 99)]));
        assert_eq!(blocked.truth(Cell::new(0, -1)), Truth::Wall);
        assert_eq!(blocked.truth(Cell::new(1, 0)), Truth::Luggage(Piece(1)), "luggage stays what it is");
        assert!(blocked.unreachable_cells().contains(&Cell::new(1, -1)));
        let walled = Hall::from_rows("test", &["S#a"]).expect("a valid drawing");
        assert_eq!(walled.unreachable_pieces().len(), 1);
    }

    #[test]
    fn one_letter_is_one_piece_over_several_cells() {
        let hall = hall();
        assert_eq!(hall.pieces().len(), 1);
        assert_eq!(hall.pieces()[0].cells, vec![Cell::new(1, 0), Cell::new(1, 1)]);
        assert!(!hall.is_dangerous(Piece(1)) && !hall.is_dangerous(Piece(0)) && !hall.is_dangerous(Piece(9)));
    }
}

#[cfg(test)]
mod shared_maps_tests;
#[cfg(test)]
mod start_tests;
