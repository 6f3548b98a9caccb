//! The basic quantities: cells, headings, poses, temperatures, time and identifying numbers. Nothing here reads a
//! clock or defines an encoding for clients.

use std::fmt;
use std::time::Duration;

/// A square of the floor. Its side is as long as the robot. `x` grows to the east, `y` to the south (mission §3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    pub x: i32,
    pub y: i32,
}

impl Cell {
    /// The cell where the robot starts and to which it returns.
    pub const HOME: Cell = Cell { x: 0, y: 0 };

    #[must_use]
    pub const fn new(x: i32, y: i32) -> Cell {
        Cell { x, y }
    }

    /// Returns the position of this cell relative to `origin`.
    #[must_use]
    pub const fn relative_to(self, origin: Cell) -> Cell {
        Cell::new(self.x - origin.x, self.y - origin.y)
    }

    #[must_use]
    pub const fn ahead(self, heading: Heading) -> Cell {
        let (dx, dy) = heading.vector();
        Cell { x: self.x + dx, y: self.y + dy }
    }

    #[must_use]
    pub fn onward(self, heading: Heading, cells: u16) -> Cell {
        let (dx, dy) = heading.vector();
        Cell { x: self.x + dx * i32::from(cells), y: self.y + dy * i32::from(cells) }
    }

    /// The four cells that share a side with this one, clockwise from the north.
    #[must_use]
    pub fn neighbours(self) -> [Cell; 4] {
        Heading::ALL.map(|heading| self.ahead(heading))
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({}, {})", self.x, self.y)
    }
}

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Heading {
        /// Towards smaller `y`.
        North = "north",
        /// Towards greater `x`.
        East = "east",
        /// Towards greater `y`; every robot starts with this heading.
        South = "south",
        /// Towards smaller `x`.
        West = "west",
    }
}

impl Heading {
    #[must_use]
    pub const fn vector(self) -> (i32, i32) {
        match self {
            Heading::North => (0, -1),
            Heading::East => (1, 0),
            Heading::South => (0, 1),
            Heading::West => (-1, 0),
        }
    }

    #[must_use]
    pub const fn left(self) -> Heading {
        match self {
            Heading::North => Heading::West,
            Heading::East => Heading::North,
            Heading::South => Heading::East,
            Heading::West => Heading::South,
        }
    }

    #[must_use]
    pub const fn right(self) -> Heading {
        self.left().opposite()
    }

    #[must_use]
    pub const fn opposite(self) -> Heading {
        self.left().left()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Pose {
    pub cell: Cell,
    pub heading: Heading,
}

impl Pose {
    /// The pose of a robot that has just been put down at home.
    pub const START: Pose = Pose { cell: Cell::HOME, heading: Heading::South };

    #[must_use]
    pub const fn ahead(self) -> Cell {
        self.cell.ahead(self.heading)
    }
}

/// A temperature in °C that a thermometer in a hall could show.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Celsius(f64);

impl Celsius {
    /// The lowest reading that is accepted, in °C.
    pub const LEAST: f64 = -60.0;
    /// The highest reading that is accepted, in °C.
    pub const MOST: f64 = 1000.0;

    /// Returns `None` if `degrees` is not a number or is outside `LEAST..=MOST`.
    #[must_use]
    pub fn new(degrees: f64) -> Option<Celsius> {
        (Celsius::LEAST..=Celsius::MOST).contains(&degrees).then_some(Celsius(degrees))
    }

    #[must_use]
    pub const fn degrees(self) -> f64 {
        self.0
    }
}

impl fmt::Display for Celsius {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} °C", self.0)
    }
}

/// A time of the wall clock, for display and records only. Sequence numbers decide the order of entries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct WallTime {
    /// Milliseconds since 1970-01-01T00:00:00Z.
    pub unix_ms: i64,
    /// Offset of the displayed time zone from UTC, in seconds; positive in the east.
    pub offset_s: i32,
}

impl WallTime {
    /// Shifts the time by this many milliseconds, because the clock was set by that amount.
    #[must_use]
    pub const fn set_by(self, ms: i64) -> WallTime {
        WallTime { unix_ms: self.unix_ms.saturating_add(ms), ..self }
    }
}

/// The current time. It is an argument, because the core never reads a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Now {
    /// Time since the program (or the simulated run) began. It never decreases.
    pub since_start: Duration,
    pub wall: WallTime,
}

/// Declares one number type for each kind of identifier, so that two kinds are never mixed up.
macro_rules! numbers {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u64);

        impl $name {
            /// Returns the next number, or the same number if it is the greatest possible one. Only a damaged record
            /// can hold that number, and it must not end the program.
            #[must_use]
            pub const fn next(self) -> $name {
                $name(self.0.saturating_add(1))
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{}", self.0)
            }
        }
    )*};
}

numbers! {
    /// The number of a luggage record, counted from 1 over the whole store and never used twice.
    LuggageId;
    /// The number of a mission, counted from 1 over the whole store.
    MissionId;
    /// The number of an alarm on the console, counted from 1.
    AlarmId;
    /// The number of an order to a robot, counted from 1.
    OrderId;
    /// The number of changes of the state so far. Each resource stores the revision of its last change.
    Revision;
    /// A number that every stop increases. It shows whether a movement command was sent before or after a stop.
    Epoch;
    /// The number of an entry in the journal, counted from 1.
    Seq;
    /// The number of an accepted command that still waits for its answer.
    Ticket;
}

/// The number by which the camera recognises a piece of luggage. It is not the number of a luggage record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Piece(pub u32);

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

    #[must_use]
    pub fn including(self, cell: Cell) -> Bounds {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_four_times_comes_back() {
        for heading in Heading::ALL {
            assert_eq!(heading.left().left().left().left(), heading);
            assert_eq!(heading.left().right(), heading);
            assert_eq!(heading.opposite().opposite(), heading);
        }
    }

    #[test]
    fn south_is_down_and_east_is_right() {
        assert_eq!(Cell::HOME.ahead(Heading::South), Cell::new(0, 1));
        assert_eq!(Cell::HOME.ahead(Heading::East), Cell::new(1, 0));
        assert_eq!(Heading::South.left(), Heading::East);
    }

    #[test]
    fn a_temperature_must_be_a_number_a_hall_can_have() {
        assert_eq!(Celsius::new(21.5).map(Celsius::degrees), Some(21.5));
        assert_eq!(Celsius::new(f64::NAN), None);
        assert_eq!(Celsius::new(f64::INFINITY), None);
        assert_eq!(Celsius::new(-61.0), None);
    }
}
