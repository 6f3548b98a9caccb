//! The watch over the configured temperature sensors: how long each may be silent. The table defines what silence means
//! for the mission.

use std::sync::Arc;
use std::time::Duration;

#[derive(Clone, Debug, Default)]
pub(super) struct SensorWatchdog(Vec<Watched>);

#[derive(Clone, Debug)]
struct Watched {
    sensor: Arc<str>,
    patience: Duration,
    /// When the silence of the sensor will have lasted too long; `None` once it has.
    due: Option<Duration>,
}

impl SensorWatchdog {
    /// Watches one more sensor, which counts as silent until its first report.
    pub(super) fn begin(&mut self, sensor: Arc<str>, patience: Duration) {
        self.0.retain(|watched| watched.sensor != sensor);
        self.0.push(Watched { sensor, patience, due: None });
    }

    pub(super) fn watches(&self, sensor: &str) -> bool {
        self.0.iter().any(|watched| *watched.sensor == *sensor)
    }

    /// The sensor reported; true when it was the last silent sensor.
    pub(super) fn hear(&mut self, sensor: &str, since_start: Duration) -> bool {
        let Some(watched) = self.0.iter_mut().find(|watched| *watched.sensor == *sensor) else { return false };
        let was_silent = watched.due.replace(since_start.saturating_add(watched.patience)).is_none();
        was_silent && self.0.iter().all(|watched| watched.due.is_some())
    }

    pub(super) fn due(&self) -> Option<Duration> {
        self.0.iter().filter_map(|watched| watched.due).min()
    }

    /// A sensor whose silence has just lasted too long; returned once.
    pub(super) fn falls_silent(&mut self, since_start: Duration) -> Option<Arc<str>> {
        let watched = self.0.iter_mut().find(|watched| watched.due.is_some_and(|due| due <= since_start))?;
        watched.due = None;
        Some(Arc::clone(&watched.sensor))
    }
}
