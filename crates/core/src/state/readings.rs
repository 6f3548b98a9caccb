//! What the journal tells of thermometers.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use crate::effect::{Entry, Fact};
use crate::units::Now;
use crate::world::temperature::Thermometer;

/// The sources that are not silent, as the journal tells.
#[derive(Clone, Debug, Default)]
pub struct Speaking(BTreeSet<Arc<str>>);

impl Speaking {
    /// Whether any source speaks after this.
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

/// Lets a thermometer take what the journal tells, oldest first, as it was taken when it happened.
pub(crate) fn recall(thermometer: &mut Thermometer, entries: &[Entry]) {
    for (Entry { wall, fact }, minute) in entries.iter().zip(0..) {
        // Far enough from one another that each is shown.
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
