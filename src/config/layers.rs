//! The layers of settings, laid over one another, each value remembering where it came from.
//! Whether a value is usable is decided in `check`.
//!
//! ```text
//!   flags                    --speed max
//!   environment              HALLSWEEP__ROBOT__SPEED=max
//!   the file of --config     [robot] speed = "max"
//!   config/default.toml      [robot] speed = 1            always complete
//! ```

use std::path::{Path, PathBuf};

use figment::value::{Dict, Map, Value};
use figment::{Figment, Metadata, Profile, Provider};
use serde::Deserialize;

use super::environment::{self, PREFIX};
use super::error::SettingsError;
use super::key::{Key, Kind};

/// The bottom layer, which names every setting.
pub const DEFAULTS: &str = include_str!("../../config/default.toml");

/// Where the values come from that nobody has set.
const BY_DEFAULT: &str = "config/default.toml";

/// Where settings are read from.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// A settings file.
    pub file: Option<PathBuf>,
    /// Names and values of environment variables.
    pub environment: Vec<(String, String)>,
    /// Flags of the command line.
    pub flags: Vec<Flag>,
}

/// A setting given on the command line.
#[derive(Clone, Debug)]
pub struct Flag {
    /// The flag, as `--http`.
    pub flag: &'static str,
    /// The setting it means.
    pub key: &'static str,
    /// What was given.
    pub value: String,
}

impl Flag {
    /// This flag with this value; the table says which setting it means.
    #[must_use]
    pub(crate) fn given(flag: &'static str, value: String) -> Flag {
        let key = Key::of_flag(flag)
            .expect("every flag that is given to a setting stands in the table, as a test of each command says");
        Flag { flag, key: key.name, value }
    }
}

/// All layers, the upper ones laid over the lower.
pub(super) struct Layers(Figment);

/// Some settings from one place.
struct Layer {
    origin: String,
    values: Dict,
}

impl Layers {
    /// Reads all layers.
    ///
    /// # Errors
    /// A file that cannot be read, or a name that is no setting.
    pub(super) fn gather(sources: &Sources) -> Result<Layers, SettingsError> {
        let mut layers = vec![Layer::defaults()];
        layers.extend(sources.file.as_deref().map(Layer::file).transpose()?);
        for (name, value) in &sources.environment {
            layers.extend(Layer::variable(name, value)?);
        }
        for Flag { flag, key, value } in &sources.flags {
            layers.push(Layer::single(format!("flag {flag}"), key, value)?);
        }
        layers.iter().try_for_each(Layer::check_names)?;
        Ok(Layers(layers.into_iter().fold(Figment::new(), Figment::merge)))
    }

    /// The values, merged.
    pub(super) fn figment(&self) -> &Figment {
        &self.0
    }

    /// Says what is wrong with the value of a setting.
    pub(super) fn wrong(&self, key: &str, problem: impl Into<String>) -> SettingsError {
        let advice = Key::named(key).map_or("see config/default.toml", |key| key.advice);
        self.wrong_with_advice(key, problem, advice)
    }

    /// The same, with advice of its own.
    pub(super) fn wrong_with_advice(&self, key: &str, problem: impl Into<String>, advice: &str) -> SettingsError {
        SettingsError::Wrong {
            key: key.to_owned(),
            value: self.0.find_value(key).map_or_else(|_| "nothing".to_owned(), |value| written(&value)),
            origin: self.origin(key),
            problem: problem.into(),
            advice: advice.to_owned(),
        }
    }

    /// The same for a value that may hold a password: it is not repeated.
    pub(super) fn wrong_unseen(&self, key: &str, problem: impl Into<String>) -> SettingsError {
        let mut error = self.wrong(key, problem);
        if let SettingsError::Wrong { value, .. } = &mut error {
            *value = "(not shown)".to_owned();
        }
        error
    }

    /// Whether somebody has set it; otherwise it is as it is by default.
    pub(super) fn is_chosen(&self, key: &str) -> bool {
        self.origin(key) != BY_DEFAULT
    }

    /// Where the value of a setting comes from.
    pub(super) fn origin(&self, key: &str) -> String {
        self.0.find_metadata(key).map_or("an unknown place", |metadata| metadata.name.as_ref()).to_owned()
    }
}

/// A value as it would be written in a settings file, in one line.
fn written(value: &Value) -> String {
    match value.to_num().and_then(|number| number.to_f64()).filter(|number| !number.is_finite()) {
        // JSON has no words for these, TOML has.
        Some(number) => number.to_string().to_lowercase(),
        None => serde_json::to_string(value).unwrap_or_else(|_| "something that cannot be shown".to_owned()),
    }
}

impl Layer {
    fn defaults() -> Layer {
        let values = toml::from_str(DEFAULTS).expect("config/default.toml is part of the program and a test reads it");
        Layer { origin: BY_DEFAULT.to_owned(), values }
    }

    fn file(path: &Path) -> Result<Layer, SettingsError> {
        let wrong = |problem: String| SettingsError::File { path: path.to_owned(), problem };
        let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
        let values = toml::from_str(&text).map_err(|error| wrong(error.to_string().trim_end().to_owned()))?;
        Ok(Layer { origin: format!("file {}", path.display()), values })
    }

    /// The setting in an environment variable, if it is one.
    fn variable(name: &str, value: &str) -> Result<Option<Layer>, SettingsError> {
        let origin = format!("environment variable {name}");
        if let Some(meant) = environment::nearly(name) {
            let advice =
                format!("the variable for {} is {}, with two underscores each", meant.name, environment::variable(meant));
            return Err(SettingsError::Unknown { key: name.to_owned(), origin, advice });
        }
        let Some(key) = name.strip_prefix(PREFIX) else { return Ok(None) };
        Layer::single(origin, &key.to_lowercase().replace("__", "."), value).map(Some)
    }

    fn single(origin: String, key: &str, value: &str) -> Result<Layer, SettingsError> {
        let Some(setting) = Key::named(key) else {
            return Err(SettingsError::Unknown { key: key.to_owned(), origin, advice: Key::advice_for_unknown(key) });
        };
        let value = if setting.kind == Kind::Text { Value::from(value) } else { meant(value) };
        let (section, name) = key.split_once('.').expect("every setting's name has a section");
        let values = Dict::from([(section.to_owned(), Value::from(Dict::from([(name.to_owned(), value)])))]);
        Ok(Layer { origin, values })
    }

    /// Refuses names that are no settings.
    fn check_names(&self) -> Result<(), SettingsError> {
        let unknown =
            |key: String| SettingsError::Unknown { advice: Key::advice_for_unknown(&key), key, origin: self.origin.clone() };
        for (section, value) in &self.values {
            let Some(names) = value.as_dict().filter(|_| Key::sections().contains(&section.as_str())) else {
                return Err(unknown(section.clone()));
            };
            let full = names.keys().map(|name| format!("{section}.{name}"));
            if let Some(key) = full.into_iter().find(|key| Key::named(key).is_none()) {
                return Err(unknown(key));
            }
        }
        Ok(())
    }
}

/// What `text` means in a settings file, as `true` and `1.5`; anything else is a word.
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
