//! Logs refusals of a client: the first, and then the second, fourth, eighth and so on. The log is limited because a
//! client may be refused for ever, and may reconnect at any time.

use std::fmt::Display;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Maximum number of characters of a client's text in the log.
const SHOWN: usize = 80;

/// Maximum number of lines about refusals of all clients in one `PERIOD`.
const LINES: u32 = 20;

/// The period for which `LINES` are counted.
const PERIOD: Duration = Duration::from_secs(10);

/// The end of the current period, and the number of lines that all clients together requested in it.
#[derive(Debug, Default)]
pub(crate) struct Lines(Mutex<(Duration, u32)>);

#[derive(Debug)]
pub(super) struct Refusals {
    name: Arc<str>,
    count: u64,
}

impl Lines {
    pub(crate) fn admit(&self, now: Duration) -> bool {
        let mut lines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if now >= lines.0 {
            *lines = (now + PERIOD, 0);
        }
        lines.1 = lines.1.saturating_add(1);
        lines.1 <= LINES
    }
}

impl Refusals {
    pub(super) const fn new(name: Arc<str>) -> Refusals {
        Refusals { name, count: 0 }
    }

    pub(super) fn note(&mut self, topic: &[u8], why: impl Display, lines: &Lines, now: Duration) {
        self.count += 1;
        if self.count.is_power_of_two() && lines.admit(now) {
            let topic: String = String::from_utf8_lossy(topic).chars().take(SHOWN).collect();
            tracing::warn!(client = %self.name, topic, refused = self.count, "refused over MQTT; the latest reason: {why}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety A5: the number of lines is bounded, however many refusals there are.
    #[test]
    fn so_many_lines_are_written_in_a_while_and_no_more() {
        let (lines, at) = (Lines::default(), Duration::from_secs);
        assert_eq!((0..1000).filter(|_| lines.admit(at(5))).count(), LINES as usize);
        assert!(!lines.admit(at(14)) && lines.admit(at(15)));
    }
}
