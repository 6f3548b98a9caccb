//! What is known of a cell, and rectangles of cells. A whole map stands in `hall_map`.

use crate::units::Cell;

named! {
    by name;
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Mark {
        #[default]
        Unknown = "unknown",
        /// The sonar has seen that the cell is free; the robot was not there yet.
        Seen = "seen",
        /// The robot was there, so the cell is free.
        Visited = "visited",
        Wall = "wall",
        /// An inspected piece of luggage, or an inspected obstacle that may be luggage.
        Luggage = "luggage",
        NotInspected = "notInspected",
    }
}

impl Mark {
    /// Whether the robot is still to go there, as far as no known obstacle prevents it.
    #[must_use]
    pub const fn is_unvisited(self) -> bool {
        matches!(self, Mark::Unknown | Mark::Seen)
    }

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
    #[must_use]
    pub const fn of(cell: Cell) -> Bounds {
        Bounds { least: cell, most: cell }
    }

    pub(crate) fn including(self, cell: Cell) -> Bounds {
        Bounds {
            least: Cell::new(self.least.x.min(cell.x), self.least.y.min(cell.y)),
            most: Cell::new(self.most.x.max(cell.x), self.most.y.max(cell.y)),
        }
    }

    #[must_use]
    pub const fn grown(self, by: i32) -> Bounds {
        Bounds { least: Cell::new(self.least.x - by, self.least.y - by), most: Cell::new(self.most.x + by, self.most.y + by) }
    }

    #[must_use]
    pub const fn contains(self, cell: Cell) -> bool {
        cell.x >= self.least.x && cell.y >= self.least.y && cell.x <= self.most.x && cell.y <= self.most.y
    }

    /// Number of columns.
    #[must_use]
    pub const fn width(self) -> i32 {
        self.most.x - self.least.x + 1
    }

    /// Number of rows.
    #[must_use]
    pub const fn height(self) -> i32 {
        self.most.y - self.least.y + 1
    }
}
