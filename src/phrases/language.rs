//! The languages, and the phrases of each language. The phrases are parsed when they are first used.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use fluent_bundle::FluentResource;
use fluent_bundle::concurrent::FluentBundle;
use unic_langid::LanguageIdentifier;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Language {
    #[default]
    English,
    Italian,
}

const MONTHS: [&str; 12] = ["Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"];

type Bundle = FluentBundle<FluentResource>;

macro_rules! files {
    ($language:literal) => {
        [
            include_str!(concat!($language, "/common.ftl")),
            include_str!(concat!($language, "/console.ftl")),
            include_str!(concat!($language, "/coverage.ftl")),
            include_str!(concat!($language, "/log.ftl")),
            include_str!(concat!($language, "/said.ftl")),
            include_str!(concat!($language, "/editor.ftl")),
            include_str!(concat!($language, "/problems.ftl")),
            include_str!(concat!($language, "/api.ftl")),
            include_str!(concat!($language, "/laboratory.ftl")),
            include_str!(concat!($language, "/missions.ftl")),
            include_str!(concat!($language, "/photo.ftl")),
            include_str!(concat!($language, "/report.ftl")),
            include_str!(concat!($language, "/scripts.ftl")),
            include_str!(concat!($language, "/sign_in.ftl")),
            include_str!(concat!($language, "/simulator.ftl")),
        ]
    };
}

static ENGLISH: LazyLock<Bundle> = LazyLock::new(|| bundle(Language::English, &files!("en")));
static ITALIAN: LazyLock<Bundle> = LazyLock::new(|| bundle(Language::Italian, &files!("it")));

fn bundle(language: Language, files: &[&str]) -> Bundle {
    let tag: LanguageIdentifier = language.tag().parse().expect("the tags of our languages are tags");
    let mut bundle = FluentBundle::new_concurrent(vec![tag]);
    // Both languages, and the values in their phrases, are written from left to right. So no marks for the direction
    // of writing are needed.
    bundle.set_use_isolating(false);
    for file in files {
        let file = FluentResource::try_new((*file).to_owned()).expect("a test reads every file of phrases");
        bundle.add_resource(file).expect("no phrase occurs twice, as a test shows");
    }
    bundle
}

impl Language {
    pub const ALL: [Language; 2] = [Language::English, Language::Italian];

    /// The tag of the language (BCP 47), for pages and headers.
    pub const fn tag(self) -> &'static str {
        match self {
            Language::English => "en",
            Language::Italian => "it",
        }
    }

    pub const fn name(self) -> &'static str {
        match self {
            Language::English => "English",
            Language::Italian => "Italiano",
        }
    }

    /// Returns the language of a tag, with or without a region, such as `it` or `it-CH`.
    pub fn tagged(tag: &str) -> Option<Language> {
        let main = tag.split('-').next().unwrap_or_default();
        Language::ALL.into_iter().find(|language| main.eq_ignore_ascii_case(language.tag()))
    }

    pub fn others(self) -> impl Iterator<Item = Language> {
        Language::ALL.into_iter().filter(move |other| *other != self)
    }

    /// Returns the phrases for these scripts as JSON, by id. The script itself replaces `{ $name }` by a value.
    pub fn for_scripts(self, scripts: &[&str]) -> String {
        let file = match self {
            Language::English => include_str!("en/scripts.ftl"),
            Language::Italian => include_str!("it/scripts.ftl"),
        };
        let is_of = |id: &str, script: &str| id.strip_prefix(script).is_some_and(|rest| rest.starts_with('-'));
        let phrases = file.lines().filter_map(|line| line.split_once(" = "));
        let wanted: BTreeMap<&str, &str> = phrases.filter(|(id, _)| scripts.iter().any(|script| is_of(id, script))).collect();
        serde_json::to_string(&wanted).expect("texts are what JSON can hold")
    }

    /// Converts a number with a decimal point to this language.
    pub fn number(self, written: &str) -> String {
        match self {
            Language::English => written.to_owned(),
            Language::Italian => written.replace('.', ","),
        }
    }

    /// Converts a day and time such as `3 Feb 2026, 10:05:12` to this language.
    pub fn date(self, written: &str) -> String {
        match written.splitn(3, ' ').collect::<Vec<_>>().as_slice() {
            [day, month, rest] if MONTHS.contains(month) => format!("{day} {} {rest}", self.say_of("month", month)),
            _ => written.to_owned(),
        }
    }

    /// A list in words, such as `one`, `one and two`, or `one, two and three`.
    pub fn list(self, words: &[String]) -> String {
        match words {
            [] => String::new(),
            [only] => only.clone(),
            [first @ .., last] => self.say("list").with("first", first.join(", ")).with("last", last).to_string(),
        }
    }

    pub(super) fn bundle(self) -> &'static Bundle {
        match self {
            Language::English => &ENGLISH,
            Language::Italian => &ITALIAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_and_numbers_are_written_as_the_language_does() {
        let written = |month: &str| format!("3 {month} 2026, 10:05:12");
        MONTHS.iter().for_each(|month| assert_eq!(Language::English.date(&written(month)), written(month)));
        assert_eq!(Language::Italian.date(&written("Jan")), "3 gen 2026, 10:05:12");
        assert_eq!(
            MONTHS.map(|month| Language::Italian.date(&written(month))).iter().filter(|date| date.contains("gen")).count(),
            1
        );
        assert_eq!(Language::Italian.date("long ago, it was"), "long ago, it was");
        assert_eq!((Language::English.number("2.5"), Language::Italian.number("2.5")), ("2.5".to_owned(), "2,5".to_owned()));
    }

    #[test]
    fn a_list_ends_with_and() {
        let list =
            |language: Language, words: &[&str]| language.list(&words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>());
        assert_eq!(list(Language::English, &["a"]), "a");
        assert_eq!(list(Language::English, &["a", "b", "c"]), "a, b and c");
        assert_eq!(list(Language::Italian, &["a", "b"]), "a e b");
        assert_eq!(list(Language::Italian, &[]), "");
    }

    #[test]
    fn what_is_put_into_markup_is_none() {
        let said = Language::Italian.say("held-by").with("what", "<i>\"&'").markup().to_string();
        assert!(said.starts_with("<b>Bloccato:</b> ") && !said.contains("<i>"), "{said}");
    }
}
