//! The quantities of the field: cells, headings, poses, temperatures, time and identifying numbers. Nothing here reads
//! a clock or knows how a value is written on a wire.

use std::fmt;
use std::time::Duration;

/// A square of the floor; its side is the robot's size. `x` grows to the east, `y` to the south (mission §3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Cell {
    pub x: i32,
    pub y: i32,
}

impl Cell {
    /// Where the robot starts and comes home to.
    pub const HOME: Cell = Cell { x: 0, y: 0 };

    #[must_use]
    pub const fn new(x: i32, y: i32) -> Cell {
        Cell { x, y }
    }

    /// The same cell, counted from `origin`.
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
        /// Towards lesser `y`.
        North = "north",
        /// Towards greater `x`.
        East = "east",
        /// Towards greater `y`; every robot starts with this heading.
        South = "south",
        /// Towards lesser `x`.
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
    /// The coldest reading believed, in °C.
    pub const LEAST: f64 = -60.0;
    /// The hottest reading believed, in °C.
    pub const MOST: f64 = 1000.0;

    /// `None` when `degrees` is not a number or outside `LEAST..=MOST`.
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

/// A moment of the wall clock, for display and records only; order follows from sequence numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct WallTime {
    /// Milliseconds since 1970-01-01T00:00:00Z.
    pub unix_ms: i64,
    /// Seconds east of UTC of the zone in which the moment is shown.
    pub offset_s: i32,
}

impl WallTime {
    /// The same moment by a clock that was set by this many milliseconds since then.
    #[must_use]
    pub const fn set_by(self, ms: i64) -> WallTime {
        WallTime { unix_ms: self.unix_ms.saturating_add(ms), ..self }
    }
}

/// The time as an argument: the core never asks for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Now {
    /// Since the program (or the simulated run) began; never goes back.
    pub since_start: Duration,
    pub wall: WallTime,
}

/// Declares number types for identifiers, so that one kind is never taken for another.
macro_rules! numbers {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub struct $name(pub u64);

        impl $name {
            /// The number after this one, or the same if it is the greatest. Nothing counts that far, but a damaged
            /// record may hold such a number, and that must not end the program.
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
    /// A luggage record; counted from 1 over the whole store, never used twice.
    LuggageId;
    /// A mission; counted from 1 over the whole store.
    MissionId;
    /// An alarm on the console; counted from 1.
    AlarmId;
    /// An order to a robot; counted from 1.
    OrderId;
    /// How often the state has changed; each resource remembers the revision of its last change.
    Revision;
    /// The epoch: raised by every stop, so that movement commands sent before the stop can be told from commands sent
    /// after it.
    Epoch;
    /// The place of an entry in the journal; counted from 1.
    Seq;
    /// An accepted command that still waits for its answer.
    Ticket;
}

/// The number by which the camera recognises a piece of luggage. The number says nothing about records.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Piece(pub u32);

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
