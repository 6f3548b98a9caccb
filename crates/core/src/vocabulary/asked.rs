//! What was asked, as log and journal say it, and back: one command, many STOPs in one entry, the last of many refusals, or words that
//! are none of these. How a single command is written is said by `words`.

use std::fmt;
use std::time::Duration;

use super::words::{from_words, in_words};
use crate::command::Command;

/// What was asked. `Display` is what the log says, and what the journal keeps.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    /// One command.
    Command(Command),
    /// STOP, so many times.
    Stops {
        /// How many times.
        count: u64,
        /// Between the first and the last, which is told to a tenth of a second; `None` when they came at once.
        within: Option<Duration>,
    },
    /// The last of what one sender was refused, and how much more it was.
    Many {
        /// The last.
        last: Box<Asked>,
        /// So many more.
        more: u64,
    },
    /// In the words of a door, of the simulator or of another version.
    Words(String),
}

/// Between the last and how many more.
const AND: &str = ", and ";

/// Behind how many more.
const MORE: &str = " more that were refused";

impl fmt::Display for Asked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stop = || in_words(&Command::Stop);
        match self {
            Asked::Command(command) => f.write_str(&in_words(command)),
            Asked::Stops { count, within: None } => write!(f, "{}, {count} times at once", stop()),
            Asked::Stops { count, within: Some(within) } => {
                write!(f, "{}, {count} times within {:.1} s", stop(), within.as_secs_f64())
            }
            Asked::Many { last, more } => write!(f, "{last}{AND}{more}{MORE}"),
            Asked::Words(words) => f.write_str(words),
        }
    }
}

impl Asked {
    /// What has these words: `Words` when nothing else has. A time comes back to a tenth of a second.
    #[must_use]
    pub fn from_words(words: &str) -> Asked {
        let many = || {
            let (last, more) = words.strip_suffix(MORE)?.rsplit_once(AND)?;
            let last = one(last).unwrap_or_else(|| Asked::Words(last.to_owned()));
            Some(Asked::Many { last: Box::new(last), more: more.parse().ok()? })
        };
        let read = one(words).or_else(many).filter(|asked| asked.to_string() == words);
        read.unwrap_or_else(|| Asked::Words(words.to_owned()))
    }
}

fn one(words: &str) -> Option<Asked> {
    from_words(words).map(Asked::Command).or_else(|| stops(words))
}

/// `STOP, 3 times within 1.2 s`
fn stops(words: &str) -> Option<Asked> {
    let (count, lasted) = words.split_once(", ")?.1.split_once(" times ")?;
    let within = if lasted == "at once" { None } else { Some(tenths(lasted)?) };
    Some(Asked::Stops { count: count.parse().ok()?, within }).filter(|asked| asked.to_string() == words)
}

/// `within 1.2 s`
fn tenths(words: &str) -> Option<Duration> {
    let (seconds, tenths) = words.strip_prefix("within ")?.strip_suffix(" s")?.split_once('.')?;
    let tenths: u32 = tenths.parse().ok().filter(|tenths| *tenths < 10)?;
    Some(Duration::new(seconds.parse().ok()?, tenths * 100_000_000))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{LuggageRef, Note, Verdict};
    use crate::rng::RandomStream;
    use crate::words::hostile;

    fn one(dice: &mut RandomStream) -> Asked {
        let note = Note::new(&hostile(dice));
        let count = dice.below(1000);
        match dice.below(3) {
            0 => Asked::Command(Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Danger, note }),
            1 => Asked::Stops { count, within: None },
            _ => Asked::Stops { count, within: Some(Duration::from_millis(dice.below(100_000) * 100)) },
        }
    }

    #[test]
    fn whatever_was_asked_comes_back_from_its_words() {
        let mut dice = RandomStream::new(1, "asked");
        for _ in 0..5000 {
            let asked = one(&mut dice);
            assert_eq!(Asked::from_words(&asked.to_string()), asked);
            let many = Asked::Many { last: Box::new(asked), more: dice.below(1000) };
            assert_eq!(Asked::from_words(&many.to_string()), many);
        }
    }

    #[test]
    fn words_of_others_stay_as_they_are() {
        let mut dice = RandomStream::new(2, "asked");
        for _ in 0..5000 {
            let words = hostile(&mut dice);
            assert_eq!(Asked::from_words(&words).to_string(), words);
        }
        for words in [
            "",
            "stop",
            "STOP, 03 times at once",
            "STOP, 3 times within 1.25 s",
            "GO, 3 times at once",
            "the simulator was paused",
        ] {
            assert_eq!(Asked::from_words(words), Asked::Words(words.to_owned()));
        }
        assert_eq!(Asked::from_words("STOP"), Asked::Command(Command::Stop));
    }

    #[test]
    fn a_time_is_told_to_a_tenth_of_a_second() {
        let stops = |millis| Asked::Stops { count: 3, within: Some(Duration::from_millis(millis)) };
        assert_eq!(stops(1234).to_string(), "STOP, 3 times within 1.2 s");
        assert_eq!(Asked::from_words(&stops(1234).to_string()), stops(1200));
        assert_eq!(Asked::from_words(&stops(9).to_string()), stops(0));
    }

    #[test]
    fn words_without_end_are_taken_apart_once() {
        let words = format!("START{}", format!("{AND}7{MORE}").repeat(100_000));
        assert!(matches!(Asked::from_words(&words), Asked::Many { last, more: 7 } if matches!(*last, Asked::Words(_))));
    }
}
