//! What a record of a mission means beside itself, and what may be other at another time: where it was, and what counted as too hot.

use std::fmt;
use std::sync::Arc;

use crate::units::Celsius;

/// The circumstances of what happens.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Where it happens.
    pub venue: Venue,
    /// Above this nothing moves.
    pub threshold: Celsius,
}

/// Where the robots are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Venue {
    /// The name of the hall; where it is none of ours, what is known of the place, as the address of the robot in it.
    pub name: Arc<str>,
    /// The side of a cell, in metres, where it is known.
    pub cell_m: Option<f64>,
    /// The robot that searches counts its way by time, and nobody has said where things stand: one that is met for the first time may
    /// be shown a cell beside where it is.
    pub is_reckoned: bool,
    /// How much of it can be searched, where it is known beforehand.
    pub reach: Option<Reach>,
    /// Robots that take part, the one that searches first; none where that is not on record.
    pub robots: Arc<[Participant]>,
    /// What chance follows from in a simulated hall.
    pub seed: Option<u64>,
}

/// A robot that takes part, as the settings have it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Participant {
    /// Its name.
    pub name: Arc<str>,
    /// As `sim` or `line`: the settings have the list.
    pub kind: Arc<str>,
    /// Where it is reached; `None` for one that is part of this program.
    pub address: Option<Arc<str>>,
}

/// How much of a hall a robot can come to from its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Free cells that can be reached, the start included.
    pub reachable: u32,
    /// All free cells.
    pub free: u32,
}

impl Reach {
    /// Whether some free cells cannot be reached.
    #[must_use]
    pub const fn is_partial(self) -> bool {
        self.reachable < self.free
    }
}

impl fmt::Display for Reach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} free cells can be reached from here", self.reachable, self.free)
    }
}
