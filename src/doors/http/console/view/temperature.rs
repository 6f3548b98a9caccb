//! The temperature in words: what was read, what keeps the hall too hot, and what ends it.

use std::borrow::Cow;
use std::sync::Arc;

use super::{View, capital};
use crate::phrases::{Markup, Phrase};
use hallsweep_core::command::OPERATOR;
use hallsweep_core::hold::Hold;
use hallsweep_core::units::{Celsius, WallTime};
use hallsweep_core::world::temperature::{SourceReading, TemperatureStatus, TemperatureView};

/// A reading is said to be old on the bar after this: thermometers and sensors read every 10 s, if not more often.
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

    /// The reading that matters: the hottest of those that are too hot, else the last.
    fn shown(&self) -> Option<SourceReading> {
        let TemperatureView { celsius, read, silent_since, .. } = self.snapshot.temperature;
        let hottest = self.hot().iter().map(|(_, last)| *last).max_by(|a, b| a.celsius.degrees().total_cmp(&b.celsius.degrees()));
        hottest.or_else(|| Some(SourceReading { celsius: celsius?, read, silent_since }))
    }

    /// The reading that matters; or that there is none, or none that is true still.
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

    /// How it looks: what nobody knows does not look well.
    pub(in super::super) fn temperature_class(&self) -> &'static str {
        let status = self.snapshot.temperature.status;
        let is_unknown = status == TemperatureStatus::Ok && self.is_silent();
        if is_unknown { TemperatureStatus::Stale } else { status }.name()
    }

    /// How old the last reading is, or since when it is true no more. In the past it is when it went on record: one that says the same
    /// again does not.
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

    /// The same for the bar, where it is said once it is old.
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

    /// Every reading that keeps the hall too hot, and what ends it.
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

    /// Whether a reading, and no button, says that it is not too hot.
    pub(in super::super) fn reads_ok(&self) -> bool {
        let TemperatureView { celsius, status, silent_since, .. } = &self.snapshot.temperature;
        *status == TemperatureStatus::Ok && celsius.is_some() && silent_since.is_none()
    }

    /// Where a reading comes from.
    pub(super) fn source<'s>(&self, source: &'s str) -> Cow<'s, str> {
        if source == OPERATOR { self.say("role-operator").to_string().into() } else { source.into() }
    }
}
