//! How long something takes the processor: what others do on the machine meanwhile is left out.

use std::time::Duration;

use rustix::time::{ClockId, clock_gettime};

/// The time of the processor that this thread has had. To ask takes a quarter of a microsecond, which is part of every figure.
fn now() -> Duration {
    let spent = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(u64::try_from(spent.tv_sec).unwrap_or(0), u32::try_from(spent.tv_nsec).unwrap_or(0))
}

/// How long the work took, and what came of it.
pub(crate) fn timed<R>(work: impl FnOnce() -> R) -> (Duration, R) {
    let start = now();
    let result = work();
    (now().saturating_sub(start), result)
}

/// How long the same thing took many times.
#[derive(Clone, Debug, Default)]
pub(crate) struct Times(Vec<Duration>);

impl Times {
    pub(crate) fn add(&mut self, time: Duration) {
        self.0.push(time);
    }

    /// Both together.
    pub(crate) fn and(mut self, other: Times) -> Times {
        self.0.extend(other.0);
        self
    }

    /// Of two runs that did the same, each time the shorter one: what disturbs a run disturbs the other elsewhere.
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

    /// So many hundredths of the times are at most this long.
    pub(crate) fn within(&self, hundredths: usize) -> Duration {
        let mut sorted = self.0.clone();
        sorted.sort_unstable();
        sorted.get(sorted.len().saturating_sub(1) * hundredths / 100).copied().unwrap_or_default()
    }
}

/// In microseconds.
pub(crate) fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

/// How many times as long one is as the other.
pub(crate) fn ratio(one: Duration, other: Duration) -> f64 {
    one.as_secs_f64() / other.as_secs_f64().max(1e-9)
}
