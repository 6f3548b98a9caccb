//! The temperature of the hall: the last reading of every source, compared with the threshold.
//! Which hold follows from it is the mission's business.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::units::Celsius;

/// The source of the operator's own readings.
pub const OPERATOR: &str = "operator";

/// The source of the robot's own thermometer.
pub const ROBOT: &str = "robot";

/// The source of all for whom there is no room.
pub const OTHERS: &str = "others";

/// How many sources are listened to: the operator, the hall, and room for the sensors of a large hall.
pub const SOURCES: usize = 64;

/// The last reading of every source. A source is hot from a reading above the threshold until one at or below
/// threshold − hysteresis; the hall is hot while any source is.
#[derive(Clone, Debug)]
pub(crate) struct Thermometer {
    threshold: Celsius,
    hysteresis: f64,
    sources: BTreeMap<Arc<str>, Source>,
    /// The latest reading of all.
    pub(crate) last: Option<Celsius>,
}

#[derive(Clone, Copy, Debug)]
struct Source {
    hot: bool,
    reading: Celsius,
}

impl Thermometer {
    pub(crate) const fn new(threshold: Celsius, hysteresis: f64) -> Thermometer {
        Thermometer { threshold, hysteresis, sources: BTreeMap::new(), last: None }
    }

    /// Takes a reading; true when it is news: of this source, or in what a door shows. Readings of more sources than can be listened to are
    /// shown, and count as `OTHERS`.
    pub(crate) fn read(&mut self, source: &Arc<str>, reading: Celsius) -> bool {
        let source = if self.sources.len() < SOURCES || self.sources.contains_key(source) {
            Arc::clone(source)
        } else {
            Arc::from(OTHERS)
        };
        let known = self.sources.get(&source).map(|source| source.reading);
        let entry = self.sources.entry(source).or_insert(Source { hot: false, reading });
        entry.reading = reading;
        if reading > self.threshold {
            entry.hot = true;
        } else if reading.degrees() <= self.threshold.degrees() - self.hysteresis {
            entry.hot = false;
        }
        self.last.replace(reading) != Some(reading) || known != Some(reading)
    }

    /// The source will not be heard again. If its last word is that it is too hot, that becomes the operator's word, who alone can take it
    /// back; true when it is.
    pub(crate) fn retire(&mut self, source: &str) -> bool {
        let left = self.sources.remove(source).filter(|left| left.hot);
        left.is_some_and(|left| {
            self.sources.insert(Arc::from(OPERATOR), left);
            true
        })
    }

    /// Whether any source's last word is that it is too hot.
    pub(crate) fn is_hot(&self) -> bool {
        self.sources.values().any(|source| source.hot)
    }

    pub(crate) fn view(&self, status: TemperatureStatus) -> TemperatureView {
        let hot = self.sources.iter().filter(|(_, source)| source.hot).map(|(name, source)| (Arc::clone(name), source.reading));
        TemperatureView { celsius: self.last, status, threshold: self.threshold, cool: self.cool(), hot: hot.collect() }
    }

    fn cool(&self) -> Celsius {
        Celsius::new(self.threshold.degrees() - self.hysteresis).unwrap_or(self.threshold)
    }
}

/// What is shown of the temperature.
#[derive(Clone, Debug, PartialEq)]
pub struct TemperatureView {
    /// The latest reading, if there was one.
    pub celsius: Option<Celsius>,
    /// What it means.
    pub status: TemperatureStatus,
    /// Above this nothing moves.
    pub threshold: Celsius,
    /// A source that was above it is cool again at this reading or below.
    pub cool: Celsius,
    /// The sources that keep the hall too hot, each with its last reading.
    pub hot: Vec<(Arc<str>, Celsius)>,
}

named! {
    ALL by name;
    /// What the temperature means for the robot.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum TemperatureStatus {
        /// It may move.
        Ok = "ok",
        /// Too hot, by a reading or by the operator's word.
        TooHigh = "tooHigh",
        /// A configured sensor is silent.
        Stale = "stale",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn celsius(degrees: f64) -> Celsius {
        Celsius::new(degrees).expect("the tests use believable temperatures")
    }

    fn thermometer() -> Thermometer {
        Thermometer::new(celsius(25.0), 1.0)
    }

    #[test]
    fn the_threshold_itself_is_not_too_hot() {
        let mut thermometer = thermometer();
        thermometer.read(&"hall".into(), celsius(25.0));
        assert!(!thermometer.is_hot());
        thermometer.read(&"hall".into(), celsius(25.1));
        assert!(thermometer.is_hot());
    }

    #[test]
    fn it_is_cool_again_only_one_degree_below() {
        let mut thermometer = thermometer();
        thermometer.read(&"hall".into(), celsius(26.0));
        thermometer.read(&"hall".into(), celsius(24.5));
        assert!(thermometer.is_hot());
        thermometer.read(&"hall".into(), celsius(24.0));
        assert!(!thermometer.is_hot());
    }

    #[test]
    fn every_source_must_permit() {
        let mut thermometer = thermometer();
        thermometer.read(&"operator".into(), celsius(30.0));
        thermometer.read(&"hall".into(), celsius(20.0));
        assert!(thermometer.is_hot(), "one cool source does not speak for a hot one");
        thermometer.read(&"operator".into(), celsius(20.0));
        assert!(!thermometer.is_hot());
    }

    #[test]
    fn what_a_source_said_that_is_gone_is_the_operators_to_take_back() {
        let mut thermometer = thermometer();
        thermometer.read(&"robot".into(), celsius(20.0));
        assert!(!thermometer.retire("robot") && !thermometer.is_hot(), "it was not hot");
        thermometer.read(&"operator".into(), celsius(20.0));
        thermometer.read(&"robot".into(), celsius(30.0));
        assert!(thermometer.retire("robot") && thermometer.is_hot(), "a thermometer that is taken away cools no hall");
        assert!(!thermometer.retire("robot") && thermometer.is_hot(), "it is said once");
        thermometer.read(&"operator".into(), celsius(20.0));
        assert!(!thermometer.is_hot());
    }
}
