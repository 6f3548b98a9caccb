//! The circumstances of a mission's record, which may differ at another time: where it was, and which temperature
//! counted as too hot.

use std::fmt;
use std::sync::Arc;

use crate::units::Celsius;

#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    pub venue: Venue,
    /// Above this nothing moves.
    pub threshold: Celsius,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Venue {
    /// The name of the hall; for a foreign place, what is known of it, such as the address of the robot in it.
    pub name: Arc<str>,
    /// The side of a cell, in metres, where it is known.
    pub cell_m: Option<f64>,
    /// Whether the robot that searches counts its way by time, without known places of things: a thing that is met for
    /// the first time may then be shown a cell beside where it is.
    pub is_reckoned: bool,
    /// `None` where the hall is not known beforehand.
    pub reach: Option<Reach>,
    /// Robots that take part, the one that searches first; none where that is not on record.
    pub robots: Arc<[Participant]>,
    /// The seed of everything random in a simulated hall.
    pub seed: Option<u64>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Participant {
    pub name: Arc<str>,
    /// Such as `sim` or `line`: the settings have the list.
    pub kind: Arc<str>,
    /// `None` for a robot that is part of this program.
    pub address: Option<Arc<str>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    /// Free cells that can be reached, the start included.
    pub reachable: u32,
    /// All free cells, those that cannot be reached included.
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
