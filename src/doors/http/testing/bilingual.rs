//! Finds texts that are the same on the English and the Italian page. Such a text is a name, or its translation is
//! missing.

use std::collections::BTreeSet;

use super::{TestApp, text};

const BROWSER: (&str, &str) = ("accept", "text/html,application/xhtml+xml,*/*;q=0.8");

const NAMES: [&str; 5] = ["hallsweep", "API", "STOP", "· Esc", "no"];

impl TestApp {
    /// Returns the Italian page for this request. A text that is the same on the English page must be in `names`.
    pub(in crate::doors::http) async fn italian(
        &self,
        method: &str,
        path: &str,
        body: &str,
        headers: &[(&str, &str)],
        names: &[&str],
    ) -> String {
        let form = ("content-type", "application/x-www-form-urlencoded");
        let asked = |language| [&[BROWSER, form, ("accept-language", language)], headers].concat();
        let english = text(self.send(method, path, &asked("en"), body).await).await;
        let italian = text(self.send(method, path, &asked("it"), body).await).await;
        assert!(english.contains("<html lang=\"en\"") && italian.contains("<html lang=\"it\""), "{method} {path}: {italian}");
        let (one, other) = (without_trees(&english), without_trees(&italian));
        let (one, other) = (words(&one), words(&other));
        let names: BTreeSet<&str> = names.iter().chain(&NAMES).copied().collect();
        let same: Vec<&&str> = one.intersection(&other).filter(|words| !names.contains(**words)).collect();
        assert!(same.is_empty(), "{method} {path}: the same in both languages: {same:?}");
        italian
    }
}

/// Returns the page without its behaviour trees and their blackboard, whose names come from files.
fn without_trees(page: &str) -> String {
    [("<section class=\"tree\"", "</section>"), ("<div id=\"blackboard\">", "</dl>")].iter().fold(
        page.to_owned(),
        |page, (from, to)| {
            let mut parts = page.split(from);
            let first = parts.next().unwrap_or_default().to_owned();
            first + &parts.map(|part| part.split_once(to).map_or("", |(_, rest)| rest)).collect::<String>()
        },
    )
}

/// Returns the texts of a page and the attributes that people read or hear. Texts for programs are left out.
fn words(page: &str) -> BTreeSet<&str> {
    let is_for_people = |tag: &str| !["textarea", "code"].iter().any(|name| tag.starts_with(name));
    let texts = page.split('<').filter_map(|piece| piece.split_once('>')).filter(|(tag, _)| is_for_people(tag));
    let texts = texts.map(|(_, text)| text);
    let attributes = ["title", "alt", "aria-label", "placeholder", "data-label"].map(|name| format!(" {name}=\""));
    let attributes: Vec<&str> =
        attributes.iter().flat_map(|name| page.split(name.as_str()).skip(1)).filter_map(|rest| rest.split('"').next()).collect();
    let is_word = |text: &&str| text.split(|c: char| !c.is_alphabetic()).any(|word| word.chars().count() > 1);
    let is_zone = |text: &&str| text.contains("UTC");
    texts.chain(attributes).map(str::trim).filter(is_word).filter(|text| !is_zone(text)).collect()
}
