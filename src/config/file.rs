//! Reads the text of a settings file into its settings, each with its line. Refuses names that no setting has.

use std::path::Path;

use figment::value::Value;
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

use super::error::SettingsError;
use super::given::{Given, Place};
use super::key::Key;

/// A settings file that is being read.
struct File<'a> {
    path: &'a Path,
    text: &'a str,
    /// Positions of the line breaks, in bytes, so that a long file is searched only once for them.
    breaks: Vec<usize>,
    read: Vec<Given>,
}

pub(super) fn read(path: &Path) -> Result<Vec<Given>, SettingsError> {
    let text = std::fs::read_to_string(path).map_err(|error| wrong(path, &error.to_string()))?;
    let table = DeTable::parse(&text).map_err(|error| wrong(path, &error.to_string()))?;
    let breaks = text.match_indices('\n').map(|(at, _)| at).collect();
    let mut file = File { path, text: &text, breaks, read: Vec::new() };
    file.walk("", table.get_ref())?;
    Ok(file.read)
}

fn wrong(path: &Path, problem: &str) -> SettingsError {
    SettingsError::File { path: path.to_owned(), problem: problem.trim_end().to_owned() }
}

impl File<'_> {
    /// Reads the settings of a table. Their names begin with `section`, which is empty or ends with a dot.
    fn walk(&mut self, section: &str, table: &DeTable<'_>) -> Result<(), SettingsError> {
        for (name, value) in table {
            let line = self.breaks.partition_point(|at| *at < name.span().start) + 1;
            let origin = format!("file {}, line {line}", self.path.display());
            let name = name.get_ref();
            // A name with a dot of its own, such as "robot.seed" between quotes, stays between quotes, so no setting has it.
            let is_plain = !name.is_empty() && !name.contains('.');
            let key = if is_plain { format!("{section}{name}") } else { format!("{section}{name:?}") };
            let inner = value.get_ref().as_table();
            let is_empty = inner.is_some_and(DeTable::is_empty);
            if let Some(inner) = inner.filter(|_| !is_empty && (Key::is_section(&key) || Key::is_misplaced(&key))) {
                self.walk(&format!("{key}."), inner)?;
            } else if Key::named(&key).is_some() || is_empty && Key::is_section(&key) {
                self.read.push(Given::new(Place::File, origin, key, self.value(value)?));
            } else {
                return Err(SettingsError::Unknown { advice: Key::advice_for_unknown(&key), key, origin });
            }
        }
        Ok(())
    }

    fn value(&self, value: &Spanned<DeValue<'_>>) -> Result<Value, SettingsError> {
        <Value as Deserialize>::deserialize(ValueDeserializer::from(value.clone())).map_err(|mut error| {
            error.set_input(Some(self.text));
            wrong(self.path, &error.to_string())
        })
    }
}
