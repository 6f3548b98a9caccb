//! The speed of simulated time compared with real time. `robots::sim::link` of the program applies this speed.

use std::fmt;
use std::time::Duration;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// A multiple of real time, `SLOWEST..=FASTEST`; 1 is real time.
    Times(f64),
    /// As fast as possible: time jumps to the end of the current order.
    Max,
}

impl Speed {
    /// The slowest speed. At a lower speed, a robot would seem to hang.
    pub const SLOWEST: f64 = 0.1;
    /// The highest speed. Timers have a resolution of one millisecond, so a greater factor would not be faster.
    pub const FASTEST: f64 = 1000.0;

    /// The ratio of simulated time to real time. Durations that are reported to the core are divided by it, and
    /// deadlines from the core are multiplied by it.
    #[must_use]
    pub const fn factor(self) -> f64 {
        match self {
            Speed::Times(factor) if factor >= Speed::SLOWEST && factor <= Speed::FASTEST => factor,
            Speed::Times(_) => 1.0,
            Speed::Max => Speed::FASTEST,
        }
    }

    /// The speed of simulated time while it runs. With `Max`, simulated time runs at real speed between its jumps.
    pub const fn pace(self) -> f64 {
        match self {
            Speed::Times(_) => self.factor(),
            Speed::Max => 1.0,
        }
    }

    pub fn to_real(self, simulated: Duration) -> Duration {
        times(simulated, 1.0 / self.factor())
    }

    pub fn to_simulated(self, real: Duration) -> Duration {
        times(real, self.factor())
    }
}

/// Multiplies a duration by a factor. If the product is too long, returns the longest possible duration.
#[must_use]
pub fn times(duration: Duration, factor: f64) -> Duration {
    Duration::try_from_secs_f64(duration.as_secs_f64() * factor).unwrap_or(Duration::MAX)
}

impl fmt::Display for Speed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Speed::Times(factor) => write!(f, "{factor}"),
            Speed::Max => f.write_str("max"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_scaled_and_never_overflow() {
        assert_eq!(Speed::Times(2.0).to_real(Duration::from_millis(330)), Duration::from_millis(165));
        assert_eq!(Speed::Max.to_simulated(Duration::MAX), Duration::MAX);
    }
}
