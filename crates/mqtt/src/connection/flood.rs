//! Whether a client publishes in a flood, and how long a flooding client waits for a subscriber that does not read.
//! Clients that publish at an ordinary rate never wait.

use std::time::Duration;

use super::ClientConnection;
use crate::limits::{CLIENT_ROOM, NO_FLOOD, STILL, STILL_SHORTEST};

#[derive(Debug, Default)]
pub(super) struct Flood {
    since: Duration,
    passed: u64,
    /// Number of failed waits in a row, each less than a second after the one before. A wait fails if a subscriber
    /// still lags behind when the wait ends.
    in_vain: u32,
    /// Time of the last failed wait.
    waited_at: Duration,
}

impl Flood {
    /// Counts `passed` further messages. Returns whether more than `NO_FLOOD` were passed on within one second.
    pub(super) fn handle_passed(&mut self, passed: u64, now: Duration) -> bool {
        if now.saturating_sub(self.since) >= Duration::from_secs(1) {
            (self.since, self.passed) = (now, 0);
        }
        self.passed = self.passed.saturating_add(passed);
        self.passed > NO_FLOOD
    }

    pub(super) const fn handle_waited(&mut self, now: Duration) {
        self.in_vain = self.in_vain.saturating_add(1);
        self.waited_at = now;
    }

    /// How long to wait for the next subscriber that does not read. Each wait is half as long as the one before, so
    /// all waits together are less than twice the first, however many subscribers stop reading. Waits have to be
    /// short, because an urgent message of this client may come next.
    pub(super) fn still(&mut self, now: Duration) -> Duration {
        if now.saturating_sub(self.waited_at) >= Duration::from_secs(1) {
            self.in_vain = 0;
        }
        let still = STILL / (1 << self.in_vain.min(16));
        if still < STILL_SHORTEST { Duration::ZERO } else { still }
    }
}

impl ClientConnection {
    /// Notes whether this client has stopped reading. Publishers wait only briefly for such a client. Call this after
    /// every event.
    pub fn note_room(&self, now: Duration) {
        let is_full = self.to_client.len() >= CLIENT_ROOM;
        self.subscription.subscriber().note_still(is_full, !self.unacknowledged.has_window(), now);
    }

    /// When to stop waiting for the subscribers that [`ClientConnection::poll_behind`] returned. If they still lag
    /// behind at that time, call [`ClientConnection::handle_waited`].
    #[must_use]
    pub fn waits_until(&mut self, now: Duration) -> Duration {
        now + self.flood.still(now).max(STILL_SHORTEST)
    }

    /// Ends a wait for subscribers that still lag behind. If publishers have waited long enough for a subscriber,
    /// none of them waits for it again for some time.
    pub fn handle_waited(&mut self, now: Duration) {
        let still = self.flood.still(now);
        let behind = self.routes.behind(now);
        // All these subscribers together count as one wait.
        if behind.iter().filter(|reader| reader.forgive(now, still)).count() > 0 {
            self.flood.handle_waited(now);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The messages of a client that publishes at an ordinary rate are read at once. This matters most for urgent
    /// messages.
    #[test]
    fn only_whoever_says_much_within_a_second_publishes_in_a_flood() {
        let mut flood = Flood::default();
        let at = Duration::from_millis;
        assert!(!flood.handle_passed(NO_FLOOD, at(1500)) && flood.handle_passed(1, at(2000)));
        assert!(!flood.handle_passed(1, at(2500)), "another second");
        assert!(!flood.handle_passed(NO_FLOOD - 1, at(3400)) && flood.handle_passed(1, at(3499)));
    }
}
