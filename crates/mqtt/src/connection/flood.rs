//! Whether a client publishes in a flood, and how long it then waits for one who does not read: only such a one is made to wait.

use std::time::Duration;

use super::ClientConnection;
use crate::limits::{CLIENT_ROOM, NO_FLOOD, STILL, STILL_SHORTEST};

#[derive(Debug, Default)]
pub(super) struct Flood {
    since: Duration,
    passed: u64,
    /// How often it waited in vain, no second having passed in between.
    in_vain: u32,
    /// The last time.
    waited_at: Duration,
}

impl Flood {
    /// Within one second more came than an ordinary client publishes: so many more were passed on by `now`.
    pub(super) fn handle_passed(&mut self, passed: u64, now: Duration) -> bool {
        if now.saturating_sub(self.since) >= Duration::from_secs(1) {
            (self.since, self.passed) = (now, 0);
        }
        self.passed = self.passed.saturating_add(passed);
        self.passed > NO_FLOOD
    }

    /// It waited in vain for somebody who does not read.
    pub(super) const fn handle_waited(&mut self, now: Duration) {
        self.in_vain = self.in_vain.saturating_add(1);
        self.waited_at = now;
    }

    /// How long it waits for the next one: half as long each time, so that any number of them who stop reading one after the other
    /// hold up what it says, something urgent perhaps, no longer than two do.
    pub(super) fn still(&mut self, now: Duration) -> Duration {
        if now.saturating_sub(self.waited_at) >= Duration::from_secs(1) {
            self.in_vain = 0;
        }
        let still = STILL / (1 << self.in_vain.min(16));
        if still < STILL_SHORTEST { Duration::ZERO } else { still }
    }
}

impl ClientConnection {
    /// To be told whenever something has happened: whoever publishes for this client waits for it no longer than for one who reads.
    pub fn note_room(&self, now: Duration) {
        let is_full = self.to_client.len() >= CLIENT_ROOM;
        self.subscription.subscriber().note_still(is_full, !self.unacknowledged.has_window(), now);
    }

    /// Until when it waits for those of [`ClientConnection::poll_behind`], if they do not catch up before: then it is to be asked again.
    #[must_use]
    pub fn waits_until(&mut self, now: Duration) -> Duration {
        now + self.flood.still(now).max(STILL_SHORTEST)
    }

    /// It has waited until then for those who are behind still. Whoever was waited for long enough is not waited for during a while.
    pub fn handle_waited(&mut self, now: Duration) {
        let still = self.flood.still(now);
        let behind = self.routes.behind(now);
        // For all of them together it has waited once.
        if behind.iter().filter(|reader| reader.forgive(now, still)).count() > 0 {
            self.flood.handle_waited(now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What an ordinary client says is read at once, and what is urgent above all.
    #[test]
    fn only_whoever_says_much_within_a_second_publishes_in_a_flood() {
        let mut flood = Flood::default();
        let at = Duration::from_millis;
        assert!(!flood.handle_passed(NO_FLOOD, at(1500)) && flood.handle_passed(1, at(2000)));
        assert!(!flood.handle_passed(1, at(2500)), "another second");
        assert!(!flood.handle_passed(NO_FLOOD - 1, at(3400)) && flood.handle_passed(1, at(3499)));
    }
}
