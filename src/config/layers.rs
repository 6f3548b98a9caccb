//! Merges the layers of settings, and remembers the origin of each value. `check` decides whether a value is usable.
//!
//! ```text
//!   flags                    --speed max
//!   environment              HALLSWEEP__ROBOT__SPEED=max
//!   the file of --config     [robot] speed = "max"
//!   config/default.toml      [robot] speed = 1            always complete
//! ```
//! `[robots.discovery]` is another name of `[robot]`, and is renamed to `[robot]` first. Every other `[robots.NAME]` is a
//! further robot, merged with the defaults of `[robot]`.

use std::collections::BTreeMap;
use std::path::Path;

use figment::util::nest;
use figment::value::{Dict, Map, Value};
use figment::{Figment, Metadata, Profile, Provider};
use serde::Deserialize;

use super::environment::{self, Flag, PREFIX, Sources};
use super::error::SettingsError;
use super::key::{Key, ROBOT, ROBOTS, SettingKind};
use hallsweep_core::robot::RobotId;

/// The lowest layer, which has every setting.
pub const DEFAULTS: &str = include_str!("../../config/default.toml");

const BY_DEFAULT: &str = "config/default.toml";

impl Flag {
    pub(crate) fn given(flag: &'static str, value: String) -> Flag {
        let key = Key::of_flag(flag).expect("every flag of a setting is in the table, as a test of each command shows");
        Flag { flag, key: key.name, value }
    }

    /// The two settings that `--robot KIND[=ADDRESS]` sets. Without an address, the default address of this kind is
    /// used, even if a settings file has another one.
    pub(crate) fn robot(value: &str) -> [Flag; 2] {
        let (kind, address) = value.split_once('=').unwrap_or((value, ""));
        [("robot.kind", kind), ("robot.address", address)].map(|(key, value)| Flag {
            flag: "--robot",
            key,
            value: value.to_owned(),
        })
    }
}

pub(super) struct Layers {
    merged: Figment,
    further: BTreeMap<String, String>,
    /// Settings of the searching robot that were given as `[robots.discovery]`: for each, its origin, and the setting
    /// of `[robot]` that it means.
    by_name: Vec<(String, String)>,
}

struct Layer {
    place: LayerSource,
    origin: String,
    values: Dict,
}

/// The layers, from the lowest to the highest. A value in a higher layer replaces a value in a lower layer. Two
/// values for one setting in the same layer are refused.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LayerSource {
    Defaults,
    File,
    Environment,
    Flags,
}

impl Layers {
    pub(super) fn gather(sources: &Sources) -> Result<Layers, SettingsError> {
        let mut layers = vec![Layer::defaults()];
        layers.extend(sources.file.as_deref().map(Layer::file).transpose()?);
        for (name, value) in &sources.environment {
            layers.extend(Layer::variable(name, value)?);
        }
        for Flag { flag, key, value } in &sources.flags {
            layers.push(Layer::single(LayerSource::Flags, format!("flag {flag}"), key, value)?);
        }
        layers.iter().try_for_each(Layer::check_names)?;
        check_said_once(&layers)?;
        let by_name = layers.iter_mut().flat_map(Layer::bring_to_robot).collect();
        let mut further = BTreeMap::new();
        for layer in &layers {
            for (name, _) in layer.robots() {
                further.entry(name.clone()).or_insert_with(|| layer.origin.clone());
            }
        }
        let beneath: Vec<Layer> = further.keys().map(|name| Layer::beneath(name)).collect();
        let merged = beneath.into_iter().chain(layers).fold(Figment::new(), Figment::merge);
        Ok(Layers { merged, further, by_name })
    }

    pub(super) fn further_robots(&self) -> impl ExactSizeIterator<Item = &str> {
        self.further.keys().map(String::as_str)
    }

    pub(super) fn figment(&self) -> &Figment {
        &self.merged
    }

    pub(super) fn wrong(&self, key: &str, problem: impl Into<String>) -> SettingsError {
        let advice = Key::named(key).map_or("see config/default.toml", |key| key.advice);
        self.wrong_with_advice(key, problem, advice)
    }

    pub(super) fn wrong_with_advice(&self, key: &str, problem: impl Into<String>, advice: &str) -> SettingsError {
        SettingsError::Wrong {
            key: self.as_written(key),
            value: self.merged.find_value(key).map_or_else(|_| "nothing".to_owned(), |value| written(&value)),
            origin: self.origin(key),
            problem: problem.into(),
            advice: advice.to_owned(),
        }
    }

    /// Like `wrong`, but does not show the value, because it may contain a password.
    pub(super) fn wrong_unseen(&self, key: &str, problem: impl Into<String>) -> SettingsError {
        let mut error = self.wrong(key, problem);
        if let SettingsError::Wrong { value, .. } = &mut error {
            *value = "(not shown)".to_owned();
        }
        error
    }

    pub(super) fn is_chosen(&self, key: &str) -> bool {
        self.origin(key) != BY_DEFAULT
    }

    pub(super) fn origin(&self, key: &str) -> String {
        let of_its_robot = || self.further.get(key.strip_prefix(ROBOTS)?.strip_prefix('.')?.split('.').next()?).cloned();
        let found = self.merged.find_metadata(key).map(|metadata| metadata.name.to_string());
        found.or_else(of_its_robot).unwrap_or_else(|| "an unknown place".to_owned())
    }

    /// The origin of a setting in words: a flag, an environment variable, or a setting in a file. Only for a file the
    /// name of the setting is added.
    pub(super) fn as_given(&self, key: &str) -> String {
        let origin = self.origin(key);
        if origin.starts_with("file ") { format!("{} in {origin}", self.as_written(key)) } else { origin }
    }

    fn as_written(&self, key: &str) -> String {
        let by_name = self.by_name.iter().any(|(origin, meant)| meant == key && *origin == self.origin(key));
        match key.split_once('.').filter(|_| by_name) {
            Some((_, own)) => format!("{ROBOTS}.{}.{own}", RobotId::discovery()),
            None => key.to_owned(),
        }
    }
}

/// Refuses a setting of the searching robot that one layer has twice: in `[robot]` and in `[robots.discovery]`.
fn check_said_once(layers: &[Layer]) -> Result<(), SettingsError> {
    for layer in layers {
        for (own, value) in layer.discovery().into_iter().flatten() {
            let twice = layers.iter().find(|other| {
                let of_robot = other.values.get(ROBOT).and_then(Value::as_dict);
                other.place == layer.place && of_robot.is_some_and(|names| names.contains_key(own))
            });
            if let Some(other) = twice {
                return Err(SettingsError::Wrong {
                    key: format!("{ROBOTS}.{}.{own}", RobotId::discovery()),
                    value: written(value),
                    origin: layer.origin.clone(),
                    problem: format!("{ROBOT}.{own} means the same setting, and is set too (from {})", other.origin),
                    advice: "set only one of the two".to_owned(),
                });
            }
        }
    }
    Ok(())
}

/// A value on one line, as written in a settings file.
fn written(value: &Value) -> String {
    match value.to_num().and_then(|number| number.to_f64()).filter(|number| !number.is_finite()) {
        // TOML has words for infinity and not-a-number, JSON has none.
        Some(number) => number.to_string().to_lowercase(),
        None => serde_json::to_string(value).unwrap_or_else(|_| "something that cannot be shown".to_owned()),
    }
}

impl Layer {
    fn defaults() -> Layer {
        let values = toml::from_str(DEFAULTS).expect("config/default.toml is part of the program and a test reads it");
        Layer { place: LayerSource::Defaults, origin: BY_DEFAULT.to_owned(), values }
    }

    /// Defaults of a further robot. They have no kind: the user must give it, so that a mistyped name does not create
    /// a robot.
    fn beneath(robot: &str) -> Layer {
        let Layer { place, origin, mut values } = Layer::defaults();
        let mut like = values.remove(ROBOT).and_then(Value::into_dict).unwrap_or_default();
        like.remove("kind");
        let values = Dict::from([(ROBOTS.to_owned(), nest(robot, Value::from(like)))]);
        Layer { place, origin, values }
    }

    fn file(path: &Path) -> Result<Layer, SettingsError> {
        let wrong = |problem: String| SettingsError::File { path: path.to_owned(), problem };
        let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
        let values = toml::from_str(&text).map_err(|error| wrong(error.to_string().trim_end().to_owned()))?;
        Ok(Layer { place: LayerSource::File, origin: format!("file {}", path.display()), values })
    }

    fn variable(name: &str, value: &str) -> Result<Option<Layer>, SettingsError> {
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
        Layer::single(LayerSource::Environment, origin, &key.to_lowercase().replace("__", "."), value).map(Some)
    }

    fn single(place: LayerSource, origin: String, key: &str, value: &str) -> Result<Layer, SettingsError> {
        let Some(setting) = Key::named(key) else {
            return Err(SettingsError::Unknown { key: key.to_owned(), origin, advice: Key::advice_for_unknown(key) });
        };
        let value = if setting.kind == SettingKind::Text { Value::from(value) } else { meant(value) };
        let values = nest(key, value).into_dict().expect("every setting's name has a section");
        Ok(Layer { place, origin, values })
    }

    fn robots(&self) -> impl Iterator<Item = (&String, &Value)> {
        self.values.get(ROBOTS).and_then(Value::as_dict).into_iter().flatten()
    }

    fn discovery(&self) -> Option<&Dict> {
        self.robots().find(|(name, _)| *name == RobotId::discovery().name()).and_then(|(_, said)| said.as_dict())
    }

    /// Moves the settings in `[robots.discovery]` to `[robot]`; returns the origin and the new name of each.
    fn bring_to_robot(&mut self) -> Vec<(String, String)> {
        let Some(Value::Dict(_, robots)) = self.values.get_mut(ROBOTS) else { return Vec::new() };
        let Some(said) = robots.remove(RobotId::discovery().name()).and_then(Value::into_dict) else { return Vec::new() };
        let by_name = said.keys().map(|own| (self.origin.clone(), format!("{ROBOT}.{own}"))).collect();
        if let Value::Dict(_, robot) = self.values.entry(ROBOT.to_owned()).or_insert_with(|| Value::from(Dict::new())) {
            robot.extend(said);
        }
        by_name
    }

    fn check_names(&self) -> Result<(), SettingsError> {
        let unknown =
            |key: String| SettingsError::Unknown { advice: Key::advice_for_unknown(&key), key, origin: self.origin.clone() };
        for (section, value) in &self.values {
            let Some(names) = value.as_dict().filter(|_| Key::sections().contains(&section.as_str())) else {
                return Err(unknown(section.clone()));
            };
            let mut full: Vec<String> = names.keys().map(|name| format!("{section}.{name}")).collect();
            if section == ROBOTS {
                full.clear();
                for (name, said) in names {
                    let known = said.as_dict().filter(|_| RobotId::new(name).is_some());
                    let Some(own) = known else { return Err(unknown(format!("{section}.{name}"))) };
                    full.extend(own.keys().map(|own| format!("{section}.{name}.{own}")));
                }
            }
            if let Some(key) = full.into_iter().find(|key| Key::named(key).is_none()) {
                return Err(unknown(key));
            }
        }
        Ok(())
    }
}

/// The value that `text` has in a settings file, such as `true` or `1.5`; anything else is a string.
fn meant(text: &str) -> Value {
    let parsed = toml::de::ValueDeserializer::parse(text).and_then(<Value as Deserialize>::deserialize);
    parsed.unwrap_or_else(|_| Value::from(text))
}

impl Provider for Layer {
    fn metadata(&self) -> Metadata {
        Metadata::named(self.origin.clone())
    }

    fn data(&self) -> Result<Map<Profile, Dict>, figment::Error> {
        Ok(Profile::Default.collect(self.values.clone()))
    }
}
