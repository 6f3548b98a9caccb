//! How far each subscriber is behind: what was published for it and has not come out of the engine yet. The engine takes messages as
//! fast as they come, and loses those of whoever lags too far behind; so whoever publishes in a flood is made to wait for those who
//! read. A subscriber who does not read is not waited for long, and then for a good while not at all: he alone misses messages.
//!
//! ```text
//!   publisher ─ owe(1 for every filter that matches) ─► Ledger ◄─ came(n) ─ subscriber
//!        waits while it is more than LAG behind, until it is no more than RELIEF, or until it is forgiven
//! ```

use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;

use super::filter::matches;
use super::limits::{FORGIVEN, FORGIVEN_LONGEST, LAG, LONG, RELIEF};

/// What one subscriber is owed.
#[derive(Debug, Default)]
pub struct Ledger {
    /// Messages that were published for it and have not come. Messages that the engine lost are forgiven with the rest.
    lag: AtomicI64,
    relief: Notify,
    /// Until then nobody waits for it, in milliseconds on the clock of all connections;
    forgiven_until_ms: AtomicU64,
    /// and how long that was the last time, in milliseconds; 0: it kept up since.
    forgiven_for_ms: AtomicU64,
}

/// A subscriber's own ledger, which is closed when this is dropped.
#[derive(Debug)]
pub(super) struct Account {
    ledger: Arc<Ledger>,
    ledgers: Arc<Ledgers>,
}

/// The ledgers of all who subscribe, with their filters.
#[derive(Debug, Default)]
pub struct Ledgers {
    /// Raised by every change, so that who looked before looks again.
    generation: AtomicU64,
    held: Mutex<Vec<(Arc<str>, Arc<Ledger>)>>,
}

/// What a message with so long a payload counts.
pub(super) const fn weight(payload: usize) -> i64 {
    1 + (payload / LONG) as i64
}

/// Those who get what is published on a topic: one for each filter of theirs that matches.
pub(super) type Readers = Arc<[Arc<Ledger>]>;

impl Ledger {
    /// So many messages were published for it; whether it is behind now.
    pub(super) fn owe(&self, messages: i64) -> bool {
        self.lag.fetch_add(messages, Ordering::Relaxed) + messages > LAG
    }

    /// So many came out of the engine.
    fn came(&self, messages: i64) {
        let before = self.lag.fetch_sub(messages, Ordering::Relaxed);
        let lag = before - messages;
        if lag < 0 {
            // It was not known yet as a subscriber when they were published.
            self.lag.fetch_max(0, Ordering::Relaxed);
        }
        if before > RELIEF && lag <= RELIEF {
            self.forgiven_for_ms.store(0, Ordering::Relaxed);
            self.relief.notify_waiters();
        }
    }

    /// Whether publishers are to wait for it.
    #[must_use]
    pub fn is_behind(&self, now: Duration) -> bool {
        self.lag.load(Ordering::Relaxed) > LAG && ms(now) >= self.forgiven_until_ms.load(Ordering::Relaxed)
    }

    /// Whether everything that was published for it has come, as far as anybody knows.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.lag.load(Ordering::Relaxed) <= 0
    }

    /// Waits until it has caught up, or nobody waits for it any more.
    pub async fn relieved(&self) {
        loop {
            let relief = self.relief.notified();
            if self.lag.load(Ordering::Relaxed) <= RELIEF {
                return;
            }
            relief.await;
        }
    }

    /// It was waited for long enough: its debts are forgotten, and it is not waited for during a while, longer each time.
    pub fn forgive(&self, now: Duration) {
        let last = self.forgiven_for_ms.load(Ordering::Relaxed);
        let next = (2 * last).clamp(ms(FORGIVEN), ms(FORGIVEN_LONGEST));
        self.forgiven_for_ms.store(next, Ordering::Relaxed);
        self.forgiven_until_ms.store(ms(now) + next, Ordering::Relaxed);
        self.lag.store(0, Ordering::Relaxed);
        self.relief.notify_waiters();
    }
}

impl Account {
    /// An account of somebody who holds no filter yet.
    pub(super) fn open(ledgers: &Arc<Ledgers>) -> Account {
        Account { ledger: Arc::default(), ledgers: Arc::clone(ledgers) }
    }

    /// What he is owed.
    pub(super) fn ledger(&self) -> Arc<Ledger> {
        Arc::clone(&self.ledger)
    }

    /// He holds a filter.
    pub(super) fn enter(&self, filter: &Arc<str>) {
        self.ledgers.enter(filter, &self.ledger);
    }

    /// He holds it no more.
    pub(super) fn strike(&self, filter: &str) {
        self.ledgers.strike(filter, &self.ledger);
    }

    /// So many messages came for him.
    pub(super) fn came(&self, messages: i64) {
        if messages > 0 {
            self.ledger.came(messages);
        }
    }
}

impl Drop for Account {
    fn drop(&mut self) {
        self.ledgers.close(&self.ledger);
    }
}

impl Ledgers {
    /// Somebody holds a filter.
    fn enter(&self, filter: &Arc<str>, ledger: &Arc<Ledger>) {
        let mut held = self.held();
        if !held.iter().any(|(known, whose)| known == filter && Arc::ptr_eq(whose, ledger)) {
            held.push((Arc::clone(filter), Arc::clone(ledger)));
            self.generation.fetch_add(1, Ordering::Release);
        }
    }

    /// Somebody holds it no more.
    fn strike(&self, filter: &str, ledger: &Arc<Ledger>) {
        self.keep(|known, whose| known != filter || !Arc::ptr_eq(whose, ledger));
    }

    /// Somebody has gone, and whoever waits for him need not.
    fn close(&self, ledger: &Arc<Ledger>) {
        self.keep(|_, whose| !Arc::ptr_eq(whose, ledger));
        ledger.lag.store(0, Ordering::Relaxed);
        ledger.relief.notify_waiters();
    }

    /// What changes whenever the readers of any topic may have.
    pub(super) fn generation(&self) -> u64 {
        self.generation.load(Ordering::Acquire)
    }

    /// Those who get what is published on this topic.
    pub(super) fn readers(&self, topic: &str) -> Readers {
        self.held().iter().filter(|(filter, _)| matches(filter, topic)).map(|(_, ledger)| Arc::clone(ledger)).collect()
    }

    fn keep(&self, keep: impl Fn(&str, &Arc<Ledger>) -> bool) {
        self.held().retain(|(filter, ledger)| keep(filter, ledger));
        self.generation.fetch_add(1, Ordering::Release);
    }

    fn held(&self) -> MutexGuard<'_, Vec<(Arc<str>, Arc<Ledger>)>> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn ms(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Duration = Duration::from_secs(100);

    #[tokio::test]
    async fn whoever_lags_is_waited_for_until_he_has_caught_up() {
        let ledger = Arc::new(Ledger::default());
        assert!(!ledger.owe(LAG) && !ledger.is_behind(NOW));
        assert!(ledger.owe(1) && ledger.is_behind(NOW));
        let waiting = tokio::spawn({
            let ledger = Arc::clone(&ledger);
            async move { ledger.relieved().await }
        });
        tokio::task::yield_now().await;
        ledger.came(LAG - RELIEF + 1);
        waiting.await.expect("he has caught up");
    }

    /// Safety A5.
    #[test]
    fn whoever_does_not_read_is_not_waited_for_longer_and_longer() {
        let ledger = Ledger::default();
        let fall_behind = || assert!(ledger.owe(LAG + 1));
        fall_behind();
        ledger.forgive(NOW);
        fall_behind();
        assert!(!ledger.is_behind(NOW + FORGIVEN - Duration::from_millis(1)));
        assert!(ledger.is_behind(NOW + FORGIVEN));
        ledger.forgive(NOW);
        fall_behind();
        assert!(!ledger.is_behind(NOW + FORGIVEN) && ledger.is_behind(NOW + 2 * FORGIVEN));
        ledger.came(LAG + 1);
        ledger.forgive(NOW);
        fall_behind();
        assert!(ledger.is_behind(NOW + FORGIVEN), "he had kept up in between");
    }

    #[test]
    fn it_is_settled_when_everything_has_come() {
        let ledger = Ledger::default();
        assert!(ledger.is_settled());
        assert!(!ledger.owe(2) && !ledger.is_settled());
        ledger.came(1);
        assert!(!ledger.is_settled());
        ledger.came(1);
        assert!(ledger.is_settled());
    }

    #[test]
    fn what_nobody_counted_when_it_was_published_is_no_credit() {
        let ledger = Ledger::default();
        ledger.came(5000);
        assert!(ledger.owe(LAG + 1) && ledger.is_behind(NOW));
    }

    #[test]
    fn a_message_is_owed_once_for_every_filter_that_matches() {
        let (ledgers, one, other) = (Ledgers::default(), Arc::new(Ledger::default()), Arc::new(Ledger::default()));
        for (filter, ledger) in [("a/#", &one), ("a/+", &one), ("a/+", &one), ("b", &other)] {
            ledgers.enter(&Arc::from(filter), ledger);
        }
        assert_eq!(ledgers.readers("a/x").len(), 2);
        let before = ledgers.generation();
        ledgers.strike("a/+", &one);
        assert!(ledgers.generation() > before && ledgers.readers("a/x").len() == 1);
        ledgers.close(&one);
        assert_eq!((ledgers.readers("a/x").len(), ledgers.readers("b").len()), (0, 1));
    }
}
