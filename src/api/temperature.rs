//! The temperature in JSON, with the sources that keep the hall too hot. The core judges the readings.

use schemars::JsonSchema;
use serde::Serialize;

use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::units::Revision;
use hallsweep_core::world::temperature::TemperatureView;

/// The temperature and what it means.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct TemperatureJson {
    /// When it last changed.
    pub revision: u64,
    /// The latest reading in °C of all sources that are not silent, else of all; null before the first.
    pub celsius: Option<f64>,
    /// When it was read, to 5 seconds; null where that is not known.
    pub read_at: Option<String>,
    /// Since when its source is silent, so that the temperature is not known; null while it is.
    pub silent_since: Option<String>,
    /// `ok`, `tooHigh` or `stale`.
    #[schemars(with = "vocabulary::TemperatureStatus")]
    pub status: &'static str,
    /// In °C; above it nothing moves.
    pub threshold: f64,
    /// In °C; a source that was too hot is cool again at this reading or below.
    pub cool: f64,
    /// The sources that keep the hall too hot, each with its last reading; empty when no reading does.
    pub hot: Vec<HotJson>,
}

/// A source that is too hot.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct HotJson {
    /// `operator`, `robot`, or the name of a sensor.
    pub source: String,
    /// Its last reading in °C.
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
