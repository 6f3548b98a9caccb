//! Limit of the commands that one sender may send per second. A flood would fill the journal and delay everybody's
//! commands. STOP does not count: the caller checks for a STOP before it calls this.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Maximum number of commands per second from a sender with the right to give commands. This is enough for sixty
/// sensors that report each second, some people at panels, and a script.
const OPERATORS: u32 = 300;

/// Maximum number of commands per second from a sender without that right, whose commands are all refused.
const VIEWERS: u32 = 50;

/// For each sender: the start of its current second, and the number of commands in that second. The start is the
/// value of `now` in `admits`.
#[derive(Debug, Default)]
pub(in crate::doors) struct CommandRate(Mutex<HashMap<Arc<str>, (Duration, u32)>>);

impl CommandRate {
    /// Counts a command; returns whether the sender is still within its limit. Refused commands count too. `now` is a
    /// time of the caller's clock. The table has at most one entry per key.
    pub(in crate::doors) fn admits(&self, sender: Arc<str>, is_viewer: bool, now: Duration) -> bool {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // The entry of a removed key stays in the table. Few keys are ever created, so the table stays small.
        let (since, said) = all.entry(sender).or_insert((now, 0));
        if now.saturating_sub(*since) >= Duration::from_secs(1) {
            (*since, *said) = (now, 0);
        }
        *said = said.saturating_add(1);
        *said <= if is_viewer { VIEWERS } else { OPERATORS }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety A5.
    #[test]
    fn whoever_says_too_much_within_a_second_is_not_listened_to_until_the_next() {
        let rate = CommandRate::default();
        let admitted = |now| (0..2 * OPERATORS).filter(|_| rate.admits(Arc::from("mqtt"), false, now)).count();
        assert_eq!(admitted(Duration::from_millis(1500)), OPERATORS as usize);
        assert_eq!(admitted(Duration::from_millis(2499)), 0);
        assert_eq!(admitted(Duration::from_millis(2500)), OPERATORS as usize);
    }
}
