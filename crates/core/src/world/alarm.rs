//! Alarms: urgent messages that somebody must acknowledge. An alarm is shown at once. Its number is shown only after
//! the alarm is recorded, because a shown number must never mean another alarm (safety R4).

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

/// Why there is an alarm. `Display` gives the text for an operator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AlarmCause {
    Dangerous(LuggageId, Cell),
    /// The piece was found dangerous, but the danger is not recorded.
    Unrecorded(LuggageId, Cell),
    /// The pair that fetches this piece calls the operator.
    Call(LuggageId, Saying),
    /// A cause that another version of the program recorded, as text.
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
