//! The holds: reasons why the robot must not move. The set of holds is separate from the phase. While the set is not
//! empty, nothing moves (mission §4).

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::units::Celsius;

named! {
    ALL by name;
    /// One reason why the robot must not move.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Hold {
        Operator = "operator",
        /// The operator's button TOO HIGH.
        TooHigh = "tooHigh",
        Temperature = "temperature",
        TemperatureStale = "temperatureStale",
        RobotLink = "robotLink",
        Store = "store",
        Restart = "restart",
        /// A verdict of danger could not be recorded, or the pair of robots calls the operator. The hold ends when
        /// the alarm is acknowledged, or when the danger is recorded.
        Alarm = "alarm",
        /// Another hold was raised, and the robot has not been released since then, for example by START. The cause
        /// of that other hold may be gone.
        AwaitingStart = "awaitingStart",
    }
}

impl Hold {
    /// Returns the hold and the advice for it, as text for an operator.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Hold::Operator => "stopped by the operator",
            Hold::TooHigh => "temperature too high (button): press OK first",
            Hold::Temperature => "a reading is above the threshold: every source must read cool again",
            Hold::TemperatureStale => "the temperature sensor is silent: mend it first",
            Hold::RobotLink => "the robot cannot be reached: mend the link first",
            Hold::Store => "nothing can be recorded: mend the disk first",
            Hold::Restart => "the program was started again; everything is as it was",
            Hold::Alarm => "an alarm is open: acknowledge it first (or say danger again, where a danger could not be recorded)",
            Hold::AwaitingStart => "waiting for START",
        }
    }

    /// Returns the end of the hold as text for an operator.
    #[must_use]
    pub const fn over_in_words(self) -> &'static str {
        match self {
            Hold::Operator => "no longer stopped by the operator",
            Hold::TooHigh => "temperature OK (button)",
            Hold::Temperature => "every reading is cool again",
            Hold::TemperatureStale => "the temperature sensors are heard again",
            Hold::RobotLink => "the robot is reached",
            Hold::Store => "everything is recorded again",
            Hold::Restart => "going on after the restart",
            Hold::Alarm => "the alarm that held is acknowledged, or the danger on record",
            Hold::AwaitingStart => "started",
        }
    }

    /// Whether an accepted movement command clears the hold. Other holds end only when their own cause ends.
    pub(crate) const fn cleared_by_start(self) -> bool {
        matches!(self, Hold::Operator | Hold::Restart | Hold::AwaitingStart)
    }
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Holds(BTreeSet<Hold>);

impl Holds {
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    #[must_use]
    pub fn contains(&self, hold: Hold) -> bool {
        self.0.contains(&hold)
    }

    /// Raises a hold. Returns true if it was not raised before.
    pub(crate) fn raise(&mut self, hold: Hold) -> bool {
        self.0.insert(hold)
    }

    /// Clears only this hold. Returns true if it was raised.
    pub(crate) fn clear(&mut self, hold: Hold) -> bool {
        self.0.remove(&hold)
    }

    /// Clears every hold that a movement command clears. Returns true if there was at least one.
    pub(crate) fn release(&mut self) -> bool {
        let before = self.0.len();
        self.0.retain(|hold| !hold.cleared_by_start());
        self.0.len() != before
    }

    pub(crate) fn standing_against_start(&self) -> Vec<Hold> {
        self.0.iter().copied().filter(|hold| !hold.cleared_by_start()).collect()
    }

    #[must_use]
    pub fn to_vec(&self) -> Vec<Hold> {
        self.0.iter().copied().collect()
    }
}

impl FromIterator<Hold> for Holds {
    fn from_iter<I: IntoIterator<Item = Hold>>(holds: I) -> Holds {
        Holds(holds.into_iter().collect())
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum HoldReason {
    /// The reading that was too hot.
    Reading(Celsius),
    Silent(Arc<str>),
    /// The sensor with this name has not reported since the start of the program.
    Unheard(Arc<str>),
    /// A text from the store, or from the link to a robot.
    Words(String),
}

impl std::fmt::Display for HoldReason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            HoldReason::Reading(celsius) => write!(f, "{celsius}"),
            HoldReason::Silent(sensor) => f.write_str(sensor),
            HoldReason::Unheard(sensor) => write!(f, "{sensor} has not been heard yet"),
            HoldReason::Words(words) => f.write_str(words),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clearing_one_hold_clears_no_other() {
        let mut holds = Holds::default();
        for hold in Hold::ALL {
            assert!(holds.raise(hold));
        }
        assert!(holds.clear(Hold::TooHigh));
        assert_eq!(holds.to_vec().len(), Hold::ALL.len() - 1);
    }

    #[test]
    fn a_start_clears_only_what_it_may() {
        let mut holds = Holds::default();
        for hold in Hold::ALL {
            holds.raise(hold);
        }
        assert!(holds.release());
        assert_eq!(holds.to_vec(), holds.standing_against_start());
        assert!(holds.contains(Hold::Temperature) && !holds.contains(Hold::Operator));
    }
}
