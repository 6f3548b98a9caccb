//! Log lines in JSON. `changes` decides which lines a reader still lacks.

use schemars::JsonSchema;
use serde::Serialize;

use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::snapshot::log::LogLine;

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LogLineJson {
    /// Its number, from 1 without gaps.
    pub number: u64,
    /// When, RFC 3339.
    pub at: String,
    /// `info`, `warning` or `alarm`.
    #[schemars(with = "vocabulary::Tone")]
    pub tone: &'static str,
    /// What happened, as a sentence.
    pub text: String,
}

impl From<&LogLine> for LogLineJson {
    fn from(line: &LogLine) -> LogLineJson {
        LogLineJson { number: line.number, at: rfc3339(line.wall), tone: line.tone.name(), text: line.said.to_string() }
    }
}
