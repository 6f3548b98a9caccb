//! The known part of the hall: a mark for every cell, and the frontier, where the known cells end. `tiles` stores the
//! marks in memory that snapshots share. `hallsweep::api` encodes a map for clients.

use std::ops::RangeInclusive;
use std::sync::Arc;

pub use super::mark::Mark;
pub use super::tiles::{TILE, Tile, cells_of};
use super::tiles::{Tiles, place_in_tile, tile_of};
pub use crate::units::Bounds;
use crate::units::{Cell, Revision};

/// Maximum absolute value of a stored cell's coordinate. A robot that reports a larger value is wrong.
pub const REACH: i32 = 8192;

pub(crate) const fn is_in_reach(cell: Cell) -> bool {
    // `i32::MIN` has no `abs`.
    cell.x.unsigned_abs() <= REACH.unsigned_abs() && cell.y.unsigned_abs() <= REACH.unsigned_abs()
}

#[derive(Clone, Debug)]
pub struct HallMap {
    tiles: Tiles,
    visited: usize,
    uninspected: usize,
    /// Number of cells of the frontier.
    open: usize,
    visited_bounds: Bounds,
    known_bounds: Bounds,
}

impl HallMap {
    /// Creates a map on which only `home` is known, because the robot stands there.
    #[must_use]
    pub fn new(home: Cell, revision: Revision) -> HallMap {
        let mut map = HallMap {
            tiles: Tiles::around(home),
            visited: 0,
            uninspected: 0,
            open: 0,
            visited_bounds: Bounds::of(home),
            known_bounds: Bounds::of(home),
        };
        map.mark(home, Mark::Visited, revision);
        map
    }

    #[must_use]
    pub fn at(&self, cell: Cell) -> Mark {
        self.tiles.at(cell)
    }

    pub(crate) fn is_news(&self, cell: Cell, mark: Mark) -> bool {
        self.at(cell) != mark && is_in_reach(cell)
    }

    /// Writes a mark. Returns true if the map has changed. Cells beyond `REACH` are not stored.
    pub fn mark(&mut self, cell: Cell, mark: Mark, revision: Revision) -> bool {
        if !self.is_news(cell, mark) {
            return false;
        }
        let before = self.at(cell);
        let tile = self.tiles.tile_mut(cell);
        tile.revision = revision;
        tile.set(place_in_tile(cell), mark);
        self.known_bounds = self.known_bounds.including(cell);
        if mark == Mark::Visited {
            self.visited += 1;
            self.visited_bounds = self.visited_bounds.including(cell);
        } else if before == Mark::Visited {
            self.visited -= 1;
        }
        self.uninspected += usize::from(mark == Mark::NotInspected);
        self.uninspected -= usize::from(before == Mark::NotInspected);
        self.move_frontier(cell, revision);
        if mark == Mark::Visited || before == Mark::Visited {
            cell.neighbours().into_iter().for_each(|next| self.move_frontier(next, revision));
        }
        true
    }

    /// Sets the revision of every tile to `revision`, because no client has seen this map before.
    pub(crate) fn show_first_at(&mut self, revision: Revision) {
        self.tiles.iter_mut().for_each(|tile| tile.revision = revision);
    }

    /// Returns the unvisited cells next to visited ones, tile by tile.
    pub fn frontier(&self) -> impl Iterator<Item = Cell> {
        self.tiles.iter().flat_map(|(corner, tile)| tile.frontier(corner))
    }

    #[must_use]
    pub const fn frontier_size(&self) -> usize {
        self.open
    }

    #[must_use]
    pub const fn visited(&self) -> usize {
        self.visited
    }

    #[must_use]
    pub const fn uninspected(&self) -> usize {
        self.uninspected
    }

    /// Number of known places that are not searched yet: unvisited cells beside visited ones, and obstacles that were
    /// not inspected.
    #[must_use]
    pub const fn unsearched(&self) -> usize {
        self.open + self.uninspected
    }

    /// The smallest rectangle that contains every cell that was ever visited.
    #[must_use]
    pub const fn visited_bounds(&self) -> Bounds {
        self.visited_bounds
    }

    /// The smallest rectangle that contains every cell of which anything was ever known.
    #[must_use]
    pub const fn known_bounds(&self) -> Bounds {
        self.known_bounds
    }

    /// Returns the tiles that contain known cells, each with the cell of its north-west corner.
    pub fn tiles(&self) -> impl Iterator<Item = (Cell, &Arc<Tile>)> {
        self.tiles.iter().filter(|(_, tile)| tile.is_known())
    }

    /// Whether the tile with the north-west corner `corner` contains known cells.
    #[must_use]
    pub fn has_tile(&self, corner: Cell) -> bool {
        self.tiles.tile(tile_of(corner)).is_some_and(|tile| tile.is_known())
    }

    /// The tiles that may have changed since `older`, an earlier state of this map.
    pub fn tiles_changed_since<'a>(&'a self, older: &'a HallMap) -> impl Iterator<Item = (Cell, &'a Arc<Tile>)> {
        self.tiles.changed(&older.tiles).filter(|(_, tile)| tile.is_known())
    }

    /// Returns the known cells of a part of a row. Tiles of which nothing is known are skipped.
    pub(crate) fn known_in(&self, y: i32, columns: RangeInclusive<i32>) -> impl Iterator<Item = (Cell, Mark)> {
        let (first, last) = columns.into_inner();
        let tiles = (first.div_euclid(TILE)..=last.div_euclid(TILE)).filter_map(move |n| {
            let tile = self.tiles.tile(Cell::new(n, y.div_euclid(TILE)))?;
            Some((first.max(n * TILE)..=last.min(n * TILE + TILE - 1), tile))
        });
        let marked = tiles.flat_map(move |(columns, tile)| {
            columns.map(move |x| Cell::new(x, y)).map(move |cell| (cell, tile.at(place_in_tile(cell))))
        });
        marked.filter(|(_, mark)| *mark != Mark::Unknown)
    }

    pub fn known(&self) -> impl Iterator<Item = (Cell, Mark)> {
        let marked = self.tiles().flat_map(|(corner, tile)| cells_of(corner).map(|cell| (cell, tile.at(place_in_tile(cell)))));
        marked.filter(|(_, mark)| *mark != Mark::Unknown)
    }

    /// Returns the cells whose mark differs from the mark in `older`, with their marks in this map. Tiles that both
    /// maps share are skipped.
    #[must_use]
    pub fn changes_since(&self, older: &HallMap) -> Vec<(Cell, Mark)> {
        let mut changes = Vec::new();
        for (corner, _) in self.tiles_changed_since(older) {
            changes.extend(cells_of(corner).map(|cell| (cell, self.at(cell))).filter(|(cell, mark)| older.at(*cell) != *mark));
        }
        for (corner, _) in older.tiles_changed_since(self).filter(|(corner, _)| !self.has_tile(*corner)) {
            changes.extend(cells_of(corner).filter(|cell| older.at(*cell) != Mark::Unknown).map(|cell| (cell, Mark::Unknown)));
        }
        changes
    }

    fn move_frontier(&mut self, cell: Cell, revision: Revision) {
        let is_open = self.at(cell).is_unvisited() && cell.neighbours().into_iter().any(|next| self.at(next) == Mark::Visited);
        let was_open = self.tiles.tile(tile_of(cell)).is_some_and(|tile| tile.is_open(place_in_tile(cell)));
        if is_open != was_open {
            self.open = if is_open { self.open + 1 } else { self.open - 1 };
            let tile = self.tiles.tile_mut(cell);
            tile.turn_open(place_in_tile(cell));
            tile.revision = tile.revision.max(revision);
        }
    }
}

/// Two maps are equal if every cell has the same mark in both. Revisions do not matter.
impl PartialEq for HallMap {
    fn eq(&self, other: &HallMap) -> bool {
        self.changes_since(other).is_empty()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn a_new_map_knows_home_and_asks_for_its_neighbours() {
        let map = HallMap::new(Cell::HOME, Revision(1));
        assert_eq!(map.at(Cell::HOME), Mark::Visited);
        assert_eq!(map.frontier().collect::<BTreeSet<_>>(), Cell::HOME.neighbours().into());
        assert_eq!(map.frontier_size(), 4);
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
            assert_eq!((map.at(cell), map.frontier().any(|open| open == cell)), (Mark::Unknown, asked));
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
