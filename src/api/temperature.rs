//! The temperature in JSON, with the sources that keep the hall too hot. The core decides which readings are too hot.

use schemars::JsonSchema;
use serde::Serialize;

use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::units::Revision;
use hallsweep_core::world::temperature::TemperatureView;

/// Temperature of the hall, and its effect.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct TemperatureJson {
    /// Revision at which the temperature last changed.
    pub revision: u64,
    /// Latest reading in °C of the sources that are not silent, or of all sources if all are silent; null before the
    /// first reading.
    pub celsius: Option<f64>,
    /// Time of the reading, to within 5 seconds; null if the time is not known.
    pub read_at: Option<String>,
    /// Time since which the source of the reading is silent; null while the temperature is known.
    pub silent_since: Option<String>,
    /// Effect: `ok`, `tooHigh` or `stale`.
    #[schemars(with = "vocabulary::TemperatureStatus")]
    pub status: &'static str,
    /// Temperature above which no robot moves, in °C.
    pub threshold: f64,
    /// Highest reading at which a source that was too hot counts as cool again, in °C.
    pub cool: f64,
    /// Sources that still make the hall too hot, each with its last reading.
    pub hot: Vec<HotJson>,
}

/// A source that is too hot.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct HotJson {
    /// `operator`, `robot`, or the name of a sensor.
    pub source: String,
    /// Last reading of the source, in °C.
    pub celsius: f64,
}

impl TemperatureJson {
    pub fn new(view: &TemperatureView, revision: Revision) -> TemperatureJson {
        TemperatureJson {
            revision: revision.0,
            celsius: view.celsius.map(|celsius| celsius.degrees()),
            read_at: view.read.map(rfc3339),
            silent_since: view.silent_since.map(rfc3339),
            status: view.status.name(),
            threshold: view.threshold.degrees(),
            cool: view.cool.degrees(),
            hot: view
                .hot
                .iter()
                .map(|(source, last)| HotJson { source: source.to_string(), celsius: last.celsius.degrees() })
                .collect(),
        }
    }
}
