//! A setting as it was given in one place: its name, its value and its origin. `layers` merges the settings of all places.

use figment::value::{Dict, Value};
use serde::Deserialize;

use super::environment::{self, PREFIX};
use super::error::SettingsError;
use super::key::{KEYS, Key, ROBOT, ROBOTS, SettingKind, of_a_hall};
use hallsweep_core::hall::HallId;
use hallsweep_core::robot::RobotId;

/// The lowest layer, which has every setting.
pub const DEFAULTS: &str = include_str!("../../config/default.toml");

const BY_DEFAULT: &str = "config/default.toml";

/// The layers, from the lowest to the highest. A value in a higher layer replaces a value in a lower layer. Two
/// values for one setting in the same layer are refused.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    Defaults,
    File,
    Environment,
    Flags,
}

/// A setting as it was given in one place. An empty section counts as a setting too, because it can name a hall or a
/// robot.
pub(super) struct Given {
    pub(super) place: Place,
    pub(super) origin: String,
    /// The full name as written, such as `halls.south.robots.discovery.seed`.
    pub(super) written: String,
    /// The hall, if the setting is in `[halls.NAME]`.
    pub(super) hall: Option<HallId>,
    /// The name that the program uses for it within the settings of a hall, such as `robot.seed`.
    pub(super) key: String,
    pub(super) value: Value,
}

impl Given {
    pub(super) fn new(place: Place, origin: String, written: String, value: Value) -> Given {
        let (hall, own) = of_a_hall(&written).map_or((None, written.as_str()), |(hall, own)| (Some(hall), own));
        let key = by_name(own).map_or_else(|| own.to_owned(), |own| format!("{ROBOT}{own}"));
        Given { place, origin, hall, key, value, written }
    }

    /// The lowest layer.
    pub(super) fn defaults() -> Vec<Given> {
        let values: Dict = toml::from_str(DEFAULTS).expect("config/default.toml is part of the program and a test reads it");
        let values = Value::from(values);
        let default = |key: &Key| {
            let value = values.find_ref(key.name).expect("a test compares config/default.toml with the table of settings");
            Given::new(Place::Defaults, BY_DEFAULT.to_owned(), key.name.to_owned(), value.clone())
        };
        KEYS.iter().map(default).collect()
    }

    pub(super) fn variable(name: &str, value: &str) -> Result<Option<Given>, SettingsError> {
        let origin = format!("environment variable {name}");
        if let Some(meant) = environment::nearly(name) {
            let advice = format!(
                "the variable for {} is {}, with two underscores before each part",
                meant.name,
                environment::variable(meant)
            );
            return Err(SettingsError::Unknown { key: name.to_owned(), origin, advice });
        }
        let Some(key) = name.strip_prefix(PREFIX) else { return Ok(None) };
        Given::text(Place::Environment, origin, key.to_lowercase().replace("__", "."), value).map(Some)
    }

    pub(super) fn text(place: Place, origin: String, key: String, value: &str) -> Result<Given, SettingsError> {
        let Some(setting) = Key::named(&key) else {
            return Err(SettingsError::Unknown { advice: Key::advice_for_unknown(&key), key, origin });
        };
        let value = if setting.kind == SettingKind::Text { Value::from(value) } else { meant(value) };
        Ok(Given::new(place, origin, key, value))
    }

    pub(super) fn wrong(&self, problem: String, advice: &str) -> SettingsError {
        SettingsError::Wrong {
            key: self.written.clone(),
            value: written(&self.value),
            origin: self.origin.clone(),
            problem,
            advice: advice.to_owned(),
        }
    }

    /// Whether it is a setting of the searching robot, written with the robot's name.
    pub(super) fn is_by_name(&self) -> bool {
        by_name(of_a_hall(&self.written).map_or(self.written.as_str(), |(_, own)| own)).is_some()
    }
}

/// The end of the name of a setting in `[robots.discovery]`, such as `.seed`; empty for the section itself.
fn by_name(own: &str) -> Option<&str> {
    let rest = own.strip_prefix(ROBOTS)?.strip_prefix('.')?.strip_prefix(RobotId::discovery().name())?;
    (rest.is_empty() || rest.starts_with('.')).then_some(rest)
}

/// The value that `text` has in a settings file, such as `true` or `1.5`; anything else is a string.
fn meant(text: &str) -> Value {
    let parsed = toml::de::ValueDeserializer::parse(text).and_then(<Value as Deserialize>::deserialize);
    parsed.unwrap_or_else(|_| Value::from(text))
}

/// A value on one line, as written in a settings file.
pub(super) fn written(value: &Value) -> String {
    match value.to_num().and_then(|number| number.to_f64()).filter(|number| !number.is_finite()) {
        // TOML has words for infinity and not-a-number, JSON has none.
        Some(number) => number.to_string().to_lowercase(),
        None => serde_json::to_string(value).unwrap_or_else(|_| "something that cannot be shown".to_owned()),
    }
}
