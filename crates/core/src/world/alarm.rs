//! Alarms: what an operator must be told loudly, until somebody acknowledges it. An alarm is shown at once. Its number
//! is shown once the alarm is on record, because a number that was shown must never mean another alarm (safety R4).

use std::fmt;
use std::sync::Arc;

use crate::pair::Saying;
use crate::units::{AlarmId, Cell, LuggageId, WallTime};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alarm {
    pub id: AlarmId,
    pub raised: WallTime,
    pub cause: AlarmCause,
    pub luggage: Option<LuggageId>,
    /// Who acknowledged the alarm, and when.
    pub acknowledged: Option<(Arc<str>, WallTime)>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmView {
    /// `None` until the alarm is on record.
    pub id: Option<AlarmId>,
    pub raised: WallTime,
    pub cause: AlarmCause,
    pub luggage: Option<LuggageId>,
    /// Who acknowledged the alarm, and when.
    pub acknowledged: Option<(Arc<str>, WallTime)>,
}

/// Why there is an alarm. `Display` is what an operator reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AlarmCause {
    Dangerous(LuggageId, Cell),
    /// The piece was found dangerous, but that is not on record.
    Unrecorded(LuggageId, Cell),
    /// The pair that fetches this piece calls the operator.
    Call(LuggageId, Saying),
    /// A cause that another version of the program recorded, in its words.
    Other(String),
}

impl fmt::Display for AlarmCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AlarmCause::Dangerous(luggage, cell) => write!(f, "luggage #{luggage} at {cell} is dangerous"),
            AlarmCause::Unrecorded(luggage, cell) => {
                write!(f, "luggage #{luggage} at {cell} is said to be dangerous, but that could not be recorded")
            }
            AlarmCause::Call(luggage, saying) => write!(f, "luggage #{luggage}: {}", saying.in_words()),
            AlarmCause::Other(words) => f.write_str(words),
        }
    }
}

impl AlarmView {
    pub(crate) fn recorded(alarm: &Alarm) -> AlarmView {
        AlarmView { id: Some(alarm.id), ..AlarmView::unrecorded(alarm) }
    }

    pub(crate) fn unrecorded(alarm: &Alarm) -> AlarmView {
        let Alarm { raised, cause, luggage, acknowledged, .. } = alarm.clone();
        AlarmView { id: None, raised, cause, luggage, acknowledged }
    }

    #[must_use]
    pub const fn is_recorded(&self) -> bool {
        self.id.is_some()
    }
}
