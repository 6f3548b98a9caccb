//! The place of a mission, its temperature threshold and the rules of its team. They are recorded because they may
//! change later.

use std::fmt;
use std::sync::Arc;

use crate::settings::Rules;
use crate::units::Celsius;
use crate::world::areas::Area;
use crate::world::coverage::Sensor;

#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    pub venue: Venue,
    /// Temperature above which nothing moves.
    pub threshold: Celsius,
    pub rules: Rules,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Venue {
    /// The name of the hall. If the hall has no name here, this text is something known about the hall, such as the
    /// address of the robot there.
    pub name: Arc<str>,
    /// The length of a cell's side, in metres, if known.
    pub cell_m: Option<f64>,
    /// Whether the searching robot measures its way by time, and no scene file gives the positions of things.
    /// Something that the robot meets for the first time may then be shown one cell away from its true place.
    pub is_reckoned: bool,
    /// The known size of the hall; `None` if the hall is not known beforehand.
    pub reach: Option<Reach>,
    /// The robots that take part, the one that searches first; empty if they are not recorded.
    pub robots: Arc<[Participant]>,
    /// Whether test pieces stand in the hall.
    pub is_exercise: bool,
    /// The seed of all random numbers in a simulated hall. In an exercise it is left out, because it says where the
    /// test pieces stand.
    pub seed: Option<u64>,
    /// The named areas of the hall, in the order of the hall file.
    pub areas: Arc<[Area]>,
    pub sensor: Sensor,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Participant {
    pub name: Arc<str>,
    /// The kind of the robot, such as `sim` or `line`; the settings list all kinds.
    pub kind: Arc<str>,
    /// The address of the robot; `None` for a robot that is part of this program.
    pub address: Option<Arc<str>>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reach {
    /// Number of free cells that can be reached, including the start.
    pub reachable: u32,
    /// Number of all free cells, including the cells that cannot be reached.
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
