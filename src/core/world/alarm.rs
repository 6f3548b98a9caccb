//! Alarms: what an operator must be told loudly, until somebody says that it was seen.

use std::sync::Arc;

use crate::core::units::{AlarmId, LuggageId, Wall};

/// One alarm.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alarm {
    /// Its number.
    pub id: AlarmId,
    /// When it was raised.
    pub raised: Wall,
    /// What it says to an operator.
    pub text: String,
    /// The piece it is about, where it is about one.
    pub luggage: Option<LuggageId>,
    /// Who has seen it, and when.
    pub acknowledged: Option<(Arc<str>, Wall)>,
}
