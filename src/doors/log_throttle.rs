//! Counts events that clients can cause as often as they like. A log line with their number is allowed at a limited
//! rate, because clients must not be able to fill the disk. The caller decides what is logged.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use crate::runtime::clock::Clock;

/// Minimum time between two log lines. Each line contains the number of events. The first event is logged at once.
const SILENCE: Duration = Duration::from_secs(10);

#[derive(Debug, Default)]
pub(super) struct LogThrottle {
    clock: Clock,
    count: Mutex<Count>,
}

#[derive(Debug, Default)]
struct Count {
    unsaid: u64,
    next: Duration,
}

impl LogThrottle {
    /// Counts one more event. Returns the number of events since the last log line if a new line is due, otherwise
    /// `None`.
    pub(super) fn one_more(&self) -> Option<u64> {
        self.count.lock().unwrap_or_else(PoisonError::into_inner).one_more(self.clock.now().since_start)
    }
}

impl Count {
    fn one_more(&mut self, now: Duration) -> Option<u64> {
        self.unsaid = self.unsaid.saturating_add(1);
        if now < self.next {
            return None;
        }
        self.next = now + SILENCE;
        Some(std::mem::take(&mut self.unsaid))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety A5.
    #[test]
    fn however_often_it_is_there_is_a_line_in_ten_seconds_and_none_is_left_out_of_the_count() {
        let mut count = Count::default();
        let said: Vec<(u64, u64)> =
            (0..25_000).filter_map(|ms| count.one_more(Duration::from_millis(ms)).map(|refused| (ms, refused))).collect();
        assert_eq!(said, [(0, 1), (10_000, 10_000), (20_000, 10_000)]);
        assert_eq!(count.one_more(Duration::from_secs(3600)), Some(5000), "the rest of them and this one");
    }
}
