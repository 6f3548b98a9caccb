//! The rules of phrases: every language has every phrase with the same values, every phrase is used, and every phrase
//! that is used exists. The parser understands only as much of Fluent as this needs.

use std::collections::{BTreeMap, BTreeSet};

use super::reading::{files, name, root};

/// Languages, by the folders of their files.
const LANGUAGES: [&str; 2] = ["en", "it"];

/// Folders that use phrases.
const PLACES: [&str; 5] = ["src/doors/http", "src/phrases", "src/report", "templates", "static"];

/// Value with an English sentence of the program; another language may replace it by its own words and leave it out.
const MAY_BE_LEFT_OUT: &str = "detail";

/// Names of the values in a phrase, and whether scripts may use the phrase.
#[derive(Debug, Default, PartialEq, Eq)]
struct Phrase {
    values: BTreeSet<String>,
    is_for_scripts: bool,
}

type Phrases = BTreeMap<String, Phrase>;

/// Violations of all rules.
pub(crate) fn findings() -> Vec<String> {
    let spoken: Vec<Phrases> = LANGUAGES.iter().map(|language| of_files(language)).collect();
    assert!(spoken[0].len() > 400, "only {} phrases were found: the test looks in the wrong place", spoken[0].len());
    let texts: Vec<(String, String)> = PLACES
        .iter()
        .flat_map(|place| files(&root().join(place)))
        .filter(|path| ["rs", "html", "js"].iter().any(|kind| path.extension().is_some_and(|found| found == *kind)))
        .map(|path| (name(&path), std::fs::read_to_string(&path).expect("a source is UTF-8")))
        .collect();
    [differing(&spoken[0], &spoken[1]), unsaid(&spoken[0], &texts), unknown(&spoken[0], &texts)].concat()
}

fn of_files(language: &str) -> Phrases {
    let folder = root().join("src/phrases").join(language);
    let texts = files(&folder)
        .into_iter()
        .map(|path| (name(&path).contains("scripts"), std::fs::read_to_string(path).expect("a file of phrases is UTF-8")));
    let mut all = Phrases::new();
    for (is_for_scripts, text) in texts {
        for (id, phrase) in of(&text, is_for_scripts) {
            assert!(all.insert(id.clone(), phrase).is_none(), "{id} is in two files of {language}");
        }
    }
    all
}

/// Phrases of a file. The further lines of a phrase are indented.
fn of(text: &str, is_for_scripts: bool) -> Phrases {
    let mut phrases = Phrases::new();
    let mut last = None;
    for line in text.lines() {
        if let Some((id, _)) = line.split_once(" =").filter(|(id, _)| is_id(id)) {
            last = Some(id.to_owned());
        } else if !line.starts_with([' ', '}']) {
            last = None;
        }
        if let Some(id) = &last {
            let phrase = phrases.entry(id.clone()).or_default();
            phrase.is_for_scripts = is_for_scripts;
            let values = line.split('$').skip(1);
            let values =
                values.map(|rest| rest.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect::<String>());
            phrase.values.extend(values.filter(|value| value != MAY_BE_LEFT_OUT));
        }
    }
    phrases
}

fn is_id(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_lowercase()) && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-')
}

fn differing(one: &Phrases, other: &Phrases) -> Vec<String> {
    let ids: BTreeSet<&String> = one.keys().chain(other.keys()).collect();
    let differ = ids.into_iter().filter(|id| one.get(*id) != other.get(*id));
    differ.map(|id| format!("{id}: {:?} in {}, {:?} in {}", one.get(id), LANGUAGES[0], other.get(id), LANGUAGES[1])).collect()
}

/// Phrases that no literal names and that belong to no family in use.
fn unsaid(phrases: &Phrases, texts: &[(String, String)]) -> Vec<String> {
    let families: BTreeSet<&str> = texts.iter().flat_map(|(_, text)| literals_after(text, "say_of(")).collect();
    let is_said = |id: &str| {
        let literal = format!("\"{id}\"");
        let of_family = families.iter().any(|family| id.strip_prefix(family).is_some_and(|rest| rest.starts_with('-')));
        of_family || texts.iter().any(|(_, text)| text.contains(&literal))
    };
    phrases.keys().filter(|id| !is_said(id)).map(|id| format!("{id}: nobody says it")).collect()
}

/// Phrases that sources or scripts use and that do not exist. A page may also use the phrases of its scripts.
fn unknown(phrases: &Phrases, texts: &[(String, String)]) -> Vec<String> {
    let said = texts.iter().flat_map(|(file, text)| said_in(text).into_iter().map(move |id| (file, id)));
    let is_there = |file: &str, id: &str| phrases.get(id).is_some_and(|phrase| phrase.is_for_scripts || !file.ends_with(".js"));
    said.filter(|(file, id)| is_id(id) && !is_there(file, id))
        .map(|(file, id)| format!("{file} says {id}, which is not there"))
        .collect()
}

/// Ids in the first argument of a call, in all its alternatives. A literal that is only a part of the argument may
/// belong to a condition; it counts as an id if it contains a hyphen.
fn said_in(text: &str) -> Vec<&str> {
    let literals = |rest| first_argument(rest).split('"').skip(1).step_by(2);
    let in_call = |rest: &'_ str| rest.starts_with('"');
    text.split("say(").skip(1).flat_map(|rest| literals(rest).filter(move |id| in_call(rest) || id.contains('-'))).collect()
}

fn first_argument(rest: &str) -> &str {
    let (mut depth, mut is_quoted) = (0, false);
    let end = rest.find(|c: char| {
        match c {
            '"' => is_quoted = !is_quoted,
            '(' | '{' | '[' if !is_quoted => depth += 1,
            ')' | '}' | ']' if !is_quoted => depth -= 1,
            _ => {}
        }
        depth < 0 || (c == ',' && depth == 0 && !is_quoted)
    });
    &rest[..end.unwrap_or(0)]
}

/// Literals that are the first argument of this call.
fn literals_after<'t>(text: &'t str, call: &str) -> impl Iterator<Item = &'t str> {
    text.split(call).skip(1).filter_map(|rest| rest.strip_prefix('"')?.split('"').next())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(text: &str) -> Vec<(String, String)> {
        vec![("src/a.rs".to_owned(), text.to_owned())]
    }

    #[test]
    fn what_one_language_lacks_or_says_with_other_values_is_found() {
        let english = of("a = A { $x }\nb = { $n ->\n    [one] one\n   *[other] { $n } of { $y }\n}\n", false);
        assert_eq!(differing(&english, &of("a = { $x } A\nb = { $n } di { $y }\n", false)), Vec::<String>::new());
        assert_eq!(differing(&english, &of("a = { $z }\n# b = { $n }\n", false)).len(), 2);
        assert_eq!(differing(&of("a = { $detail }\n", false), &of("a = Non va.\n", false)), Vec::<String>::new());
    }

    #[test]
    fn what_nobody_says_and_what_is_not_there_is_found() {
        let phrases = of("a = A\nphase-idle = idle\n", false);
        assert_eq!(unsaid(&phrases, &texts("say(\"a\"); say_of(\"phase\", name)")), Vec::<String>::new());
        assert_eq!(unsaid(&phrases, &texts("say(\"b\")")).len(), 2);
        let chosen = texts("say(if f(1, \"x y\") { \"a\" } else { \"a-c\" }, \"d\"); say(match x { A => \"a\", B => \"a-e\" })");
        assert_eq!(
            unknown(&phrases, &chosen),
            ["src/a.rs says a-c, which is not there", "src/a.rs says a-e, which is not there"]
        );
        assert_eq!(unknown(&phrases, &texts("say(\"b\").with(\"x\", say(\"a\"))")), ["src/a.rs says b, which is not there"]);
        let by_script = [("static/a.js".to_owned(), "say(\"a\")".to_owned())];
        assert_eq!(unknown(&phrases, &by_script), ["static/a.js says a, which is not there"]);
        assert_eq!(unknown(&of("a = A\n", true), &[&by_script[..], &texts("say(\"a\")")].concat()), Vec::<String>::new());
    }
}
