//! Limits the rate of commands of one sender: a flood would fill the record and everybody's queue. A STOP is not counted.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use super::publisher::Publisher;
use crate::access::Need;

/// Commands in a second for operators: sixty sensors that report each second, hands at some panels, and a script in a hurry.
const OPERATORS: u32 = 300;

/// Commands in a second for senders whose commands are all refused.
const VIEWERS: u32 = 50;

/// Number of commands of each sender in the second that began then.
#[derive(Debug, Default)]
pub(super) struct Pace(Mutex<HashMap<Arc<str>, (Duration, u32)>>);

impl Pace {
    /// Whether one more command of this sender is accepted, at `now` since the start. There are as many senders as keys.
    pub(super) fn admits(&self, publisher: &Publisher, now: Duration) -> bool {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // A removed key leaves its name behind; nobody creates many keys.
        let (since, said) = all.entry(publisher.issuer().who).or_insert((now, 0));
        if now.saturating_sub(*since) >= Duration::from_secs(1) {
            (*since, *said) = (now, 0);
        }
        *said = said.saturating_add(1);
        *said <= if publisher.may(Need::Act).is_ok() { OPERATORS } else { VIEWERS }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety A5.
    #[test]
    fn whoever_says_too_much_within_a_second_is_not_listened_to_until_the_next() {
        let (pace, publisher) = (Pace::default(), Publisher::Unknown { broker: Arc::from("broker.example") });
        let admitted = |now| (0..2 * OPERATORS).filter(|_| pace.admits(&publisher, now)).count();
        assert_eq!(admitted(Duration::from_millis(1500)), OPERATORS as usize);
        assert_eq!(admitted(Duration::from_millis(2499)), 0);
        assert_eq!(admitted(Duration::from_millis(2500)), OPERATORS as usize);
    }
}
