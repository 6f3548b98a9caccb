//! What was asked, as log and journal have it: one command, many STOPs in one entry, something done to the simulator, the last of many
//! refusals, or the words of a door. How it is written in the journal is not here.

use std::fmt;
use std::time::Duration;

use crate::command::{Command, LuggageRef};
use crate::simulated::Simulated;
use crate::units::LuggageId;

/// What was asked. `Display` is what the log says.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    /// One command.
    Command(Command),
    /// STOP, so many times.
    Stops {
        /// How many times.
        count: u64,
        /// Between the first and the last, in whole milliseconds; `None` when they came at once.
        within: Option<Duration>,
    },
    /// Something done to the hall and robots that are simulated.
    Simulated(Simulated),
    /// The last of what one sender was refused, and how much more it was.
    Many {
        /// The last.
        last: Box<Asked>,
        /// So many more.
        more: u64,
    },
    /// In the words of a door, which knows no command for it, or of another version.
    Words(String),
}

impl Asked {
    /// The same with the piece that a bare verdict turned out to be about.
    #[must_use]
    pub fn about(&self, meant: Option<LuggageId>) -> Asked {
        match (self, meant) {
            (Asked::Command(Command::Verdict { luggage: LuggageRef::Pending, verdict, note }), Some(id)) => {
                Asked::Command(Command::Verdict { luggage: LuggageRef::Id(id), verdict: *verdict, note: note.clone() })
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
