//! Alarms: what an operator must be told loudly, until somebody acknowledges it. An alarm is shown at once, and its
//! number once that is on record, because a number that was shown must never mean another alarm (safety R4).

use std::fmt;
use std::sync::Arc;

use crate::pair::Saying;
use crate::units::{AlarmId, Cell, LuggageId, WallTime};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Alarm {
    pub id: AlarmId,
    pub raised: WallTime,
    pub cause: AlarmCause,
    pub luggage: Option<LuggageId>,
    /// Who acknowledged it, and when.
    pub acknowledged: Option<(Arc<str>, WallTime)>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AlarmView {
    /// `None` until it is on record.
    pub id: Option<AlarmId>,
    pub raised: WallTime,
    pub cause: AlarmCause,
    pub luggage: Option<LuggageId>,
    /// Who acknowledged it, and when.
    pub acknowledged: Option<(Arc<str>, WallTime)>,
}

/// Why there is an alarm. `Display` is what an operator reads, and what the journal stores.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AlarmCause {
    /// The piece in this cell was found dangerous.
    Dangerous(LuggageId, Cell),
    /// The piece was found dangerous, but that is not on record.
    Unrecorded(LuggageId, Cell),
    /// The pair that fetches this piece calls the operator.
    Call(LuggageId, Saying),
    /// In words of another version.
    Other(String),
}

impl fmt::Display for AlarmCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AlarmCause::Dangerous(luggage, cell) => write!(f, "luggage #{luggage} at {cell} is dangerous"),
            AlarmCause::Unrecorded(luggage, cell) => {
                write!(f, "luggage #{luggage} at {cell} is said to be dangerous, but that could not be recorded")
            }
            AlarmCause::Call(luggage, saying) => write!(f, "luggage #{luggage}: {}", saying.in_words()),
            AlarmCause::Other(words) => f.write_str(words),
        }
    }
}

impl AlarmCause {
    /// The cause with these words; `Other` when there is none.
    #[must_use]
    pub fn from_words(words: &str) -> AlarmCause {
        read(words).unwrap_or_else(|| AlarmCause::Other(words.to_owned()))
    }
}

fn read(words: &str) -> Option<AlarmCause> {
    let about = words.strip_prefix("luggage #")?;
    let (number, rest) = about.split_at(about.find([' ', ':'])?);
    let luggage = LuggageId(number.parse().ok()?);
    let calls = Saying::ALL.into_iter().map(|saying| AlarmCause::Call(luggage, saying));
    let at = || Cell::from_words(rest.strip_prefix(" at ")?.split_inclusive(')').next()?);
    let dangers = at().map(|cell| [AlarmCause::Dangerous(luggage, cell), AlarmCause::Unrecorded(luggage, cell)]);
    dangers.into_iter().flatten().chain(calls).find(|cause| cause.to_string() == words)
}

impl AlarmView {
    pub(crate) fn recorded(alarm: &Alarm) -> AlarmView {
        AlarmView { id: Some(alarm.id), ..AlarmView::unrecorded(alarm) }
    }

    pub(crate) fn unrecorded(alarm: &Alarm) -> AlarmView {
        let Alarm { raised, cause, luggage, acknowledged, .. } = alarm.clone();
        AlarmView { id: None, raised, cause, luggage, acknowledged }
    }

    #[must_use]
    pub const fn is_recorded(&self) -> bool {
        self.id.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::RandomStream;
    use crate::words::{coordinate, hostile, number};

    #[test]
    fn every_cause_comes_back_from_its_words() {
        let mut dice = RandomStream::new(1, "alarms");
        for _ in 0..5000 {
            let luggage = LuggageId(number(&mut dice));
            let cell = Cell::new(coordinate(&mut dice), coordinate(&mut dice));
            for cause in [
                AlarmCause::Dangerous(luggage, cell),
                AlarmCause::Unrecorded(luggage, cell),
                AlarmCause::Call(luggage, Saying::CallOperator),
                AlarmCause::Call(luggage, Saying::PackageLost),
            ] {
                assert_eq!(AlarmCause::from_words(&cause.to_string()), cause);
            }
        }
    }

    #[test]
    fn words_of_another_version_stay_as_they_are() {
        let mut dice = RandomStream::new(2, "alarms");
        for _ in 0..5000 {
            let words = hostile(&mut dice);
            assert_eq!(AlarmCause::from_words(&words).to_string(), words);
        }
        for words in [
            "",
            "luggage #2 is dangerous",
            "luggage #02 at (1, 2) is dangerous",
            "luggage #2 at (1,2) is dangerous",
            "luggage #2 at (1, 2) is dangerous ",
            "luggage #2: ",
            "luggage #2 at (1",
        ] {
            assert_eq!(AlarmCause::from_words(words), AlarmCause::Other(words.to_owned()));
        }
    }
}
