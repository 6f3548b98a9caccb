//! Square tiles of the map in shared memory. A snapshot copies no tile, and a change copies only the tiles that it
//! touches. `hall_map` defines the meaning of the marks.
//!
//! ```text
//!   a block of 8 × 8 tiles, a tile of 32 × 32 cells; a map of a thousand cells a side has sixteen blocks
//!   ┌─────┬─────┐        ┌────┬────┬─
//!   │ Arc ┼─ ─ ─┼──────► │ Arc│    │    None = nothing known there
//!   ├─────┼─────┤        ├────┼────┼─
//!   │     │ Arc │        │ Arc│ Arc│    each tile knows the revision of its last change
//!   └─────┴─────┘        └────┴────┴─
//! ```

use std::sync::Arc;

use super::mark::Mark;
use crate::units::{Bounds, Cell, Revision};

/// Side of a tile, in cells.
pub const TILE: i32 = 32;

/// Side of a block, in tiles.
const BLOCK: i32 = 8;

#[derive(Clone, Debug)]
pub struct Tile {
    pub revision: Revision,
    marks: [Mark; (TILE * TILE) as usize],
    /// The frontier cells of each row, one bit per cell.
    frontier: [u32; TILE as usize],
    open: u16,
    /// Number of known cells. A tile without known cells lies just beyond the known area. It is stored for its
    /// frontier.
    known: u16,
}

#[derive(Clone, Debug)]
pub(super) struct Tiles {
    /// The extent of the grid, in blocks. The blocks are stored row by row.
    grid: Bounds,
    blocks: Vec<Option<Arc<Block>>>,
}

type Block = [Option<Arc<Tile>>; (BLOCK * BLOCK) as usize];

const NOTHING: Option<Arc<Tile>> = None;

impl Tile {
    const EMPTY: Tile = Tile {
        revision: Revision(0),
        marks: [Mark::Unknown; (TILE * TILE) as usize],
        frontier: [0; TILE as usize],
        open: 0,
        known: 0,
    };

    pub(super) const fn at(&self, place: usize) -> Mark {
        self.marks[place]
    }

    pub(super) fn set(&mut self, place: usize, mark: Mark) {
        self.known += u16::from(mark != Mark::Unknown);
        self.known -= u16::from(self.marks[place] != Mark::Unknown);
        self.marks[place] = mark;
    }

    pub(super) const fn is_known(&self) -> bool {
        self.known > 0
    }

    pub(super) const fn is_open(&self, place: usize) -> bool {
        self.frontier[place / TILE as usize] >> (place % TILE as usize) & 1 == 1
    }

    pub(super) fn turn_open(&mut self, place: usize) {
        self.open = if self.is_open(place) { self.open - 1 } else { self.open + 1 };
        self.frontier[place / TILE as usize] ^= 1 << (place % TILE as usize);
    }

    /// Returns the frontier cells of this tile, row by row. `corner` is the tile's north-west corner.
    pub(super) fn frontier(&self, corner: Cell) -> impl Iterator<Item = Cell> {
        let rows = (0..).zip(self.frontier).filter(move |_| self.open > 0);
        rows.flat_map(move |(y, row)| {
            (0..TILE).filter(move |x| row >> x & 1 == 1).map(move |x| Cell::new(corner.x + x, corner.y + y))
        })
    }
}

impl Tiles {
    pub(super) fn around(cell: Cell) -> Tiles {
        Tiles { grid: Bounds::of(block_of(tile_of(cell))), blocks: vec![None] }
    }

    pub(super) fn at(&self, cell: Cell) -> Mark {
        self.tile(tile_of(cell)).map_or(Mark::Unknown, |tile| tile.marks[place_in_tile(cell)])
    }

    /// Returns the tile at `place`. Coordinates are in tiles, not in cells.
    pub(super) fn tile(&self, place: Cell) -> Option<&Arc<Tile>> {
        self.blocks.get(self.index(block_of(place))?)?.as_ref()?[place_in_block(place)].as_ref()
    }

    pub(super) fn tile_mut(&mut self, cell: Cell) -> &mut Tile {
        let place = tile_of(cell);
        let block = block_of(place);
        if self.index(block).is_none() {
            self.grow_to(block);
        }
        let index = self.index(block).expect("the grid has just been grown to hold this block");
        let block = self.blocks[index].get_or_insert_with(|| Arc::new([NOTHING; (BLOCK * BLOCK) as usize]));
        let tile = Arc::make_mut(block)[place_in_block(place)].get_or_insert_with(|| Arc::new(Tile::EMPTY));
        Arc::make_mut(tile)
    }

    /// All stored tiles, each with the cell of its north-west corner.
    pub(super) fn iter(&self) -> impl Iterator<Item = (Cell, &Arc<Tile>)> {
        self.blocks().flat_map(|(at, block)| tiles_of(at, block))
    }

    pub(super) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Tile> {
        let blocks = self.blocks.iter_mut().flatten();
        blocks.flat_map(|block| Arc::make_mut(block).iter_mut().flatten().map(Arc::make_mut))
    }

    /// Returns the tiles that do not share their memory with `older`. Blocks that both share are skipped.
    pub(super) fn changed<'a>(&'a self, older: &'a Tiles) -> impl Iterator<Item = (Cell, &'a Arc<Tile>)> {
        let is_shared = |at: Cell, block: &Arc<Block>| older.block(at).is_some_and(|old| Arc::ptr_eq(old, block));
        let blocks = self.blocks().filter(move |(at, block)| !is_shared(*at, block));
        let tiles = blocks.flat_map(|(at, block)| tiles_of(at, block));
        tiles.filter(|(corner, tile)| older.tile(tile_of(*corner)).is_none_or(|old| !Arc::ptr_eq(old, tile)))
    }

    fn block(&self, at: Cell) -> Option<&Arc<Block>> {
        self.blocks.get(self.index(at)?)?.as_ref()
    }

    fn blocks(&self) -> impl Iterator<Item = (Cell, &Arc<Block>)> {
        let (least, columns) = (self.grid.least, self.grid.width());
        (0..).zip(&self.blocks).filter_map(move |(index, block)| {
            block.as_ref().map(|block| (Cell::new(least.x + index % columns, least.y + index / columns), block))
        })
    }

    fn index(&self, block: Cell) -> Option<usize> {
        let (column, row) = (block.x - self.grid.least.x, block.y - self.grid.least.y);
        self.grid.contains(block).then(|| usize::try_from(row * self.grid.width() + column).ok())?
    }

    fn grow_to(&mut self, block: Cell) {
        let old = self.clone();
        self.grid = old.grid.including(block);
        let count = usize::try_from(self.grid.width() * self.grid.height()).expect("a grid of blocks has a positive size");
        self.blocks = vec![None; count];
        for (at, block) in old.blocks() {
            let index = self.index(at).expect("the grown grid holds what the old one held");
            self.blocks[index] = Some(Arc::clone(block));
        }
    }
}

fn tiles_of(at: Cell, block: &Arc<Block>) -> impl Iterator<Item = (Cell, &Arc<Tile>)> {
    (0..).zip(block.iter()).filter_map(move |(place, tile)| {
        let corner = Cell::new((at.x * BLOCK + place % BLOCK) * TILE, (at.y * BLOCK + place / BLOCK) * TILE);
        tile.as_ref().map(|tile| (corner, tile))
    })
}

/// Returns the tile that contains the cell. The result is in tiles, not in cells.
pub(super) const fn tile_of(cell: Cell) -> Cell {
    Cell::new(cell.x.div_euclid(TILE), cell.y.div_euclid(TILE))
}

const fn block_of(tile: Cell) -> Cell {
    Cell::new(tile.x.div_euclid(BLOCK), tile.y.div_euclid(BLOCK))
}

/// The index of a cell in its tile, row by row.
pub(super) const fn place_in_tile(cell: Cell) -> usize {
    (cell.y.rem_euclid(TILE) * TILE + cell.x.rem_euclid(TILE)) as usize
}

const fn place_in_block(tile: Cell) -> usize {
    (tile.y.rem_euclid(BLOCK) * BLOCK + tile.x.rem_euclid(BLOCK)) as usize
}

/// The cells of the tile whose north-west corner is `corner`.
pub fn cells_of(corner: Cell) -> impl Iterator<Item = Cell> {
    (0..TILE * TILE).map(move |n| Cell::new(corner.x + n % TILE, corner.y + n / TILE))
}
