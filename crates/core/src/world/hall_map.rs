//! The hall as far as it is known: a mark for every cell, in shared tiles, and the frontier where the known ends.
//! How a map is written on a wire is `hallsweep::api`'s business.
//!
//! ```text
//!   tiles of 32 × 32 cells in a grid that grows; a snapshot shares them, a change copies the tile it touches and the frontier
//!   ┌────┬────┬────┐
//!   │ Arc│    │ Arc│   None = nothing known there
//!   ├────┼────┼────┤
//!   │ Arc│ Arc│    │   each tile knows the revision of its last change
//!   └────┴────┴────┘
//! ```

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::units::{Cell, Revision};

/// The side of a tile in cells.
pub const TILE: i32 = 32;

/// No cell further from home than this, in either direction, is kept: a robot that reports more is wrong.
pub const REACH: i32 = 8192;

named! {
    by name;
    /// What is known of a cell.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Mark {
        /// Nothing.
        #[default]
        Unknown = "unknown",
        /// Its sonar has seen that it is free; the robot was not there yet.
        Seen = "seen",
        /// The robot was there: it is free.
        Visited = "visited",
        /// A wall.
        Wall = "wall",
        /// An inspected piece of luggage, or an obstacle that could not be told from one.
        Luggage = "luggage",
        /// An obstacle that still has to be inspected.
        NotInspected = "notInspected",
    }
}

impl Mark {
    /// Whether the robot is still to go there, and nothing is known to stand in its way.
    #[must_use]
    pub const fn is_unvisited(self) -> bool {
        matches!(self, Mark::Unknown | Mark::Seen)
    }

    /// Whether the robot cannot go there.
    #[must_use]
    pub const fn is_obstacle(self) -> bool {
        matches!(self, Mark::Wall | Mark::Luggage | Mark::NotInspected)
    }
}

/// A rectangle of cells, borders included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// The north-west corner.
    pub least: Cell,
    /// The south-east corner.
    pub most: Cell,
}

impl Bounds {
    /// The rectangle of one cell.
    #[must_use]
    pub const fn of(cell: Cell) -> Bounds {
        Bounds { least: cell, most: cell }
    }

    /// The least rectangle that also holds `cell`.
    pub(crate) fn including(self, cell: Cell) -> Bounds {
        Bounds {
            least: Cell::new(self.least.x.min(cell.x), self.least.y.min(cell.y)),
            most: Cell::new(self.most.x.max(cell.x), self.most.y.max(cell.y)),
        }
    }

    /// Larger by so many cells on every side.
    #[must_use]
    pub const fn grown(self, by: i32) -> Bounds {
        Bounds { least: Cell::new(self.least.x - by, self.least.y - by), most: Cell::new(self.most.x + by, self.most.y + by) }
    }

    /// Whether it holds `cell`.
    #[must_use]
    pub const fn contains(self, cell: Cell) -> bool {
        cell.x >= self.least.x && cell.y >= self.least.y && cell.x <= self.most.x && cell.y <= self.most.y
    }

    /// Columns.
    #[must_use]
    pub const fn width(self) -> i32 {
        self.most.x - self.least.x + 1
    }

    /// Rows.
    #[must_use]
    pub const fn height(self) -> i32 {
        self.most.y - self.least.y + 1
    }
}

/// A square of cells and when it last changed.
#[derive(Clone, Debug)]
pub struct Tile {
    /// The revision of its last change.
    pub revision: Revision,
    marks: [Mark; (TILE * TILE) as usize],
}

/// Everything known of the hall.
#[derive(Clone, Debug)]
pub struct HallMap {
    /// Where there is room for tiles, in tiles; they lie row by row.
    grid: Bounds,
    tiles: Vec<Option<Arc<Tile>>>,
    visited: usize,
    uninspected: usize,
    visited_bounds: Bounds,
    known_bounds: Bounds,
    frontier: Arc<BTreeSet<Cell>>,
}

impl HallMap {
    /// A map on which only `home` is known, because the robot stands there.
    #[must_use]
    pub fn new(home: Cell, revision: Revision) -> HallMap {
        let mut map = HallMap {
            grid: Bounds::of(tile_of(home)),
            tiles: vec![None],
            visited: 0,
            uninspected: 0,
            visited_bounds: Bounds::of(home),
            known_bounds: Bounds::of(home),
            frontier: Arc::default(),
        };
        map.mark(home, Mark::Visited, revision);
        map
    }

    /// What is known of `cell`.
    #[must_use]
    pub fn at(&self, cell: Cell) -> Mark {
        self.tile(tile_of(cell)).map_or(Mark::Unknown, |tile| tile.marks[place_in_tile(cell)])
    }

    /// Whether this mark would change anything.
    pub(crate) fn is_news(&self, cell: Cell, mark: Mark) -> bool {
        self.at(cell) != mark && cell.x.abs() <= REACH && cell.y.abs() <= REACH
    }

    /// Writes a mark; true when it changed anything. Cells beyond `REACH` are not kept.
    pub fn mark(&mut self, cell: Cell, mark: Mark, revision: Revision) -> bool {
        if !self.is_news(cell, mark) {
            return false;
        }
        let before = self.at(cell);
        let tile = self.tile_mut(tile_of(cell));
        tile.revision = revision;
        tile.marks[place_in_tile(cell)] = mark;
        self.known_bounds = self.known_bounds.including(cell);
        if mark == Mark::Visited {
            self.visited += 1;
            self.visited_bounds = self.visited_bounds.including(cell);
        } else if before == Mark::Visited {
            self.visited -= 1;
        }
        self.uninspected += usize::from(mark == Mark::NotInspected);
        self.uninspected -= usize::from(before == Mark::NotInspected);
        self.move_frontier(cell, mark);
        true
    }

    /// Nobody has seen this map before this revision: all of it counts as changed then.
    pub(crate) fn show_first_at(&mut self, revision: Revision) {
        for tile in self.tiles.iter_mut().flatten() {
            Arc::make_mut(tile).revision = revision;
        }
    }

    /// The unvisited cells next to visited ones, by column and row.
    #[must_use]
    pub fn frontier(&self) -> &BTreeSet<Cell> {
        &self.frontier
    }

    /// How many cells the robot has visited.
    #[must_use]
    pub const fn visited(&self) -> usize {
        self.visited
    }

    /// How many obstacles are still to be inspected.
    #[must_use]
    pub const fn uninspected(&self) -> usize {
        self.uninspected
    }

    /// The least rectangle that holds every visited cell.
    #[must_use]
    pub const fn visited_bounds(&self) -> Bounds {
        self.visited_bounds
    }

    /// The least rectangle that holds every cell of which anything is known.
    #[must_use]
    pub const fn known_bounds(&self) -> Bounds {
        self.known_bounds
    }

    /// The tiles that hold anything, with the cell of their north-west corner.
    pub fn tiles(&self) -> impl Iterator<Item = (Cell, &Arc<Tile>)> {
        self.tiles.iter().enumerate().filter_map(|(index, tile)| {
            let (index, Bounds { least, .. }, columns) = (i32::try_from(index).ok()?, self.grid, self.grid.width());
            let corner = Cell::new((least.x + index % columns) * TILE, (least.y + index / columns) * TILE);
            tile.as_ref().map(|tile| (corner, tile))
        })
    }

    /// Every cell of which anything is known, with its mark.
    pub fn known(&self) -> impl Iterator<Item = (Cell, Mark)> {
        let marked = self.tiles().flat_map(|(corner, tile)| cells_of(corner).map(|cell| (cell, tile.marks[place_in_tile(cell)])));
        marked.filter(|(_, mark)| *mark != Mark::Unknown)
    }

    /// The cells whose mark differs from `older`'s, with their marks here. Tiles that are shared are not looked into.
    #[must_use]
    pub fn changes_since(&self, older: &HallMap) -> Vec<(Cell, Mark)> {
        let mut changes = Vec::new();
        for (corner, tile) in self.tiles() {
            if older.tile(tile_of(corner)).is_some_and(|old| Arc::ptr_eq(old, tile)) {
                continue;
            }
            changes.extend(cells_of(corner).map(|cell| (cell, self.at(cell))).filter(|(cell, mark)| older.at(*cell) != *mark));
        }
        for (corner, _) in older.tiles().filter(|(corner, _)| self.tile(tile_of(*corner)).is_none()) {
            changes.extend(cells_of(corner).filter(|cell| older.at(*cell) != Mark::Unknown).map(|cell| (cell, Mark::Unknown)));
        }
        changes
    }

    fn tile(&self, place: Cell) -> Option<&Arc<Tile>> {
        self.tiles.get(self.index(place)?)?.as_ref()
    }

    fn index(&self, place: Cell) -> Option<usize> {
        let (column, row) = (place.x - self.grid.least.x, place.y - self.grid.least.y);
        self.grid.contains(place).then(|| usize::try_from(row * self.grid.width() + column).ok())?
    }

    fn tile_mut(&mut self, place: Cell) -> &mut Tile {
        if self.index(place).is_none() {
            self.grow_to(place);
        }
        let index = self.index(place).expect("the grid has just been grown to hold this place");
        let tile = self.tiles[index]
            .get_or_insert_with(|| Arc::new(Tile { revision: Revision(0), marks: [Mark::Unknown; (TILE * TILE) as usize] }));
        Arc::make_mut(tile)
    }

    fn grow_to(&mut self, place: Cell) {
        let old = self.clone();
        self.grid = old.grid.including(place);
        let count = usize::try_from(self.grid.width() * self.grid.height()).expect("a grid of tiles has a positive size");
        self.tiles = vec![None; count];
        for (corner, tile) in old.tiles() {
            let index = self.index(tile_of(corner)).expect("the grown grid holds what the old one held");
            self.tiles[index] = Some(Arc::clone(tile));
        }
    }

    fn move_frontier(&mut self, cell: Cell, mark: Mark) {
        let fresh: Vec<Cell> = match mark {
            Mark::Visited => cell.neighbours().into_iter().filter(|next| self.at(*next).is_unvisited()).collect(),
            Mark::Unknown | Mark::Seen => Some(cell).filter(|_| self.has_visited_neighbour(cell)).into_iter().collect(),
            Mark::Wall | Mark::Luggage | Mark::NotInspected => Vec::new(),
        };
        let frontier = Arc::make_mut(&mut self.frontier);
        frontier.remove(&cell);
        frontier.extend(fresh);
    }

    fn has_visited_neighbour(&self, cell: Cell) -> bool {
        cell.neighbours().into_iter().any(|next| self.at(next) == Mark::Visited)
    }
}

/// Two maps are equal when the same is known of every cell, whenever it became known.
impl PartialEq for HallMap {
    fn eq(&self, other: &HallMap) -> bool {
        self.changes_since(other).is_empty()
    }
}

fn tile_of(cell: Cell) -> Cell {
    Cell::new(cell.x.div_euclid(TILE), cell.y.div_euclid(TILE))
}

fn place_in_tile(cell: Cell) -> usize {
    let place = cell.y.rem_euclid(TILE) * TILE + cell.x.rem_euclid(TILE);
    usize::try_from(place).expect("a Euclidean remainder is not negative")
}

/// The cells of the tile whose north-west corner is `corner`.
pub fn cells_of(corner: Cell) -> impl Iterator<Item = Cell> {
    (0..TILE * TILE).map(move |n| Cell::new(corner.x + n % TILE, corner.y + n / TILE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_map_knows_home_and_asks_for_its_neighbours() {
        let map = HallMap::new(Cell::HOME, Revision(1));
        assert_eq!(map.at(Cell::HOME), Mark::Visited);
        assert_eq!(map.frontier().iter().copied().collect::<BTreeSet<_>>(), Cell::HOME.neighbours().into());
    }

    #[test]
    fn the_grid_grows_in_every_direction_and_forgets_nothing() {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        for cell in [Cell::new(-40, 3), Cell::new(100, -70), Cell::new(5, 200)] {
            assert!(map.mark(cell, Mark::Wall, Revision(2)));
        }
        assert_eq!(map.at(Cell::HOME), Mark::Visited);
        assert_eq!(map.at(Cell::new(-40, 3)), Mark::Wall);
        assert_eq!(map.at(Cell::new(100, -70)), Mark::Wall);
        assert_eq!(map.known_bounds(), Bounds { least: Cell::new(-40, -70), most: Cell::new(100, 200) });
    }

    #[test]
    fn a_cell_that_is_unknown_again_is_asked_for_where_a_robot_was_beside_it() {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        for (cell, asked) in [(Cell::new(1, 0), true), (Cell::new(2, 0), false)] {
            map.mark(cell, Mark::Luggage, Revision(2));
            map.mark(cell, Mark::Unknown, Revision(3));
            assert_eq!((map.at(cell), map.frontier().contains(&cell)), (Mark::Unknown, asked));
        }
    }

    #[test]
    fn what_is_out_of_reach_is_not_kept() {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        assert!(!map.mark(Cell::new(REACH + 1, 0), Mark::Wall, Revision(2)));
    }

    #[test]
    fn a_change_copies_only_its_own_tile_and_is_found_again() {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        map.mark(Cell::new(40, 0), Mark::Wall, Revision(2));
        let older = map.clone();
        map.mark(Cell::new(0, 1), Mark::Visited, Revision(3));
        assert_eq!(map.changes_since(&older), vec![(Cell::new(0, 1), Mark::Visited)]);
        assert_eq!(older.at(Cell::new(0, 1)), Mark::Unknown);
    }

    #[test]
    fn an_emptied_map_reports_what_was_forgotten() {
        let mut older = HallMap::new(Cell::HOME, Revision(1));
        older.mark(Cell::new(40, 0), Mark::Wall, Revision(2));
        let map = HallMap::new(Cell::HOME, Revision(3));
        assert_eq!(map.changes_since(&older), vec![(Cell::new(40, 0), Mark::Unknown)]);
    }
}
