//! The temperature in words: the reading, what makes the hall too hot, and what ends that state.

use std::borrow::Cow;
use std::sync::Arc;

use super::{View, capital};
use crate::phrases::{Markup, Phrase};
use hallsweep_core::command::OPERATOR;
use hallsweep_core::hold::Hold;
use hallsweep_core::units::{Celsius, WallTime};
use hallsweep_core::world::temperature::{SourceReading, TemperatureStatus, TemperatureView};

/// Age from which the status bar shows how old a reading is. Thermometers and sensors report at least every 10 s.
const OLD_MS: i64 = 15_000;

impl View<'_> {
    /// Returns a temperature as text, such as `21.5 °C`.
    pub(in super::super) fn degrees(&self, celsius: &Celsius) -> String {
        self.language.celsius(*celsius)
    }

    /// Returns the threshold as text, without its unit.
    pub(in super::super) fn threshold(&self) -> String {
        self.language.number(&self.snapshot.temperature.threshold.degrees().to_string())
    }

    /// Returns the reading to show: the hottest of the readings that are too hot. If no reading is too hot, returns
    /// the last reading.
    fn shown(&self) -> Option<SourceReading> {
        let TemperatureView { celsius, read, silent_since, .. } = self.snapshot.temperature;
        let hottest = self.hot().iter().map(|(_, last)| *last).max_by(|a, b| a.celsius.degrees().total_cmp(&b.celsius.degrees()));
        hottest.or_else(|| Some(SourceReading { celsius: celsius?, read, silent_since }))
    }

    /// Returns the reading to show as text. The text says so if there is no reading, or if the reading is not valid
    /// any more.
    pub(in super::super) fn celsius(&self) -> String {
        match self.shown() {
            Some(SourceReading { celsius, silent_since: None, .. }) => self.degrees(&celsius),
            Some(_) => self.say("not-known").to_string(),
            None => self.say("temperature-no-reading").to_string(),
        }
    }

    fn is_silent(&self) -> bool {
        self.shown().is_some_and(|shown| shown.silent_since.is_some())
    }

    /// Returns the CSS class of the temperature. An unknown temperature does not get the class of a good one.
    pub(in super::super) fn temperature_class(&self) -> &'static str {
        let status = self.snapshot.temperature.status;
        let is_unknown = status == TemperatureStatus::Ok && self.is_silent();
        if is_unknown { TemperatureStatus::Stale } else { status }.name()
    }

    /// Returns the age of the last reading, or since when that reading is not valid any more. A page about the past
    /// shows the time of the recorded entry instead, because a repeated equal reading is not recorded.
    pub(in super::super) fn reading_age(&self, old_ms: i64) -> Option<Markup> {
        let SourceReading { celsius, read, silent_since } = self.shown()?;
        let time = |wall: &WallTime| self.zone().clock_time(*wall);
        Some(match (silent_since, read, self.then) {
            (Some(_), _, Some(_)) => self.say("reading-lost-then").with("last", self.degrees(&celsius)).markup(),
            (Some(since), _, None) => self.unknown_since(since, self.degrees(&celsius)).markup(),
            (None, read, Some(_)) => self.say("reading-on-record").with("time", time(&read?)).markup(),
            (None, read, None) => {
                let read = read?;
                let said = self.say("reading-age").with("since", read.unix_ms).with("old", old_ms);
                said.with("time", self.gone(&read)).markup()
            }
        })
    }

    /// Returns the age of the reading for the status bar, which shows the age only of an old reading.
    pub(in super::super) fn old_age(&self) -> Option<Markup> {
        self.reading_age(OLD_MS).filter(|_| !self.is_silent() && self.then.is_none())
    }

    pub(in super::super) fn is_old(&self) -> bool {
        self.shown().and_then(|shown| shown.read).is_some_and(|read| self.now.unix_ms.saturating_sub(read.unix_ms) >= OLD_MS)
    }

    pub(in super::super) fn temperature_words(&self) -> Phrase<'static> {
        self.say(match self.snapshot.temperature.status {
            TemperatureStatus::Ok if self.snapshot.temperature.celsius.is_none() => "temperature-unread",
            TemperatureStatus::Ok if self.is_silent() => "temperature-unheard",
            TemperatureStatus::Ok => "temperature-ok",
            TemperatureStatus::TooHigh if self.declared_too_high() => "temperature-declared",
            TemperatureStatus::TooHigh => "temperature-high",
            TemperatureStatus::Stale => "temperature-stale",
        })
    }

    pub(in super::super) fn heat(&self) -> Vec<String> {
        let cool = self.snapshot.temperature.cool;
        let words = |source: &str, last: &SourceReading| {
            let said = match source {
                OPERATOR => self.say("temperature-reported"),
                sensor if last.silent_since.is_some() => self.say("temperature-sensor-silent").with("source", capital(sensor)),
                sensor => self.say("temperature-sensor").with("source", capital(sensor)),
            };
            said.with("reading", self.degrees(&last.celsius)).with("cool", self.degrees(&cool)).to_string()
        };
        self.hot().iter().map(|(source, last)| words(source, last)).collect()
    }

    pub(super) fn hot(&self) -> &[(Arc<str>, SourceReading)] {
        &self.snapshot.temperature.hot
    }

    pub(in super::super) fn declared_too_high(&self) -> bool {
        self.snapshot.mission.holds.contains(&Hold::TooHigh)
    }

    /// Whether a valid reading shows that the hall is not too hot. An OK by the operator is not enough.
    pub(in super::super) fn reads_ok(&self) -> bool {
        let TemperatureView { celsius, status, silent_since, .. } = &self.snapshot.temperature;
        *status == TemperatureStatus::Ok && celsius.is_some() && silent_since.is_none()
    }

    pub(super) fn source<'s>(&self, source: &'s str) -> Cow<'s, str> {
        if source == OPERATOR { self.say("role-operator").to_string().into() } else { source.into() }
    }
}
