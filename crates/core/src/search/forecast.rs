//! Estimates how much of a search is left, as a range. It uses the unknown part of the hall inside the known
//! walls, and the pace so far. The bounds of the range come from random halls.
//! `hallsweep-evaluation evaluate --time-left` measures how often they are right in other halls.

use super::grid::{Grid, Square};
use crate::command::Strategy;
use crate::units::{Bounds, Cell};

/// A range of the remaining effort, in the unit of `a_cell` (the effort per cell).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Lower bound. The real effort is rarely smaller; `hallsweep-evaluation evaluate --time-left` measures how
    /// often.
    pub least: f64,
    /// Upper bound. The real effort is rarely larger. `None` until the ends of the hall are known on all sides.
    pub most: Option<f64>,
}

/// Minimum number of cells from which a pace is calculated.
pub const FEW: u32 = 8;

/// Minimum known share of wall on a side of the hall. From this share on, the side counts as an end of the hall.
const ENDS: f64 = 0.25;

/// Factor for the lower bound while the hall may extend further. It multiplies the effort for the unknown cells at
/// the pace so far.
const OPEN: f64 = 0.65;

/// Factors for a hall whose ends are known. Each row has the known share up to which it applies, the factor of the
/// lower bound, and the factor of the upper bound.
const CLOSED: [(f64, f64, f64); 5] =
    [(0.25, 0.65, 1.6), (0.5, 0.7, 1.75), (0.75, 0.6, 2.2), (0.9, 0.5, 2.5), (f64::INFINITY, 0.55, 5.0)];

pub(super) struct Extent {
    /// The known area without those of its first and last lines that have a wall.
    pub(super) inside: Bounds,
    /// Number of cells inside the walls.
    cells: u32,
    known: u32,
    /// Whether the ends of the hall are known on all sides.
    pub(super) is_closed: bool,
}

/// Returns the remaining effort of a robot at `from`. `a_cell` is the effort per cell. `left_out` is the number of
/// unknown cells that are not searched. Returns `None` if the robot can reach nothing that is still unsearched. The
/// robot then goes home.
#[must_use]
pub fn forecast(grid: &Grid, strategy: Strategy, from: Cell, a_cell: f64, left_out: usize) -> Option<Forecast> {
    if !grid.has_open() {
        return None;
    }
    let extent = Extent::of(grid);
    let way_home = f64::from(from.x.abs() + from.y.abs());
    let left_out = u32::try_from(left_out).unwrap_or(u32::MAX);
    let at_this_pace = a_cell * (f64::from((extent.cells - extent.known).saturating_sub(left_out)) + way_home);
    // In a larger hall, the snail goes home more often.
    if !extent.is_closed || strategy == Strategy::Snail {
        return Some(Forecast { least: OPEN * at_this_pace, most: None });
    }
    let share = f64::from(extent.known) / f64::from(extent.cells);
    let (_, least, most) = CLOSED.into_iter().find(|(up_to, ..)| share <= *up_to).expect("the last range has no upper end");
    Some(Forecast { least: least * at_this_pace, most: Some(most * at_this_pace) })
}

struct Span {
    /// Number of known wall cells in the first and in the last line of the known area.
    walls: [u32; 2],
    inside: u32,
}

impl Span {
    fn of(grid: &Grid, first: impl Iterator<Item = Cell>, last: impl Iterator<Item = Cell>, size: i32) -> Span {
        let is_wall = |cell: &Cell| grid.at(*cell) == Square::Obstacle;
        let count = |walls: usize| u32::try_from(walls).unwrap_or(u32::MAX);
        let walls = [count(first.filter(is_wall).count()), count(last.filter(is_wall).count())];
        let ends = walls.into_iter().filter(|walls| *walls > 0).count();
        Span { walls, inside: size.unsigned_abs().saturating_sub(count(ends)).max(1) }
    }

    /// Whether the first and the last line both have at least the share `ENDS` of known wall cells. A line has
    /// `length` cells.
    fn ends(&self, length: u32) -> bool {
        self.walls.into_iter().all(|walls| f64::from(walls) >= ENDS * f64::from(length))
    }
}

impl Extent {
    pub(super) fn of(grid: &Grid) -> Extent {
        let known = grid.known();
        let row = |y: i32| (known.least.x..=known.most.x).map(move |x| Cell::new(x, y));
        let column = |x: i32| (known.least.y + 1..known.most.y).map(move |y| Cell::new(x, y));
        let width = Span::of(grid, column(known.least.x), column(known.most.x), known.width());
        let height = Span::of(grid, row(known.least.y), row(known.most.y), known.height());
        let cells = width.inside * height.inside;
        let inner_walls = grid.obstacles().saturating_sub(width.walls.into_iter().chain(height.walls).sum());
        let [west, east] = width.walls.map(|walls| i32::from(walls > 0));
        let [north, south] = height.walls.map(|walls| i32::from(walls > 0));
        let least = Cell::new(known.least.x + west, known.least.y + north);
        let inside = Bounds { least, most: Cell::new(known.most.x - east, known.most.y - south) };
        let known = (grid.census().looked_at() + inner_walls).min(cells);
        Extent { inside, cells, known, is_closed: width.ends(height.inside) && height.ends(width.inside) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a grid from a drawing: `.` is visited, `#` wall, `T` luggage, and a space unknown. Home is in the
    /// middle of the first line.
    fn grid(rows: &[&str]) -> Grid {
        let mut grid = Grid::of(&crate::world::hall_map::HallMap::new(Cell::HOME, crate::units::Revision(1)));
        for (y, row) in (0..).zip(rows) {
            for (x, letter) in (0..).zip(row.chars()) {
                let square = match letter {
                    '.' => Square::Visited,
                    '#' => Square::Obstacle,
                    'T' => Square::Luggage,
                    _ => continue,
                };
                grid.set(Cell::new(x - 1, y - 1), square);
            }
        }
        grid
    }

    fn of(rows: &[&str]) -> Option<Forecast> {
        forecast(&grid(rows), Strategy::Auto, Cell::HOME, 2.0, 0)
    }

    #[test]
    fn what_is_unknown_inside_the_walls_is_left() {
        let closed = of(&["######", "#...##", "#.   #", "#.   #", "######"]).unwrap();
        let left = 2.0 * f64::from(4 * 3 - 5 - 1);
        assert_eq!(closed, Forecast { least: 0.7 * left, most: Some(1.75 * left) });
    }

    #[test]
    fn while_a_side_of_the_hall_may_go_on_there_is_no_most() {
        let open = of(&["######", "#...", "#.   ", "#.   ", "####  "]).unwrap();
        assert_eq!(open.most, None);
        assert!(open.least > 0.0);
    }

    #[test]
    fn the_snail_has_no_most_and_a_search_at_its_end_nothing_left() {
        let rows = ["######", "#...##", "#.   #", "#.   #", "######"];
        assert_eq!(forecast(&grid(&rows), Strategy::Snail, Cell::HOME, 2.0, 0).unwrap().most, None);
        assert_eq!(of(&["####", "#..#", "#.T#", "####"]), None);
    }
}
