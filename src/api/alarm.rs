//! Alarms in JSON. The core raises and acknowledges alarms.

use schemars::JsonSchema;
use serde::Serialize;

use super::time::rfc3339;
use hallsweep_core::world::alarm::AlarmView;

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AlarmJson {
    /// Number of the alarm; null until the alarm is on record.
    pub id: Option<u64>,
    /// Whether the alarm is on record. Only a recorded alarm can be acknowledged.
    pub recorded: bool,
    /// Time at which the alarm was raised, RFC 3339.
    pub raised: String,
    /// Message for the operator.
    pub text: String,
    /// Number of the piece that the alarm is about, or null.
    pub luggage: Option<u64>,
    /// Acknowledgement of the alarm, or null.
    pub acknowledged: Option<Acknowledgement>,
}

/// Acknowledgement of an alarm.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Acknowledgement {
    /// Name of the sender who acknowledged the alarm.
    pub by: String,
    /// Time of the acknowledgement, RFC 3339.
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
