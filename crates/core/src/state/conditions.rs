//! The circumstances of a mission, put on record because they may change later: where the mission was, and which
//! temperature counted as too hot.

use std::fmt;
use std::sync::Arc;

use crate::units::Celsius;

#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    pub venue: Venue,
    /// Temperature above which nothing moves.
    pub threshold: Celsius,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Venue {
    /// The name of the hall. For a foreign place it is what is known of the place, such as the address of the robot
    /// there.
    pub name: Arc<str>,
    /// The side of a cell, in metres, where it is known.
    pub cell_m: Option<f64>,
    /// Whether the searching robot measures its way by time, and no scene file tells where things are. A thing that is
    /// met for the first time may then be shown one cell off.
    pub is_reckoned: bool,
    /// `None` where the hall is not known beforehand.
    pub reach: Option<Reach>,
    /// Robots that take part, the one that searches first; none if they are not on record.
    pub robots: Arc<[Participant]>,
    /// The seed of everything random in a simulated hall.
    pub seed: Option<u64>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Participant {
    pub name: Arc<str>,
    /// The kind of the robot, such as `sim` or `line`; the settings list all kinds.
    pub kind: Arc<str>,
    /// `None` for a robot that is part of this program.
    pub address: Option<Arc<str>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Free cells that can be reached, the start included.
    pub reachable: u32,
    /// All free cells, including the cells that cannot be reached.
    pub free: u32,
}

impl Reach {
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
