//! Requests as the log and the journal record them, such as one command or several STOPs in one entry. Another module
//! defines the file format of the journal.

use std::fmt;
use std::time::Duration;

use crate::command::{Command, LuggageRef};
use crate::simulated::Simulated;
use crate::units::LuggageId;

/// A recorded request. `Display` is its sentence in the log.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    Command(Command),
    /// STOPs that share one entry.
    Stops {
        count: u64,
        /// Time from the first STOP to the last, in whole milliseconds; `None` if all arrived at the same time.
        within: Option<Duration>,
    },
    Simulated(Simulated),
    /// Refused requests of one sender that share one entry.
    Many {
        last: Box<Asked>,
        /// Number of requests before the last one.
        more: u64,
    },
    /// A request as text, because there is no `Command` for it, or because another version of the program recorded
    /// it.
    Words(String),
}

impl Asked {
    /// Returns this request. If it is a verdict without a number, the number in `meant` is added.
    #[must_use]
    pub fn about(&self, meant: Option<LuggageId>) -> Asked {
        match (self, meant) {
            (Asked::Command(Command::Verdict { luggage: LuggageRef::Pending, verdict, note, hot }), Some(id)) => {
                let (luggage, note) = (LuggageRef::Id(id), note.clone());
                Asked::Command(Command::Verdict { luggage, verdict: *verdict, note, hot: *hot })
            }
            (asked, _) => asked.clone(),
        }
    }
}

impl fmt::Display for Asked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Asked::Command(command) => write!(f, "{command}"),
            Asked::Stops { count, within: None } => write!(f, "{}, {count} times at once", Command::Stop),
            Asked::Stops { count, within: Some(within) } => {
                write!(f, "{}, {count} times within {:.1} s", Command::Stop, within.as_secs_f64())
            }
            Asked::Simulated(simulated) => write!(f, "{simulated}"),
            Asked::Many { last, more } => write!(f, "{last}, and {more} more that were refused"),
            Asked::Words(words) => f.write_str(words),
        }
    }
}
