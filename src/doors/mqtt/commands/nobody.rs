//! Unknown messages of the original system. All of them are counted. The first message of each kind is logged with
//! its text. Later messages are logged at most once a minute, with the count, because other actors may send the same
//! message ten times a second. Known messages are in `qak`.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use hallsweep_core::units::Now;

/// Maximum number of different kinds whose first message is logged.
const KINDS: usize = 64;

/// Maximum length of a kind in bytes. Every known MSGID is much shorter.
const LONGEST: usize = 64;

/// Minimum time between a logged message and the next logged message whose kind was seen before.
const SILENCE: Duration = Duration::from_secs(60);

/// Maximum number of characters of a text in the log.
const TEXT: usize = 200;

#[derive(Debug, Default)]
pub(super) struct Nobody(Mutex<Counted>);

#[derive(Debug, Default)]
struct Counted {
    kinds: BTreeSet<String>,
    count: u64,
    next: Duration,
}

impl Nobody {
    pub(super) fn heard(&self, id: &str, payload: &[u8], now: Now) {
        let count = self.0.lock().unwrap_or_else(PoisonError::into_inner).one_more(id, now.since_start);
        if let Some(not_understood) = count {
            let text: String = String::from_utf8_lossy(payload).chars().take(TEXT).collect();
            tracing::warn!(not_understood, text, "a message on the old topics contains no known command");
        }
    }

    #[cfg(test)]
    pub(super) fn count(&self) -> u64 {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).count
    }
}

impl Counted {
    /// Counts one more unknown message. If this message should be logged, returns the number of unknown messages so
    /// far.
    fn one_more(&mut self, id: &str, now: Duration) -> Option<u64> {
        self.count = self.count.saturating_add(1);
        let is_new = self.kinds.len() < KINDS && id.len() <= LONGEST && self.kinds.insert(id.to_owned());
        if !is_new && now < self.next {
            return None;
        }
        self.next = now + SILENCE;
        Some(self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_is_told_once_and_then_how_many_there_were_each_minute() {
        let mut heard = Counted::default();
        let second = |number| Duration::from_secs(number);
        assert_eq!(heard.one_more("sonar", second(100)), Some(1));
        assert_eq!(heard.one_more("sonar", second(101)), None);
        assert_eq!(heard.one_more("moved", second(102)), Some(3), "another kind");
        let told: Vec<u64> = (103..=162).filter_map(|at| heard.one_more("sonar", second(at))).collect();
        assert_eq!(told, [63], "none is left out of the count");
    }

    /// Safety A5.
    #[test]
    fn kinds_that_are_made_up_fill_neither_log_nor_memory() {
        let mut heard = Counted::default();
        let made_up = (0..1_000).map(|number| format!("kind{number}")).chain([String::new(), "x".repeat(1_000)]);
        let told = made_up.filter_map(|id| heard.one_more(&id, Duration::ZERO)).count();
        assert_eq!((told, heard.kinds.len(), heard.count), (KINDS, KINDS, 1_002));
    }
}
