//! The temperature in words: what was read, what keeps the hall too hot, and what ends it.

use std::borrow::Cow;
use std::sync::Arc;

use super::{View, capital};
use crate::phrases::Phrase;
use hallsweep_core::mission::Hold;
use hallsweep_core::units::Celsius;
use hallsweep_core::world::temperature::{OPERATOR, TemperatureStatus};

impl View<'_> {
    /// `21.5 °C`
    pub(in super::super) fn degrees(&self, celsius: &Celsius) -> String {
        self.language.celsius(*celsius)
    }

    /// The threshold, without its unit.
    pub(in super::super) fn threshold(&self) -> String {
        self.language.number(&self.snapshot.temperature.threshold.degrees().to_string())
    }

    /// The reading that matters: the hottest of those that are too hot, else the last; or that there is none.
    pub(in super::super) fn celsius(&self) -> String {
        let hottest = self.hot().iter().map(|(_, reading)| *reading).max_by(|a, b| a.degrees().total_cmp(&b.degrees()));
        let shown = hottest.or(self.snapshot.temperature.celsius);
        shown.map_or_else(|| self.say("temperature-no-reading").to_string(), |celsius| self.degrees(&celsius))
    }

    pub(in super::super) fn temperature_words(&self) -> Phrase<'static> {
        self.say(match self.snapshot.temperature.status {
            TemperatureStatus::Ok if self.snapshot.temperature.celsius.is_none() => "temperature-unread",
            TemperatureStatus::Ok => "temperature-ok",
            TemperatureStatus::TooHigh if self.declared_too_high() => "temperature-declared",
            TemperatureStatus::TooHigh => "temperature-high",
            TemperatureStatus::Stale => "temperature-stale",
        })
    }

    /// Every reading that keeps the hall too hot, and what ends it.
    pub(in super::super) fn heat(&self) -> Vec<String> {
        let cool = self.snapshot.temperature.cool;
        let words = |source: &str, reading: Celsius| {
            let said = match source {
                OPERATOR => self.say("temperature-reported"),
                sensor => self.say("temperature-sensor").with("source", capital(sensor)),
            };
            said.with("reading", self.degrees(&reading)).with("cool", self.degrees(&cool)).to_string()
        };
        self.hot().iter().map(|(source, reading)| words(source, *reading)).collect()
    }

    pub(super) fn hot(&self) -> &[(Arc<str>, Celsius)] {
        &self.snapshot.temperature.hot
    }

    pub(in super::super) fn declared_too_high(&self) -> bool {
        self.snapshot.mission.holds.contains(&Hold::TooHigh)
    }

    /// Whether a reading, and no button, says that it is not too hot.
    pub(in super::super) fn reads_ok(&self) -> bool {
        self.snapshot.temperature.status == TemperatureStatus::Ok && self.snapshot.temperature.celsius.is_some()
    }

    /// Where a reading comes from.
    pub(super) fn source<'s>(&self, source: &'s str) -> Cow<'s, str> {
        if source == OPERATOR { self.say("role-operator").to_string().into() } else { source.into() }
    }
}
