//! A journal entry in words: one line for a person, who reads it in a terminal or on the console's pages. The words
//! come from the core. The form for programs, which can be read back, is not here.

use super::time::rfc3339;
pub use hallsweep_core::snapshot::fact_words::words;
use hallsweep_core::state::fact::Entry;

/// Writes the time, then the fact in a few words, without a line break. The same entry always gives the same bytes.
pub fn line(entry: &Entry) -> String {
    format!("{} {}", rfc3339(entry.wall), words(&entry.fact))
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::state::fact::Fact;
    use hallsweep_core::units::{Pose, WallTime};

    #[test]
    fn an_entry_is_one_line_that_begins_with_its_time() {
        let entry = Entry { wall: WallTime::default(), fact: Fact::Pose(Pose::START) };
        assert_eq!(line(&entry), "1970-01-01T00:00:00.000+00:00 robot at (0, 0), facing south");
    }
}
