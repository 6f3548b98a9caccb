//! The knowledge about one cell. `hall_map` has the whole map.

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

    /// Whether the cell was found to be free.
    #[must_use]
    pub const fn is_searched(self) -> bool {
        matches!(self, Mark::Seen | Mark::Visited)
    }

    #[must_use]
    pub const fn is_obstacle(self) -> bool {
        matches!(self, Mark::Wall | Mark::Luggage | Mark::NotInspected)
    }
}
