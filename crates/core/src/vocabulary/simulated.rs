//! Changes that a user makes to a simulated hall and its robots, for the log and the journal. The simulation itself
//! is not part of the core.

use std::collections::BTreeSet;
use std::fmt;
use std::sync::Arc;

use crate::speed::Speed;
use crate::units::Cell;

/// A user's action on the simulator. `Display` gives its text in the log.
#[derive(Clone, Debug, PartialEq)]
pub enum Simulated {
    Changed(Change),
    /// Every robot was moved to the end of its current action.
    Step,
    /// The robots were placed in the hall with this name.
    PutDown(Arc<str>),
    Kept(String),
    Discarded(String),
}

/// The parts of the simulation that change. Parts without a value stay as they are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Change {
    pub speed: Option<Speed>,
    pub is_paused: Option<bool>,
    /// Whether the link to the robot that searches is lost.
    pub link_lost: Option<bool>,
    pub no_thermometer: Option<bool>,
    pub camera_fails: Option<bool>,
    /// The cells that are blocked by something that is not part of the hall.
    pub blocked: Option<BTreeSet<Cell>>,
}

impl fmt::Display for Simulated {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Simulated::Changed(change) => write!(f, "simulator {change}"),
            Simulated::Step => f.write_str("simulator one step"),
            Simulated::PutDown(hall) => write!(f, "put down in the hall {hall}"),
            Simulated::Kept(hall) => write!(f, "simulator keeps the hall {hall}"),
            Simulated::Discarded(hall) => write!(f, "simulator discards the hall {hall}"),
        }
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fault = |name: &str, is_so: bool| format!("{name}: {}", if is_so { "yes" } else { "no" });
        let cells = |cells: &BTreeSet<Cell>| match cells.len() {
            0 => "no way blocked".to_owned(),
            _ => format!("blocked {}", cells.iter().map(Cell::to_string).collect::<Vec<_>>().join(", ")),
        };
        let words = [
            self.is_paused.map(|is_paused| if is_paused { "paused" } else { "going on" }.to_owned()),
            self.speed.map(|speed| format!("speed {speed}")),
            self.link_lost.map(|is_so| fault("link lost", is_so)),
            self.no_thermometer.map(|is_so| fault("no thermometer", is_so)),
            self.camera_fails.map(|is_so| fault("camera fails", is_so)),
            self.blocked.as_ref().map(cells),
        ];
        f.write_str(&words.into_iter().flatten().collect::<Vec<_>>().join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_is_said_in_words() {
        let change = Change {
            speed: Some(Speed::Times(2.5)),
            is_paused: Some(true),
            camera_fails: Some(false),
            blocked: Some(BTreeSet::from([Cell::new(1, 2), Cell::new(3, 4)])),
            ..Change::default()
        };
        let words = "simulator paused, speed 2.5, camera fails: no, blocked (1, 2), (3, 4)";
        assert_eq!(Simulated::Changed(change).to_string(), words);
        let free = Change { blocked: Some(BTreeSet::new()), is_paused: Some(false), ..Change::default() };
        assert_eq!(free.to_string(), "going on, no way blocked");
    }
}
