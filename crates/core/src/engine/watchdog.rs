//! Watches how long each configured temperature sensor is silent. The transition table defines what silence means for
//! the mission.

use std::sync::Arc;
use std::time::Duration;

#[derive(Clone, Debug, Default)]
pub(super) struct SensorWatchdog(Vec<Watched>);

#[derive(Clone, Debug)]
struct Watched {
    sensor: Arc<str>,
    patience: Duration,
    /// When the sensor will count as silent, unless it reports before; `None` if it counts as silent already.
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

    /// Handles a report of the sensor. Returns true if this was the last silent sensor.
    pub(super) fn hear(&mut self, sensor: &str, since_start: Duration) -> bool {
        let Some(watched) = self.0.iter_mut().find(|watched| *watched.sensor == *sensor) else { return false };
        let was_silent = watched.due.replace(since_start.saturating_add(watched.patience)).is_none();
        was_silent && self.0.iter().all(|watched| watched.due.is_some())
    }

    pub(super) fn due(&self) -> Option<Duration> {
        self.0.iter().filter_map(|watched| watched.due).min()
    }

    /// Returns a sensor that has just become silent. Each silence is returned only once.
    pub(super) fn falls_silent(&mut self, since_start: Duration) -> Option<Arc<str>> {
        let watched = self.0.iter_mut().find(|watched| watched.due.is_some_and(|due| due <= since_start))?;
        watched.due = None;
        Some(Arc::clone(&watched.sensor))
    }
}
