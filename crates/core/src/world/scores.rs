//! How well each key has judged the pieces of an exercise. Only pieces count of which is recorded what they were.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::records::LuggageRecords;
use crate::command::{Issuer, Verdict};

/// The answers of one key.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Score {
    /// Test pieces that were answered with *danger*.
    pub hits: usize,
    /// Test pieces that were answered with *safe*.
    pub misses: usize,
    /// Other pieces that were answered with *danger*.
    pub false_alarms: usize,
    /// Other pieces that were answered with *safe*.
    pub correct_safe: usize,
    /// How often the judges were unsure. This is no answer.
    pub unsure: usize,
    /// Time from the photo to each answer, in milliseconds, the shortest first. If the clock was set while a piece waited,
    /// its times are not known.
    pub took_ms: Vec<i64>,
}

/// A share of pieces, with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    pub pieces: usize,
    pub share: f64,
    pub low: f64,
    pub high: f64,
}

impl Rate {
    /// Fewest pieces for which a rate says anything.
    const LEAST: usize = 10;

    /// The rate with its 95 % interval by E. B. Wilson (Journal of the American Statistical Association 22, 1927);
    /// `None` for fewer pieces than `LEAST`.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a mission has fewer than 2^52 pieces")]
    pub fn of(count: usize, pieces: usize) -> Option<Rate> {
        /// The 97.5 % quantile of the normal distribution.
        const Z: f64 = 1.959_963_984_540_054;
        let (n, share) = (pieces as f64, count as f64 / pieces as f64);
        let (scale, middle) = (1.0 + Z * Z / n, share + Z * Z / (2.0 * n));
        let half = Z * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
        let bound = |bound: f64| (bound / scale).clamp(0.0, 1.0);
        (pieces >= Rate::LEAST).then(|| Rate { pieces, share, low: bound(middle - half), high: bound(middle + half) })
    }
}

impl Score {
    /// The scores of all keys that have judged these pieces, by their names. With two judges, the own answer of each
    /// counts.
    #[must_use]
    pub fn of(records: &LuggageRecords) -> BTreeMap<Arc<str>, Score> {
        let mut scores: BTreeMap<Arc<str>, Score> = BTreeMap::new();
        for luggage in records.iter() {
            let (Some(is_test), Some(decision)) = (luggage.truth, &luggage.verdict) else { continue };
            let by = Issuer::key_of(&decision.who);
            // A judge who has said *safe* and then *danger* has answered once.
            let others = luggage.judged.iter().filter(|judgement| &*judgement.issuer.key() != by);
            let others = others.map(|judgement| (judgement.issuer.key(), judgement.verdict, judgement.taken, judgement.wall));
            for (key, verdict, taken, wall) in others.chain([(by.into(), decision.verdict, luggage.taken, decision.wall)]) {
                let took_ms = wall.unix_ms.saturating_sub(taken.unix_ms).max(0);
                scores.entry(key).or_default().count(is_test, verdict, Some(took_ms).filter(|_| luggage.clock_set_ms == 0));
            }
            for doubt in &luggage.unsure {
                scores.entry(Issuer::key_of(&doubt.who).into()).or_default().unsure += 1;
            }
        }
        scores.values_mut().for_each(|score| score.took_ms.sort_unstable());
        scores
    }

    fn count(&mut self, is_test: bool, verdict: Verdict, took_ms: Option<i64>) {
        *match (is_test, verdict) {
            (true, Verdict::Danger) => &mut self.hits,
            (true, Verdict::Safe) => &mut self.misses,
            (false, Verdict::Danger) => &mut self.false_alarms,
            (false, Verdict::Safe) => &mut self.correct_safe,
        } += 1;
        self.took_ms.extend(took_ms);
    }

    #[must_use]
    pub const fn answers(&self) -> usize {
        self.hits + self.misses + self.false_alarms + self.correct_safe
    }

    #[must_use]
    pub fn hit_rate(&self) -> Option<Rate> {
        Rate::of(self.hits, self.hits + self.misses)
    }

    #[must_use]
    pub fn false_alarm_rate(&self) -> Option<Rate> {
        Rate::of(self.false_alarms, self.false_alarms + self.correct_safe)
    }

    /// The median of the times in milliseconds; `None` without answers.
    #[must_use]
    pub fn median_ms(&self) -> Option<i64> {
        let (upper, lower) = (self.took_ms.len() / 2, self.took_ms.len().saturating_sub(1) / 2);
        Some(i64::midpoint(*self.took_ms.get(lower)?, *self.took_ms.get(upper)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::{Door, Hot};
    use crate::units::{Cell, LuggageId, Pose, WallTime};
    use crate::world::luggage::{Decision, Doubt, Judgement, Luggage, PhotoState};

    const fn at(seconds: i64) -> WallTime {
        WallTime { unix_ms: seconds * 1000, offset_s: 0 }
    }

    fn judged(id: u64, truth: Option<bool>, (who, verdict, seconds): (&str, Verdict, i64)) -> Luggage {
        let decision = Decision { verdict, who: who.into(), wall: at(100 + seconds), note: None, hot: Hot::NONE };
        Luggage {
            id: LuggageId(id),
            cell: Cell::HOME,
            pose: Pose::START,
            seen_from: Vec::new(),
            taken: at(100),
            first_taken: at(40),
            photo: PhotoState::Taken { bytes: 1, take: 1 },
            verdict: Some(decision),
            unsure: Vec::new(),
            judged: Vec::new(),
            truth,
            piece: None,
            secured: None,
            clock_set_ms: 0,
        }
    }

    fn first_answer(who: &str, verdict: Verdict, seconds: i64) -> Judgement {
        let issuer = Issuer { door: Door::LOCAL, who: who.into(), from: "here".into() };
        let (wall, taken) = (at(100 + seconds), at(100));
        Judgement { luggage: LuggageId(1), verdict, issuer, note: None, hot: Hot::NONE, wall, taken, id: None, is_bare: false }
    }

    #[test]
    fn an_interval_is_that_of_the_publications() {
        // Brown, Cai, DasGupta 2001 and common calculators: 81 of 263 gives 0.255 to 0.366, and 0 of 10 gives 0 to 0.278.
        for (count, pieces, low, high) in [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 10, 0.0, 0.2775)] {
            let rate = Rate::of(count, pieces).unwrap();
            assert!((rate.low - low).abs() < 5e-5 && (rate.high - high).abs() < 5e-5, "{count} of {pieces}: {rate:?}");
        }
        assert_eq!(Rate::of(9, 9), None, "nine pieces are too few");
        assert_eq!(Rate::of(0, 0), None);
    }

    #[test]
    fn every_answer_counts_for_its_key_once() {
        let (safe, danger) = (Verdict::Safe, Verdict::Danger);
        let mut both = judged(1, Some(true), ("anna (Anna)", safe, 30));
        both.judged.push(first_answer("bruno", safe, 10));
        let mut changed = judged(2, Some(true), ("bruno", danger, 20));
        changed.judged.push(first_answer("bruno (B.)", safe, 5));
        let doubt = Doubt { who: "anna".into(), wall: at(101), note: None, hot: Hot::NONE };
        changed.unsure = vec![doubt];
        let records: LuggageRecords = [
            both,
            changed,
            judged(3, Some(false), ("anna", danger, 8)),
            judged(4, Some(false), ("anna", safe, 4)),
            judged(5, None, ("anna", danger, 1)),
        ]
        .into_iter()
        .map(Arc::new)
        .collect();
        let scores = Score::of(&records);
        let anna = Score { misses: 1, false_alarms: 1, correct_safe: 1, unsure: 1, took_ms: vec![4000, 8000, 30_000], hits: 0 };
        let bruno = Score { hits: 1, misses: 1, took_ms: vec![10_000, 20_000], ..Score::default() };
        assert_eq!(scores, BTreeMap::from([("anna".into(), anna.clone()), ("bruno".into(), bruno.clone())]));
        assert_eq!((anna.median_ms(), bruno.median_ms(), Score::default().median_ms()), (Some(8000), Some(15_000), None));
    }

    #[test]
    fn an_answer_has_no_time_if_the_clock_was_set() {
        let luggage = Luggage { clock_set_ms: 3_600_000, ..judged(1, Some(true), ("anna", Verdict::Danger, 3607)) };
        let scores = Score::of(&[Arc::new(luggage)].into());
        assert_eq!((scores["anna"].hits, &scores["anna"].took_ms[..]), (1, &[][..]));
    }
}
