//! The knowledge about one cell, and rectangles of cells. `hall_map` has the whole map.

use crate::units::Cell;

named! {
    by name;
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Mark {
        #[default]
        Unknown = "unknown",
        /// The sonar has seen that the cell is free, but the robot has not been there yet.
        Seen = "seen",
        /// The robot has been there, so the cell is free.
        Visited = "visited",
        Wall = "wall",
        /// An inspected piece of luggage, or an inspected obstacle that may be luggage.
        Luggage = "luggage",
        NotInspected = "notInspected",
    }
}

impl Mark {
    /// Whether the robot has not been in the cell, and no obstacle is known there.
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

    #[must_use]
    pub const fn width(self) -> i32 {
        self.most.x - self.least.x + 1
    }

    #[must_use]
    pub const fn height(self) -> i32 {
        self.most.y - self.least.y + 1
    }
}
