//! The mean time per cell in the search so far, measured from the robot's moves. A forecast is based on it. It is
//! measured again in each run of the program.

use std::time::Duration;

use super::forecast::FEW;

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pace {
    driven: Duration,
    /// Number of cells that were already known when the first move was counted.
    before: Option<u32>,
}

impl Pace {
    pub(crate) fn count(&mut self, took: Duration, looked_at: u32) {
        self.before.get_or_insert(looked_at.saturating_sub(1));
        self.driven = self.driven.saturating_add(took);
    }

    /// Returns the mean time per cell; `None` while there are too few cells for a mean.
    pub(crate) fn a_cell(&self, looked_at: u32) -> Option<Duration> {
        let cells = looked_at.checked_sub(self.before?).filter(|cells| *cells >= FEW)?;
        Some(self.driven / cells).filter(|time| !time.is_zero())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_takes_the_mean_of_what_was_counted() {
        let second = Duration::from_secs(1);
        let mut pace = Pace::default();
        assert_eq!(pace.a_cell(100), None, "nothing was counted");
        for looked_at in 51..58 {
            pace.count(2 * second, looked_at);
        }
        assert_eq!(pace.a_cell(57), None, "too few cells");
        pace.count(6 * second, 58);
        assert_eq!(pace.a_cell(58), Some(20 * second / 8));
        let mut at_once = Pace::default();
        at_once.count(Duration::ZERO, 1);
        assert_eq!(at_once.a_cell(100), None, "simulated at full speed nothing takes any time");
    }
}
