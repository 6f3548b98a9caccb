//! CPU time of a piece of work, without the time that other processes use.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// CPU time of this thread. The call itself takes a quarter of a microsecond, which every figure includes.
fn now() -> Duration {
    let spent = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(u64::try_from(spent.tv_sec).unwrap_or(0), u32::try_from(spent.tv_nsec).unwrap_or(0))
}

/// CPU time of the work, and its result.
pub(crate) fn timed<R>(work: impl FnOnce() -> R) -> (Duration, R) {
    let start = now();
    let result = work();
    (now().saturating_sub(start), result)
}

/// CPU times of repeated work.
#[derive(Clone, Debug, Default)]
pub(crate) struct Times(Vec<Duration>);

impl Times {
    pub(crate) fn add(&mut self, time: Duration) {
        self.0.push(time);
    }

    /// Joins two lists of times.
    pub(crate) fn and(mut self, other: Times) -> Times {
        self.0.extend(other.0);
        self
    }

    /// Takes the shorter time of each pair from two equal runs, because a disturbance rarely hits the same step in
    /// both.
    pub(crate) fn shorter(self, other: &Times) -> Times {
        assert_eq!(self.0.len(), other.0.len(), "both runs did the same");
        Times(self.0.into_iter().zip(&other.0).map(|(one, two)| one.min(*two)).collect())
    }

    pub(crate) fn mean(&self) -> Duration {
        self.0.iter().sum::<Duration>() / u32::try_from(self.0.len().max(1)).unwrap_or(u32::MAX)
    }

    pub(crate) fn worst(&self) -> Duration {
        self.0.iter().max().copied().unwrap_or_default()
    }

    /// Percentile of the times.
    pub(crate) fn within(&self, hundredths: usize) -> Duration {
        let mut sorted = self.0.clone();
        sorted.sort_unstable();
        sorted.get(sorted.len().saturating_sub(1) * hundredths / 100).copied().unwrap_or_default()
    }
}

/// Converts a time to microseconds.
pub(crate) fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

pub(crate) fn ratio(one: Duration, other: Duration) -> f64 {
    one.as_secs_f64() / other.as_secs_f64().max(1e-9)
}
