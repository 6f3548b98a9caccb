//! The duration of a run of the Roomba, in whole ticks, and its limits.

use std::str::FromStr;

use super::room::{TICKS_PER_SECOND, seconds};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunLength {
    ticks: u32,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a length of a run: give 1 to {most} seconds", most = RunLength::LONGEST_S)]
pub struct RunLengthError(String);

impl RunLength {
    /// The longest run, in seconds. The frames of an hour take 10 MB.
    pub const LONGEST_S: u32 = 3600;

    /// A duration of 1 to `LONGEST_S` seconds, rounded to a whole tick.
    ///
    /// # Errors
    /// When `seconds` is outside these limits or not a number.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is within 1..=3600 seconds")]
    pub fn from_seconds(seconds: f64) -> Result<RunLength, RunLengthError> {
        if !(1.0..=f64::from(RunLength::LONGEST_S)).contains(&seconds) {
            return Err(RunLengthError(seconds.to_string()));
        }
        Ok(RunLength { ticks: (seconds * f64::from(TICKS_PER_SECOND)).round() as u32 })
    }

    #[must_use]
    pub fn seconds(self) -> f64 {
        seconds(self.ticks)
    }

    pub(super) const fn ticks(self) -> u32 {
        self.ticks
    }
}

impl FromStr for RunLength {
    type Err = RunLengthError;

    fn from_str(text: &str) -> Result<RunLength, RunLengthError> {
        let wrong = |_| RunLengthError(text.to_owned());
        let seconds = text.trim().parse::<f64>().map_err(|_| RunLengthError(text.to_owned()))?;
        RunLength::from_seconds(seconds).map_err(wrong)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_lasts_from_a_second_to_an_hour() {
        for (text, ticks) in [("1", 60), ("60", 3600), (" 2.5 ", 150), ("3600", 216_000), ("1e2", 6000)] {
            assert_eq!(text.parse().map(RunLength::ticks), Ok(ticks), "{text}");
        }
    }

    #[test]
    fn what_is_no_length_is_refused_by_its_own_words() {
        for text in ["0", "0.99", "-5", "3600.1", "1e300", "NaN", "inf", "", "a minute", "60s"] {
            let said = text.parse::<RunLength>().unwrap_err().to_string();
            assert_eq!(said, format!("{text:?} is not a length of a run: give 1 to 3600 seconds"));
        }
    }
}
