//! The hall map as the text of old clients (mission §6): a line per row, `|r, 1, X, `, or all in one line, `'r 1 X @1 1 X @'`.
//! It begins at the least row and column that hold a visited cell; the borders north and west of them are implied.

use super::map::mark_char;
use crate::core::units::Cell;
use crate::core::world::hall_map::{Bounds, Mark};
use crate::core::world::snapshot::Snapshot;

/// A line per row, each cell followed by `, `.
#[must_use]
pub fn lines(snapshot: &Snapshot) -> String {
    written(snapshot, "|", ", ", "\n")
}

/// All rows in one quoted line, each cell followed by a blank, each row by `@`.
#[must_use]
pub fn one_line(snapshot: &Snapshot) -> String {
    format!("'{}'", written(snapshot, "", " ", "@"))
}

fn written(snapshot: &Snapshot, open: &str, after_cell: &str, after_row: &str) -> String {
    let shown = shown(snapshot);
    let mut text = String::new();
    for y in shown.least.y..=shown.most.y {
        text.push_str(open);
        for x in shown.least.x..=shown.most.x {
            text.push(text_char(snapshot, Cell::new(x, y)));
            text.push_str(after_cell);
        }
        text.push_str(after_row);
    }
    text
}

/// The visited rectangle, and the east and south borders where anything of them is known.
fn shown(snapshot: &Snapshot) -> Bounds {
    let visited = snapshot.map.visited_bounds();
    let most = Cell::new(visited.most.x + 1, visited.most.y + 1);
    let known = |cell| snapshot.map.at(cell) != Mark::Unknown;
    let east = (visited.least.y..=most.y).any(|y| known(Cell::new(most.x, y)));
    let south = (visited.least.x..=most.x).any(|x| known(Cell::new(x, most.y)));
    let most = Cell::new(if east { most.x } else { visited.most.x }, if south { most.y } else { visited.most.y });
    Bounds { least: visited.least, most }
}

/// As `mark_char`, but for the corner where the east and the south border meet: no sensor can see it, and two walls that end
/// at it say that it is one.
fn text_char(snapshot: &Snapshot, cell: Cell) -> char {
    let visited = snapshot.map.visited_bounds();
    let is_corner = cell == Cell::new(visited.most.x + 1, visited.most.y + 1);
    let wall = |x, y| snapshot.map.at(Cell::new(x, y)) == Mark::Wall;
    if is_corner && wall(cell.x - 1, cell.y) && wall(cell.x, cell.y - 1) { 'X' } else { mark_char(snapshot, cell) }
}
