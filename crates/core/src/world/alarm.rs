//! Alarms: what an operator must be told loudly, until somebody says that it was seen. One is shown at once; its number is shown
//! when it is on record, because a number that was shown must never mean another (safety R4).

use std::sync::Arc;

use crate::units::{AlarmId, LuggageId, WallTime};

/// One alarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alarm {
    /// Its number.
    pub id: AlarmId,
    /// When it was raised.
    pub raised: WallTime,
    /// What it says to an operator.
    pub text: String,
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
    pub text: String,
    /// The piece it is about, where it is about one.
    pub luggage: Option<LuggageId>,
    /// Who has seen it, and when.
    pub acknowledged: Option<(Arc<str>, WallTime)>,
}

impl AlarmView {
    pub(crate) fn recorded(alarm: &Alarm) -> AlarmView {
        AlarmView { id: Some(alarm.id), ..AlarmView::unrecorded(alarm) }
    }

    pub(crate) fn unrecorded(alarm: &Alarm) -> AlarmView {
        let Alarm { raised, text, luggage, acknowledged, .. } = alarm.clone();
        AlarmView { id: None, raised, text, luggage, acknowledged }
    }

    /// Whether it is on record.
    #[must_use]
    pub const fn is_recorded(&self) -> bool {
        self.id.is_some()
    }
}
