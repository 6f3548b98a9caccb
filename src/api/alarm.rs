//! Alarms in JSON. The core raises and acknowledges alarms.

use schemars::JsonSchema;
use serde::Serialize;

use super::time::rfc3339;
use hallsweep_core::world::alarm::AlarmView;

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AlarmJson {
    /// Its number; null until it is on record.
    pub id: Option<u64>,
    /// Whether it is on record. It is shown at once; it can be acknowledged when it is.
    pub recorded: bool,
    /// When it was raised, RFC 3339.
    pub raised: String,
    /// What it says to an operator.
    pub text: String,
    /// The number of the piece it is about, or null.
    pub luggage: Option<u64>,
    /// Who has seen it and when, or null.
    pub acknowledged: Option<Acknowledgement>,
}

/// That somebody has seen an alarm.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Acknowledgement {
    /// Who.
    pub by: String,
    /// When, RFC 3339.
    pub at: String,
}

impl From<&AlarmView> for AlarmJson {
    fn from(alarm: &AlarmView) -> AlarmJson {
        let acknowledged = alarm.acknowledged.as_ref();
        AlarmJson {
            id: alarm.id.map(|id| id.0),
            recorded: alarm.is_recorded(),
            raised: rfc3339(alarm.raised),
            text: alarm.cause.to_string(),
            luggage: alarm.luggage.map(|id| id.0),
            acknowledged: acknowledged.map(|(who, wall)| Acknowledgement { by: who.to_string(), at: rfc3339(*wall) }),
        }
    }
}
