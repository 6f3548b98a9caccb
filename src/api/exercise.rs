//! The results of an exercise in JSON: how well each key has judged.

use schemars::JsonSchema;
use serde::Serialize;

use hallsweep_core::state::PersistentState;
use hallsweep_core::world::scores::{Rate, Score};

/// Results of an exercise. Only pieces count that had a verdict when it was over.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ExerciseJson {
    /// Results of each key, sorted by the names of the keys.
    keys: Vec<ScoreJson>,
}

/// Results of one key in an exercise.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
struct ScoreJson {
    /// Name of the key.
    key: String,
    /// Number of answers `safe` and `danger`.
    answers: usize,
    /// Number of test pieces that were answered with `danger`.
    hits: usize,
    /// Number of test pieces that were answered with `safe`.
    misses: usize,
    /// Number of other pieces that were answered with `danger`.
    false_alarms: usize,
    /// Number of other pieces that were answered with `safe`.
    correct_safe: usize,
    /// Number of answers `unsure`.
    unsure: usize,
    /// Share of hits among the test pieces; absent below 10 test pieces.
    #[serde(skip_serializing_if = "Option::is_none")]
    hit_rate: Option<RateJson>,
    /// Share of false alarms among the other pieces; absent below 10 other pieces.
    #[serde(skip_serializing_if = "Option::is_none")]
    false_alarm_rate: Option<RateJson>,
    /// Median time from the photo to the answer, in seconds; absent if no time is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    median_seconds: Option<f64>,
    /// Longest time from the photo to the answer, in seconds; absent if no time is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    longest_seconds: Option<f64>,
}

/// Share of pieces with its 95 % interval by Wilson, each from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "Rate")]
struct RateJson {
    /// Number of pieces.
    n: usize,
    rate: f64,
    low: f64,
    high: f64,
}

impl ExerciseJson {
    /// The results of this mission; `None` if it is no exercise.
    pub fn of(state: &PersistentState) -> Option<ExerciseJson> {
        let is_exercise = state.conditions.as_ref()?.venue.is_exercise;
        let keys = || Score::of(&state.luggage).into_iter().map(|(key, score)| ScoreJson::new(&key, &score)).collect();
        is_exercise.then(|| ExerciseJson { keys: keys() })
    }
}

impl ScoreJson {
    fn new(key: &str, score: &Score) -> ScoreJson {
        let rate =
            |rate: Option<Rate>| rate.map(|Rate { pieces, share, low, high }| RateJson { n: pieces, rate: share, low, high });
        let seconds = |ms: i64| std::time::Duration::from_millis(ms.unsigned_abs()).as_secs_f64();
        ScoreJson {
            key: key.to_owned(),
            answers: score.answers(),
            hits: score.hits,
            misses: score.misses,
            false_alarms: score.false_alarms,
            correct_safe: score.correct_safe,
            unsure: score.unsure,
            hit_rate: rate(score.hit_rate()),
            false_alarm_rate: rate(score.false_alarm_rate()),
            median_seconds: score.median_ms().map(seconds),
            longest_seconds: score.took_ms.last().copied().map(seconds),
        }
    }
}
