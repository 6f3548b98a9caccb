//! Chooses the topics of answers to unknown commands. Brokers never forget a topic, so only a bounded number of
//! unknown names get a topic of their own. All other unknown names share one topic.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// Maximum number of unknown names with a topic of their own. This is enough for typing errors.
const NAMES: usize = 64;

/// Maximum length in bytes of an unknown name with a topic of its own. The names of all commands are much shorter.
const LONGEST: usize = 32;

/// Name in the topic that all other unknown commands share.
pub(super) const UNKNOWN: &str = "unknown";

#[derive(Debug, Default)]
pub(super) struct Unknown(Mutex<BTreeSet<String>>);

impl Unknown {
    pub(super) fn answered_as<'a>(&self, name: &'a str) -> &'a str {
        let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
        if !(1..=LONGEST).contains(&name.len()) || !name.bytes().all(is_plain) {
            return UNKNOWN;
        }
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if seen.contains(name) {
            return name;
        }
        if seen.len() >= NAMES {
            return UNKNOWN;
        }
        seen.insert(name.to_owned());
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_answered_under_its_own_name_and_what_is_no_name_is_not() {
        let unknown = Unknown::default();
        assert_eq!(unknown.answered_as("strat"), "strat");
        for strange in ["", "a/b", "a b", "+", "#", "start\u{0}", "größe", &"x".repeat(LONGEST + 1)] {
            assert_eq!(unknown.answered_as(strange), UNKNOWN, "{strange}");
        }
    }

    #[test]
    fn names_that_are_made_up_do_not_make_up_topics_without_end() {
        let unknown = Unknown::default();
        let made_up: Vec<String> = (0..10 * NAMES).map(|number| format!("name-{number}")).collect();
        let topics: BTreeSet<&str> = made_up.iter().map(|name| unknown.answered_as(name)).collect();
        assert_eq!(topics.len(), NAMES + 1);
        assert_eq!(unknown.answered_as("name-0"), "name-0", "it keeps its topic");
        assert_eq!(unknown.answered_as("another"), UNKNOWN);
    }
}
