//! A page for those who read Italian, and what of it was left in English.

use super::{TestApp, text};
use crate::phrases::Language;

/// Attributes whose values a person reads or hears.
const SAYING: [&str; 5] = ["alt", "aria-label", "data-label", "data-words", "title"];

impl TestApp {
    /// The page in Italian, in which no phrase of this English file stands alone, but for those that others say there too. Phrases with
    /// values in them are not looked for.
    pub(in crate::doors::http) async fn read_in_italian(&self, path: &str, english: &str, but_for: &[&str]) -> String {
        let response = self.send("GET", path, &[("accept-language", "it")], "").await;
        assert_eq!(response.status(), 200, "{path}");
        let page = text(response).await.replace("&#39;", "'");
        assert!(page.contains("<html lang=\"it\""), "{path}");
        let phrases = english.lines().filter_map(|line| line.split_once(" = "));
        for (id, phrase) in phrases.filter(|(id, phrase)| !phrase.contains('{') && !but_for.contains(id)) {
            let is_said = SAYING.iter().any(|attribute| page.contains(&format!(" {attribute}=\"{phrase}\"")));
            let is_left = is_said || page.contains(&format!(">{phrase}<"));
            assert!(!is_left || Language::Italian.say(id) == phrase, "{id}, {phrase:?}, stands on {path}: {page}");
        }
        page
    }
}
