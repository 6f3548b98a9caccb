//! Alarms: what an operator must be told loudly, until somebody says that it was seen. One is shown at once; its number is shown
//! when it is on record, because a number that was shown must never mean another (safety R4).

use std::fmt;
use std::sync::Arc;

use crate::pair::Saying;
use crate::units::{AlarmId, Cell, LuggageId, WallTime};

/// One alarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alarm {
    /// Its number.
    pub id: AlarmId,
    /// When it was raised.
    pub raised: WallTime,
    /// What it says to an operator.
    pub cause: AlarmCause,
    /// The piece it is about, where it is about one.
    pub luggage: Option<LuggageId>,
    /// Who has seen it, and when.
    pub acknowledged: Option<(Arc<str>, WallTime)>,
}

/// What is shown of an alarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmView {
    /// Its number; `None` until it is on record.
    pub id: Option<AlarmId>,
    /// When it was raised.
    pub raised: WallTime,
    /// What it says to an operator.
    pub cause: AlarmCause,
    /// The piece it is about, where it is about one.
    pub luggage: Option<LuggageId>,
    /// Who has seen it, and when.
    pub acknowledged: Option<(Arc<str>, WallTime)>,
}

/// Why there is an alarm. `Display` is what an operator reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AlarmCause {
    /// The piece in this cell was found dangerous.
    Dangerous(LuggageId, Cell),
    /// The same was said of it, but is not on record.
    Unrecorded(LuggageId, Cell),
    /// The pair that fetches this piece has something to say.
    Call(LuggageId, Saying),
    /// In words of another version.
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

    /// Whether it is on record.
    #[must_use]
    pub const fn is_recorded(&self) -> bool {
        self.id.is_some()
    }
}
