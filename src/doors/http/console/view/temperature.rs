//! The temperature in words: the reading, what keeps the hall too hot, and what ends that.

use std::borrow::Cow;
use std::sync::Arc;

use super::{View, capital};
use crate::phrases::{Markup, Phrase};
use hallsweep_core::command::OPERATOR;
use hallsweep_core::hold::Hold;
use hallsweep_core::units::{Celsius, WallTime};
use hallsweep_core::world::temperature::{SourceReading, TemperatureStatus, TemperatureView};

/// Age at which the bar shows that a reading is old: thermometers and sensors report at least every 10 s.
const OLD_MS: i64 = 15_000;

impl View<'_> {
    /// `21.5 °C`
    pub(in super::super) fn degrees(&self, celsius: &Celsius) -> String {
        self.language.celsius(*celsius)
    }

    /// The threshold, without its unit.
    pub(in super::super) fn threshold(&self) -> String {
        self.language.number(&self.snapshot.temperature.threshold.degrees().to_string())
    }

    /// The reading to show: the hottest of those that are too hot, or the last if none is.
    fn shown(&self) -> Option<SourceReading> {
        let TemperatureView { celsius, read, silent_since, .. } = self.snapshot.temperature;
        let hottest = self.hot().iter().map(|(_, last)| *last).max_by(|a, b| a.celsius.degrees().total_cmp(&b.celsius.degrees()));
        hottest.or_else(|| Some(SourceReading { celsius: celsius?, read, silent_since }))
    }

    /// The reading to show, or that there is none, or that none is valid any more.
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

    /// The CSS class of the temperature: an unknown temperature is not shown as a good one.
    pub(in super::super) fn temperature_class(&self) -> &'static str {
        let status = self.snapshot.temperature.status;
        let is_unknown = status == TemperatureStatus::Ok && self.is_silent();
        if is_unknown { TemperatureStatus::Stale } else { status }.name()
    }

    /// Age of the last reading, or since when it is not valid any more. In the past the age counts from the recorded entry,
    /// because a repeated equal reading is not recorded.
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

    /// The age for the bar, which shows it only for an old reading.
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

    /// Whether it is a reading, and not a button, that says the hall is not too hot.
    pub(in super::super) fn reads_ok(&self) -> bool {
        let TemperatureView { celsius, status, silent_since, .. } = &self.snapshot.temperature;
        *status == TemperatureStatus::Ok && celsius.is_some() && silent_since.is_none()
    }

    pub(super) fn source<'s>(&self, source: &'s str) -> Cow<'s, str> {
        if source == OPERATOR { self.say("role-operator").to_string().into() } else { source.into() }
    }
}
