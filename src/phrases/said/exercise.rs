//! The results of an exercise as a table.

use std::time::Duration;

use super::Language;
use crate::phrases::Phrase;
use hallsweep_core::world::records::LuggageRecords;
use hallsweep_core::world::scores::{Rate, Score};

const COLUMNS: [&str; 9] = ["key", "answers", "hits", "misses", "false-alarms", "correct-safe", "unsure", "median", "longest"];

impl Language {
    pub fn score_columns(self) -> [Phrase<'static>; 9] {
        COLUMNS.map(|column| self.say_of("score", column))
    }

    /// Returns the cells of each key, in the order of the columns. A rate follows its count in brackets.
    pub fn scores(self, records: &LuggageRecords) -> Vec<[String; 9]> {
        let percent = |share: f64| self.number(&format!("{:.0}", share * 100.0));
        let rated = |count: usize, rate: Option<Rate>| match rate {
            Some(Rate { share, low, high, .. }) => {
                let say = self.say("score-rate").with("count", count).with("rate", percent(share));
                say.with("low", percent(low)).with("high", percent(high)).to_string()
            }
            None => count.to_string(),
        };
        let seconds = |ms: Option<i64>| {
            ms.map_or_else(
                || "–".to_owned(),
                |ms| self.number(&format!("{:.1} s", Duration::from_millis(ms.unsigned_abs()).as_secs_f64())),
            )
        };
        let row = |(key, score): (std::sync::Arc<str>, Score)| {
            [
                key.to_string(),
                score.answers().to_string(),
                rated(score.hits, score.hit_rate()),
                score.misses.to_string(),
                rated(score.false_alarms, score.false_alarm_rate()),
                score.correct_safe.to_string(),
                score.unsure.to_string(),
                seconds(score.median_ms()),
                seconds(score.took_ms.last().copied()),
            ]
        };
        Score::of(records).into_iter().map(row).collect()
    }
}
