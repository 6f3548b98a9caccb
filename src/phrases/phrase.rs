//! A phrase with its values. The phrase is formatted only when it is shown. `said` chooses the phrases for values of
//! the core.

use std::borrow::Cow;
use std::fmt::{self, Display};

use fluent_bundle::{FluentArgs, FluentValue};

use super::language::Language;

/// A phrase, and the values set so far. `Display` formats the phrase.
#[derive(Clone, Debug)]
pub struct Phrase<'a> {
    language: Language,
    family: &'a str,
    id: &'a str,
    values: Vec<(&'static str, String)>,
}

/// A phrase that is markup. The text from the file is used as it is; the values are escaped.
#[derive(Clone, Debug)]
pub struct Markup(String);

/// Whole numbers below this limit are exact in Fluent.
const EXACT: u64 = 1 << 53;

impl Language {
    pub const fn say(self, id: &str) -> Phrase<'_> {
        Phrase::new(self, "", id)
    }

    /// Returns the phrase with the id `family-member`, such as `phase-exploring`. Used for values that have a name,
    /// such as phases.
    pub const fn say_of<'a>(self, family: &'a str, member: &'a str) -> Phrase<'a> {
        Phrase::new(self, family, member)
    }
}

impl<'a> Phrase<'a> {
    pub(super) const fn new(language: Language, family: &'a str, id: &'a str) -> Phrase<'a> {
        Phrase { language, family, id, values: Vec::new() }
    }

    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl Display) -> Phrase<'a> {
        self.values.push((name, value.to_string()));
        self
    }

    pub fn markup(self) -> Markup {
        let escaped =
            |text: &str| askama::filters::escape(text, askama::filters::Html).map(|safe| safe.to_string()).unwrap_or_default();
        let values = self.values.iter().map(|(name, value)| (*name, escaped(value))).collect();
        Markup(Phrase { values, ..self }.said())
    }

    fn id(&self) -> Cow<'a, str> {
        if self.family.is_empty() { Cow::Borrowed(self.id) } else { Cow::Owned(format!("{}-{}", self.family, self.id)) }
    }

    fn said(&self) -> String {
        let id = self.id();
        #[cfg(test)]
        said_here(|said| said.insert(id.to_string()));
        let bundle = self.language.bundle();
        let Some(pattern) = bundle.get_message(&id).and_then(|message| message.value()) else {
            // Tests search the source for every id. Ids that are composed of a family and a name have tests of their
            // own.
            debug_assert!(false, "there is no phrase {id} in {}", self.language.name());
            return id.into_owned();
        };
        let values: FluentArgs<'_> = self.values.iter().map(|(name, value)| (*name, fluent(value))).collect();
        let mut errors = Vec::new();
        let said = bundle.format_pattern(pattern, Some(&values), &mut errors).into_owned();
        debug_assert!(errors.is_empty(), "{id} in {}: {errors:?}", self.language.name());
        said
    }
}

/// Gives access to the ids of the phrases that were formatted on this thread.
#[cfg(test)]
pub(crate) fn said_here<T>(look: impl FnOnce(&mut std::collections::BTreeSet<String>) -> T) -> T {
    thread_local!(static SAID: std::cell::RefCell<std::collections::BTreeSet<String>> = std::cell::RefCell::default());
    SAID.with_borrow_mut(look)
}

/// Converts a value for Fluent. Whole numbers select singular or plural. Every other value is inserted as it is.
fn fluent(value: &str) -> FluentValue<'_> {
    let number = value.parse::<i64>().ok().filter(|number| number.unsigned_abs() < EXACT && number.to_string() == value);
    number.map_or_else(|| FluentValue::from(value), FluentValue::from)
}

impl Display for Phrase<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.said())
    }
}

impl Display for Markup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl askama::filters::HtmlSafe for Markup {}

#[cfg(test)]
impl PartialEq<&str> for Phrase<'_> {
    fn eq(&self, said: &&str) -> bool {
        self.said() == *said
    }
}
