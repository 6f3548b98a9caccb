//! The speed of simulated time beside real time. `robots::sim::link` of the program makes time pass at this speed.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Speed {
    /// A multiple of real time, `SLOWEST..=FASTEST`; 1 is real time.
    Times(f64),
    /// No waiting: time jumps to the end of the order under way.
    Max,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a speed: give `max`, or a number from 0.1 to 1000 (1 is real time)")]
pub struct SpeedError(String);

impl Speed {
    /// The slowest speed; a slower robot would seem to hang.
    pub const SLOWEST: f64 = 0.1;
    /// The fastest speed; timers are no finer than a millisecond, so more would not be quicker.
    pub const FASTEST: f64 = 1000.0;

    /// Simulated durations are divided by this factor when they are reported to the core; deadlines of the core are
    /// multiplied by it.
    #[must_use]
    pub const fn factor(self) -> f64 {
        match self {
            Speed::Times(factor) if factor >= Speed::SLOWEST && factor <= Speed::FASTEST => factor,
            Speed::Times(_) => 1.0,
            Speed::Max => Speed::FASTEST,
        }
    }

    /// How fast simulated time runs while nothing jumps.
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

/// A duration times a factor; the longest possible duration if the product is too long.
#[must_use]
pub fn times(duration: Duration, factor: f64) -> Duration {
    Duration::try_from_secs_f64(duration.as_secs_f64() * factor).unwrap_or(Duration::MAX)
}

impl FromStr for Speed {
    type Err = SpeedError;

    fn from_str(text: &str) -> Result<Speed, SpeedError> {
        if text.trim() == "max" {
            return Ok(Speed::Max);
        }
        let factor = text.trim().parse::<f64>().ok().filter(|factor| (Speed::SLOWEST..=Speed::FASTEST).contains(factor));
        factor.map(Speed::Times).ok_or_else(|| SpeedError(text.to_owned()))
    }
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
    fn a_speed_is_a_number_or_max() {
        assert_eq!("1".parse(), Ok(Speed::Times(1.0)));
        assert_eq!("2.5".parse(), Ok(Speed::Times(2.5)));
        assert_eq!("max".parse(), Ok(Speed::Max));
        for wrong in ["", "0", "-1", "1001", "nan", "inf", "fast"] {
            assert!(wrong.parse::<Speed>().is_err(), "{wrong}");
        }
        let words = "fast".parse::<Speed>().unwrap_err().to_string();
        assert_eq!(words, "\"fast\" is not a speed: give `max`, or a number from 0.1 to 1000 (1 is real time)");
    }

    #[test]
    fn durations_are_scaled_and_never_overflow() {
        assert_eq!(Speed::Times(2.0).to_real(Duration::from_millis(330)), Duration::from_millis(165));
        assert_eq!(Speed::Max.to_simulated(Duration::MAX), Duration::MAX);
    }
}
