//! Whether the broker is well, as the session finds it, and when it is called ill. What is done about that is not decided here.

use tokio::sync::watch;

/// One echo may be missed, as when the machine is held for two seconds.
const MISSES: u32 = 2;

/// A port that cannot be reached may be one that is just being opened.
const TRIES: u32 = 3;

/// How the broker is. An illness is told again while it lasts, each time as a change of the watch; why, is in the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Health {
    Unproven,
    /// It brought back what was sent to it; or, if it is somebody else's, it greeted us and took our subscription.
    Well,
    /// It does not, or it cannot be reached.
    Ill,
}

#[derive(Debug)]
pub(super) struct HealthTracker {
    told: watch::Sender<Health>,
    misses: u32,
    tries: u32,
}

impl HealthTracker {
    pub(super) fn new(told: watch::Sender<Health>) -> HealthTracker {
        HealthTracker { told, misses: 0, tries: 0 }
    }

    /// It has proved that it is well.
    pub(super) fn handle_proof(&mut self) {
        (self.misses, self.tries) = (0, 0);
        self.told.send_if_modified(|health| {
            let is_news = *health != Health::Well;
            *health = Health::Well;
            is_news
        });
    }

    /// An echo did not come; whether it is ill, so that the connection is to be given up.
    pub(super) fn handle_miss(&mut self) -> bool {
        self.misses += 1;
        let is_ill = self.misses >= MISSES;
        if is_ill {
            self.tell_ill();
        }
        is_ill
    }

    /// It could not be reached, or it was lost.
    pub(super) fn handle_lost(&mut self) {
        self.tries += 1;
        if self.tries >= TRIES {
            self.tell_ill();
        }
    }

    fn tell_ill(&mut self) {
        (self.misses, self.tries) = (0, 0);
        self.told.send_replace(Health::Ill);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tracker() -> (HealthTracker, watch::Receiver<Health>) {
        let (told, health) = watch::channel(Health::Unproven);
        (HealthTracker::new(told), health)
    }

    fn is_ill(health: &watch::Receiver<Health>) -> bool {
        *health.borrow() == Health::Ill
    }

    #[test]
    fn one_miss_is_forgiven_and_the_second_in_a_row_is_not() {
        let (mut tracker, health) = tracker();
        assert!(!tracker.handle_miss());
        tracker.handle_proof();
        assert!(!tracker.handle_miss());
        assert_eq!(*health.borrow(), Health::Well);
        assert!(tracker.handle_miss());
        assert!(is_ill(&health));
    }

    #[test]
    fn the_third_try_in_vain_is_an_illness_and_every_third_after_it_again() {
        let (mut tracker, mut health) = tracker();
        for _ in 0..3 {
            for _ in 0..2 {
                tracker.handle_lost();
                assert!(!health.has_changed().expect("it is told"));
            }
            tracker.handle_lost();
            assert!(health.has_changed().expect("it is told") && is_ill(&health));
            health.mark_unchanged();
        }
        tracker.handle_proof();
        assert_eq!(*health.borrow(), Health::Well);
    }

    #[test]
    fn health_is_told_once() {
        let (mut tracker, mut health) = tracker();
        tracker.handle_proof();
        health.mark_unchanged();
        tracker.handle_proof();
        assert!(!health.has_changed().expect("it is told"));
    }
}
