//! The only place where the real clock is read.
#![expect(clippy::disallowed_methods, reason = "somebody has to look at the clock, and it is done here")]

use std::time::Duration;

use tokio::time::Instant;

use hallsweep_core::units::{Now, WallTime};

/// The real clock, and the time since this value was created. In tests that pause tokio's time, the time since
/// creation is paused, too.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    start: Instant,
    /// Wall clock at the start, in milliseconds since 1970.
    start_ms: i64,
    /// Simulated error of the machine's clock, in milliseconds; only tests set it.
    off_ms: i64,
}

impl Default for Clock {
    fn default() -> Clock {
        Clock { start: Instant::now(), start_ms: jiff::Timestamp::now().as_millisecond(), off_ms: 0 }
    }
}

impl Clock {
    #[cfg(test)]
    pub(crate) fn off_by(off_ms: i64) -> Clock {
        Clock::default().set_by(off_ms)
    }

    #[cfg(test)]
    pub(crate) fn set_by(self, off_ms: i64) -> Clock {
        Clock { off_ms, ..self }
    }

    pub fn now(&self) -> Now {
        let zoned = jiff::Zoned::now();
        let wall = WallTime { unix_ms: zoned.timestamp().as_millisecond() + self.off_ms, offset_s: zoned.offset().seconds() };
        Now { since_start: self.start.elapsed(), wall }
    }

    /// Returns by how many milliseconds the wall clock was set since the start.
    pub fn set_ms(&self, now: Now) -> i64 {
        let elapsed = i64::try_from(now.since_start.as_millis()).unwrap_or(i64::MAX);
        now.wall.unix_ms.saturating_sub(self.start_ms).saturating_sub(elapsed)
    }

    /// The time since the start. Faster than `now`, which also computes the date.
    pub fn since_start(&self) -> Duration {
        self.start.elapsed()
    }

    pub fn instant(&self, since_start: Duration) -> Instant {
        self.start + since_start
    }

    pub async fn reach(&self, since_start: Option<Duration>) {
        match since_start {
            Some(since_start) => tokio::time::sleep_until(self.instant(since_start)).await,
            None => std::future::pending().await,
        }
    }
}
