//! Where it is answered that a command's name is none. Brokers never forget a topic, so only so many names get a topic of their
//! own for that; a client that makes up more of them is answered in one place.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// So many names that are none get a topic of their own: enough for every slip of a keyboard.
const NAMES: usize = 64;

/// No name of a command is nearly as long, in bytes.
const LONGEST: usize = 32;

/// Where all the others are answered, in place of their name.
pub(super) const UNKNOWN: &str = "unknown";

/// The names that were seen and are none.
#[derive(Debug, Default)]
pub(super) struct Unknown(Mutex<BTreeSet<String>>);

impl Unknown {
    /// The name under which it is answered that this one is none.
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
