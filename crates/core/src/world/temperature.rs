//! The temperature of the hall: the last reading of every source, compared with the threshold. The mission decides
//! which hold is raised.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use crate::command::{OPERATOR, OTHERS, ROBOT};
use crate::units::{Celsius, Now, WallTime};

/// Maximum number of sources of readings: the operator, the robots, and the sensors of a large hall.
pub const SOURCES: usize = 64;

/// Time without a reading after which a robot's thermometer counts as silent. Sensors have their own setting.
pub const SILENCE: Duration = Duration::from_secs(30);

/// Minimum time between two updates while a reading stays the same. Without this limit, a thermometer that reports
/// often would wake every interface at each report.
const SHOWN_ANEW: Duration = Duration::from_secs(5);

/// Whether the source is the thermometer of a robot. No sensor has a blank in its name.
fn is_robot(source: &str) -> bool {
    source == ROBOT || source.strip_prefix(ROBOT).is_some_and(|rest| rest.starts_with(' '))
}

/// The last reading of every source. A source becomes hot with a reading above the threshold. It stays hot until a
/// reading at or below threshold − hysteresis. The hall is hot while any source is hot.
#[derive(Clone, Debug)]
pub(crate) struct Thermometer {
    threshold: Celsius,
    hysteresis: f64,
    sources: BTreeMap<Arc<str>, Source>,
    /// The latest reading of the sources that are not silent. If all are silent, it is the latest reading of all
    /// sources. The time of the reading may be a few seconds old.
    pub(crate) last: Option<(Arc<str>, Source)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Source {
    hot: bool,
    reading: Celsius,
    read: Now,
    silent_since: Option<WallTime>,
}

impl Source {
    fn view(&self) -> SourceReading {
        // If a reading and the silence of its source have the same time, the reading is from an earlier run. Its time
        // is then unknown.
        let read = Some(self.read.wall).filter(|read| Some(*read) != self.silent_since);
        SourceReading { celsius: self.reading, read, silent_since: self.silent_since }
    }
}

impl Thermometer {
    pub(crate) const fn new(threshold: Celsius, hysteresis: f64) -> Thermometer {
        Thermometer { threshold, hysteresis, sources: BTreeMap::new(), last: None }
    }

    /// Takes a reading. Returns true if something changes for this source or for the interfaces. If there are already
    /// `SOURCES` sources, a further source counts as `OTHERS`.
    pub(crate) fn read(&mut self, source: &Arc<str>, reading: Celsius, now: Now) -> bool {
        let source = if self.sources.len() < SOURCES || self.sources.contains_key(source) {
            Arc::clone(source)
        } else {
            Arc::from(OTHERS)
        };
        let known = self.sources.get(&source).copied();
        let stays_hot = known.is_some_and(|known| known.hot) && reading > self.cool();
        let next = Source { hot: reading > self.threshold || stays_hot, reading, read: now, silent_since: None };
        self.sources.insert(Arc::clone(&source), next);
        let is_the_same = known.is_some_and(|known| known.reading == reading && known.silent_since.is_none());
        let last = self.last.as_ref().filter(|(_, last)| last.reading == reading && last.silent_since.is_none());
        let is_news = !is_the_same || last.is_none();
        let is_shown = last.is_some_and(|(_, last)| now.since_start.saturating_sub(last.read.since_start) < SHOWN_ANEW);
        if is_news || !is_shown {
            self.last = Some((source, next));
        }
        is_news
    }

    /// Marks a source as silent, so that its last reading no longer counts as known. Returns true if the source was
    /// not silent before.
    pub(crate) fn fall_silent(&mut self, source: &str, wall: WallTime) -> bool {
        let Some(known) = self.sources.get_mut(source).filter(|known| known.silent_since.is_none()) else { return false };
        known.silent_since = Some(wall);
        let latest = self.sources.iter().max_by_key(|(_, source)| (source.silent_since.is_none(), source.read.since_start));
        self.last = latest.map(|(name, source)| (Arc::clone(name), *source));
        true
    }

    /// Shifts the times of all readings, because the machine's clock was set by this many milliseconds. Readings keep
    /// their age.
    pub(crate) fn set_clock(&mut self, by_ms: i64) {
        for source in self.sources.values_mut().chain(self.last.iter_mut().map(|(_, last)| last)) {
            source.read.wall = source.read.wall.set_by(by_ms);
            source.silent_since = source.silent_since.map(|since| since.set_by(by_ms));
        }
    }

    /// Forgets all readings, because the program begins anew. Only the operator's last reading is remembered.
    pub(crate) fn begin_anew(&mut self, now: Now) {
        let said = self.sources.remove(OPERATOR);
        (self.sources, self.last) = (BTreeMap::new(), None);
        if let Some(said) = said {
            self.remember(said.reading, now);
        }
    }

    /// Takes the operator's last reading from before the start of the program. Its age is unknown.
    pub(crate) fn remember(&mut self, said: Celsius, now: Now) {
        self.read(&Arc::from(OPERATOR), said, now);
        self.fall_silent(OPERATOR, now.wall);
    }

    /// Returns the time when the next robot's thermometer will count as silent, and the name of that source.
    pub(crate) fn due(&self) -> Option<(Duration, Arc<str>)> {
        let speaking = self.sources.iter().filter(|(name, source)| is_robot(name) && source.silent_since.is_none());
        speaking.map(|(name, source)| (source.read.since_start.saturating_add(SILENCE), Arc::clone(name))).min()
    }

    pub(crate) fn readings(&self) -> Vec<(Arc<str>, Celsius)> {
        let speaking = self.sources.iter().filter(|(name, source)| &***name != OPERATOR && source.silent_since.is_none());
        speaking.map(|(name, source)| (Arc::clone(name), source.reading)).collect()
    }

    /// Removes a source. If the source was hot, its last reading becomes the operator's reading, which only the
    /// operator can change. Returns whether the source was hot.
    pub(crate) fn retire(&mut self, source: &str) -> bool {
        let left = self.sources.remove(source).filter(|left| left.hot);
        left.is_some_and(|left| {
            self.sources.insert(Arc::from(OPERATOR), left);
            true
        })
    }

    pub(crate) fn is_hot(&self) -> bool {
        self.sources.values().any(|source| source.hot)
    }

    pub(crate) fn latest(&self) -> Option<SourceReading> {
        self.last.as_ref().map(|(_, last)| last.view())
    }

    pub(crate) fn view(&self, status: TemperatureStatus) -> TemperatureView {
        let hot = self.sources.iter().filter(|(_, source)| source.hot);
        let last = self.latest();
        TemperatureView {
            celsius: last.map(|last| last.celsius),
            read: last.and_then(|last| last.read),
            silent_since: last.and_then(|last| last.silent_since),
            status,
            threshold: self.threshold,
            cool: self.cool(),
            hot: hot.map(|(name, source)| (Arc::clone(name), source.view())).collect(),
        }
    }

    fn cool(&self) -> Celsius {
        Celsius::new(self.threshold.degrees() - self.hysteresis).unwrap_or(self.threshold)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct TemperatureView {
    /// The latest reading of the sources that are not silent. If all are silent, it is the latest reading of all
    /// sources. `None` before the first reading.
    pub celsius: Option<Celsius>,
    /// When the temperature was read, accurate to some seconds; `None` if that is unknown.
    pub read: Option<WallTime>,
    /// Since when the source of the reading is silent. The present temperature is then unknown. `None` if the source
    /// is not silent.
    pub silent_since: Option<WallTime>,
    pub status: TemperatureStatus,
    /// Temperature above which nothing moves.
    pub threshold: Celsius,
    /// A source that was above the threshold counts as cool again at this reading or below.
    pub cool: Celsius,
    /// The sources that make the hall too hot, each with its last reading.
    pub hot: Vec<(Arc<str>, SourceReading)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceReading {
    pub celsius: Celsius,
    /// When the source was read, accurate to some seconds; `None` if that is unknown.
    pub read: Option<WallTime>,
    pub silent_since: Option<WallTime>,
}

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum TemperatureStatus {
        Ok = "ok",
        /// Too hot, according to a reading or to the operator.
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

    fn at(second: u64) -> Now {
        let wall = WallTime { unix_ms: 1_000_000 + 1000 * i64::try_from(second).unwrap(), offset_s: 0 };
        Now { since_start: Duration::from_secs(second), wall }
    }

    fn thermometer() -> Thermometer {
        Thermometer::new(celsius(25.0), 1.0)
    }

    #[test]
    fn the_threshold_itself_is_not_too_hot() {
        let mut thermometer = thermometer();
        thermometer.read(&"hall".into(), celsius(25.0), at(0));
        assert!(!thermometer.is_hot());
        thermometer.read(&"hall".into(), celsius(25.1), at(0));
        assert!(thermometer.is_hot());
    }

    #[test]
    fn it_is_cool_again_only_one_degree_below() {
        let mut thermometer = thermometer();
        thermometer.read(&"hall".into(), celsius(26.0), at(0));
        thermometer.read(&"hall".into(), celsius(24.5), at(0));
        assert!(thermometer.is_hot());
        thermometer.read(&"hall".into(), celsius(24.0), at(0));
        assert!(!thermometer.is_hot());
    }

    #[test]
    fn every_source_must_permit() {
        let mut thermometer = thermometer();
        thermometer.read(&"operator".into(), celsius(30.0), at(0));
        thermometer.read(&"hall".into(), celsius(20.0), at(0));
        assert!(thermometer.is_hot(), "one cool source does not speak for a hot one");
        thermometer.read(&"operator".into(), celsius(20.0), at(0));
        assert!(!thermometer.is_hot());
    }

    #[test]
    fn what_a_source_said_that_is_gone_is_the_operators_to_take_back() {
        let mut thermometer = thermometer();
        thermometer.read(&"robot".into(), celsius(20.0), at(0));
        assert!(!thermometer.retire("robot") && !thermometer.is_hot(), "it was not hot");
        thermometer.read(&"operator".into(), celsius(20.0), at(0));
        thermometer.read(&"robot".into(), celsius(30.0), at(0));
        assert!(thermometer.retire("robot") && thermometer.is_hot(), "a thermometer that is taken away cools no hall");
        assert!(!thermometer.retire("robot") && thermometer.is_hot(), "it is said once");
        thermometer.read(&"operator".into(), celsius(20.0), at(0));
        assert!(!thermometer.is_hot());
    }

    #[test]
    fn what_a_silent_source_read_is_not_known_any_more_until_it_reads_again() {
        let mut thermometer = thermometer();
        let shown = |thermometer: &Thermometer| {
            let view = thermometer.view(TemperatureStatus::Ok);
            (view.celsius, view.read, view.silent_since)
        };
        let robot: Arc<str> = "robot".into();
        assert!(thermometer.read(&robot, celsius(21.5), at(0)));
        assert!(!thermometer.read(&robot, celsius(21.5), at(3)));
        assert_eq!(shown(&thermometer), (Some(celsius(21.5)), Some(at(0).wall), None), "shown anew only after a while");
        assert!(!thermometer.read(&robot, celsius(21.5), at(10)));
        assert_eq!(shown(&thermometer), (Some(celsius(21.5)), Some(at(10).wall), None));
        assert_eq!(thermometer.due(), Some((Duration::from_secs(40), Arc::clone(&robot))));
        assert!(
            thermometer.fall_silent("robot", at(40).wall) && !thermometer.fall_silent("robot", at(50).wall),
            "it is said once"
        );
        assert_eq!(shown(&thermometer), (Some(celsius(21.5)), Some(at(10).wall), Some(at(40).wall)));
        assert!(thermometer.due().is_none() && thermometer.readings().is_empty());
        assert!(thermometer.read(&robot, celsius(21.5), at(60)), "that it is known again is news");
        assert_eq!(shown(&thermometer), (Some(celsius(21.5)), Some(at(60).wall), None));
    }

    #[test]
    fn while_one_source_is_silent_the_latest_of_the_others_is_shown() {
        let mut thermometer = thermometer();
        thermometer.read(&"operator".into(), celsius(20.0), at(0));
        thermometer.read(&"robot".into(), celsius(21.5), at(1));
        assert!(thermometer.fall_silent("robot", at(2).wall));
        let view = thermometer.view(TemperatureStatus::Ok);
        assert_eq!((view.celsius, view.read, view.silent_since), (Some(celsius(20.0)), Some(at(0).wall), None));
        assert!(!thermometer.retire("robot"));
    }
}
