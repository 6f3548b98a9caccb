//! The temperature in JSON.

use schemars::JsonSchema;
use serde::Serialize;

use super::vocabulary;
use hallsweep_core::units::Revision;
use hallsweep_core::world::temperature::TemperatureView;

/// The temperature and what it means.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TemperatureJson {
    /// When it last changed.
    pub revision: u64,
    /// The latest reading in °C, or null before the first.
    pub celsius: Option<f64>,
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
    /// The temperature as it is at `revision`.
    pub fn new(view: &TemperatureView, revision: Revision) -> TemperatureJson {
        TemperatureJson {
            revision: revision.0,
            celsius: view.celsius.map(|celsius| celsius.degrees()),
            status: view.status.name(),
            threshold: view.threshold.degrees(),
            cool: view.cool.degrees(),
            hot: view
                .hot
                .iter()
                .map(|(source, celsius)| HotJson { source: source.to_string(), celsius: celsius.degrees() })
                .collect(),
        }
    }
}
