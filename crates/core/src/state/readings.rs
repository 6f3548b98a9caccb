//! Readings of thermometers from the journal. `world::temperature` decides what a reading means.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use crate::state::fact::{Entry, Fact};
use crate::units::Now;
use crate::world::temperature::Thermometer;

/// The sources that are not silent, according to the journal.
#[derive(Clone, Debug, Default)]
pub struct Speaking(BTreeSet<Arc<str>>);

impl Speaking {
    /// Takes a fact. Returns whether any source is speaking afterwards.
    pub fn hear(&mut self, fact: &Fact) -> bool {
        if let Fact::Temperature(source, _) = fact {
            self.0.insert(Arc::clone(source));
        } else if let Fact::ThermometerSilent(source) = fact {
            self.0.remove(source);
        } else if let Fact::ProgramStarted(_) = fact {
            self.0.clear();
        }
        !self.0.is_empty()
    }
}

/// Feeds the readings of the journal, oldest first, to a thermometer. They have the same effect as when they were
/// first received.
pub(crate) fn recall(thermometer: &mut Thermometer, entries: &[Entry]) {
    for (Entry { wall, fact }, minute) in entries.iter().zip(0..) {
        // Entries are treated as one minute apart, so that each reading is shown.
        let now = Now { wall: *wall, since_start: Duration::from_secs(60 * minute) };
        if let Fact::Temperature(source, celsius) = fact {
            thermometer.read(source, *celsius, now);
        } else if let Fact::ThermometerSilent(source) = fact {
            thermometer.fall_silent(source, *wall);
        } else if let Fact::ClockSet(by_ms) = fact {
            thermometer.set_clock(*by_ms);
        } else if let Fact::ProgramStarted(_) = fact {
            thermometer.begin_anew(now);
        }
    }
}
