//! Whether a client publishes in a flood: only such a one is made to wait for those who read.

use std::time::Duration;

use crate::inbound::mqtt::gate::limits::NO_FLOOD;

/// What it has published of late.
#[derive(Debug, Default)]
pub(super) struct Flood {
    since: Duration,
    passed: u64,
}

impl Flood {
    /// Within one second more came than an ordinary client publishes: so many more were passed on by `now`.
    pub(super) fn handle_passed(&mut self, passed: u64, now: Duration) -> bool {
        if now.saturating_sub(self.since) >= Duration::from_secs(1) {
            *self = Flood { since: now, passed: 0 };
        }
        self.passed = self.passed.saturating_add(passed);
        self.passed > NO_FLOOD
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S1: what an ordinary client says is read at once, a stop above all.
    #[test]
    fn only_whoever_says_much_within_a_second_publishes_in_a_flood() {
        let mut flood = Flood::default();
        let at = Duration::from_millis;
        assert!(!flood.handle_passed(NO_FLOOD, at(1500)) && flood.handle_passed(1, at(2000)));
        assert!(!flood.handle_passed(1, at(2500)), "another second");
        assert!(!flood.handle_passed(NO_FLOOD - 1, at(3400)) && flood.handle_passed(1, at(3499)));
    }
}
