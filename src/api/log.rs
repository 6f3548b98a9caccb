//! Log lines in JSON. `changes` decides which lines are sent to a reader.

use schemars::JsonSchema;
use serde::Serialize;

use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::snapshot::log::LogLine;

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LogLineJson {
    /// Number of the line, counted from 1 without gaps.
    pub number: u64,
    /// Time of the event, RFC 3339.
    pub at: String,
    /// Severity: `info`, `warning` or `alarm`.
    #[schemars(with = "vocabulary::Tone")]
    pub tone: &'static str,
    /// Sentence that says what happened.
    pub text: String,
}

impl From<&LogLine> for LogLineJson {
    fn from(line: &LogLine) -> LogLineJson {
        LogLineJson { number: line.number, at: rfc3339(line.wall), tone: line.tone.name(), text: line.said.to_string() }
    }
}
