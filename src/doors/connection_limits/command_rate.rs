//! Limit of the commands that one sender may send per second. A flood would fill the journal and delay everybody's commands.
//! STOP is not counted: the caller looks for a STOP first, and asks here only about other messages.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Maximum commands per second of a sender whose commands may be accepted: sixty sensors that report each second, people at
/// some panels, and a script.
const OPERATORS: u32 = 300;

/// Maximum commands per second of a sender whose commands are all refused.
const VIEWERS: u32 = 50;

/// Per sender: the start of the current second, counted from when the door was made, and the number of commands in that second.
#[derive(Debug, Default)]
pub(in crate::doors) struct CommandRate(Mutex<HashMap<Arc<str>, (Duration, u32)>>);

impl CommandRate {
    /// Counts a command, whether or not it is refused. `now` is the time since the door was made. The table has at most one
    /// entry per key.
    pub(in crate::doors) fn admits(&self, sender: Arc<str>, is_viewer: bool, now: Duration) -> bool {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // The entry of a removed key stays; nobody creates many keys.
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
