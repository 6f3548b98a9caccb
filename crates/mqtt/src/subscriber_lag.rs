//! How far each subscriber is behind: what was published for it and has not come out of the router yet. The router takes messages as
//! fast as they come, and loses those of whoever lags too far behind; so whoever publishes in a flood is made to wait for those who
//! read. A subscriber who does not read is not waited for long, and then for a good while not at all: he alone misses messages, and
//! it is noted that he did. Who reads what stands in `readers`.
//!
//! ```text
//!   publisher ─ owe(its bytes, for every filter that matches) ─► SubscriberLag ◄─ came(bytes) ─ subscriber
//!        waits while it is more than LAG behind, until it is no more than RELIEF, or until it is forgiven
//! ```

use std::future::poll_fn;
use std::sync::atomic::{AtomicI64, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use bytes::Bytes;

use super::limits::{FORGIVEN, FORGIVEN_LONGEST, HEAVIEST, LAG, MENDED, PADDED, PATIENCE, RELIEF, ROUTER_HOLDS, ROUTER_KEEPS};
use super::parcels::{Label, Parcels};
use super::readers::Readers;

/// What the router counts for a message beside its topic and payload.
pub(crate) const COUNTED: usize = 4;

/// Nothing was missed.
const NOTHING: u64 = u64::MAX;

/// What one subscriber is owed.
#[derive(Debug)]
pub struct SubscriberLag {
    /// Bytes of messages that were published for it and have not come.
    lag: AtomicI64,
    /// The long ones among them.
    parcels: Mutex<Parcels>,
    /// How many filters it holds: the router keeps messages for each.
    filters: AtomicI64,
    /// Who is to be woken when it has caught up.
    waiting: Mutex<Vec<Waker>>,
    /// Since when it was behind whenever somebody looked, in milliseconds on the clock of all connections; 0: it is not.
    behind_since_ms: AtomicU64,
    /// Since when its client keeps more from coming, on the same clock; 0: it takes what comes.
    still_since_ms: AtomicU64,
    /// Until then nobody waits for it;
    forgiven_until_ms: AtomicU64,
    /// that was for so long;
    forgiven_for_ms: AtomicU64,
    /// and it began then.
    forgiven_at_ms: AtomicU64,
    /// The router may have lost messages of its: what was kept after this stamp it may not know.
    missed: AtomicU64,
}

/// A subscriber's own lag, and the filters it holds; nobody waits for it any more when this is dropped.
#[derive(Debug)]
pub(crate) struct LagGuard {
    lag: Arc<SubscriberLag>,
    readers: Arc<Readers>,
    held: Vec<Arc<str>>,
}

/// What a message counts: what the router counts for it, and a long one, of which little goes there, more.
pub(crate) fn weight(topic: usize, payload: usize) -> i64 {
    let counted = (COUNTED + topic + payload).clamp(PADDED, HEAVIEST);
    i64::try_from(counted).unwrap_or(i64::MAX)
}

impl Default for SubscriberLag {
    fn default() -> SubscriberLag {
        let zero = AtomicU64::default;
        SubscriberLag {
            lag: AtomicI64::default(),
            parcels: Mutex::default(),
            filters: AtomicI64::default(),
            waiting: Mutex::default(),
            behind_since_ms: zero(),
            still_since_ms: zero(),
            forgiven_until_ms: zero(),
            forgiven_for_ms: zero(),
            forgiven_at_ms: zero(),
            missed: AtomicU64::new(NOTHING),
        }
    }
}

impl SubscriberLag {
    /// So much was published for it; `stamp` is that of what was kept last. Whether it is behind now.
    pub(crate) fn owe(&self, bytes: i64, stamp: u64) -> bool {
        let lag = self.lag.fetch_add(bytes, Ordering::Relaxed) + bytes;
        if lag > ROUTER_KEEPS {
            self.missed.fetch_min(stamp, Ordering::Relaxed);
            // What is more than the router holds is lost, and will not come.
            let most = ROUTER_HOLDS * self.filters.load(Ordering::Relaxed).max(1);
            self.lag.fetch_min(most, Ordering::Relaxed);
        }
        lag > LAG
    }

    pub(crate) fn expect(&self, number: u64, payload: &Bytes) {
        self.parcels().push(number, payload);
    }

    /// What this label stands for. One that was lost it has missed.
    pub(crate) fn parcel(&self, label: Label) -> Option<Bytes> {
        let parcel = self.parcels().find(label.number);
        if parcel.is_none() {
            self.missed.fetch_min(label.stamp, Ordering::Relaxed);
        }
        parcel
    }

    /// The long message of this number need not wait for it any more.
    pub(crate) fn received(&self, number: u64) {
        self.parcels().remove(number);
    }

    /// How many bytes of long messages wait for it, which others may wait for as well.
    pub(crate) fn parcels_bytes(&self) -> usize {
        self.parcels().bytes()
    }

    /// How many bytes the router has for it at the most, as far as anybody knows.
    pub(crate) fn at_router(&self) -> usize {
        usize::try_from(self.lag.load(Ordering::Relaxed)).unwrap_or(0)
    }

    fn parcels(&self) -> MutexGuard<'_, Parcels> {
        self.parcels.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn came(&self, bytes: i64) {
        let before = self.lag.fetch_sub(bytes, Ordering::Relaxed);
        let lag = before - bytes;
        if lag < 0 {
            // It was not known yet as a subscriber when they were published.
            self.lag.fetch_max(0, Ordering::Relaxed);
        }
        if before > RELIEF && lag <= RELIEF {
            self.relieve();
        }
    }

    /// Nothing comes any more: whatever else it was owed is lost. What was kept after this stamp it may not know.
    pub(crate) fn settle(&self) -> Option<u64> {
        self.lag.store(0, Ordering::Relaxed);
        self.relieve();
        let missed = self.missed.swap(NOTHING, Ordering::Relaxed);
        (missed != NOTHING).then_some(missed)
    }

    pub(crate) fn is_behind(&self, now: Duration) -> bool {
        let is_behind = self.lag.load(Ordering::Relaxed) > LAG && ms(now) >= self.forgiven_until_ms.load(Ordering::Relaxed);
        if is_behind {
            let _ = self.behind_since_ms.compare_exchange(0, ms(now).max(1), Ordering::Relaxed, Ordering::Relaxed);
        }
        is_behind
    }

    /// Whether it is behind and nobody waits for it: what is published for it in a flood it misses.
    pub(crate) fn is_given_up(&self, now: Duration) -> bool {
        self.lag.load(Ordering::Relaxed) > LAG && ms(now) < self.forgiven_until_ms.load(Ordering::Relaxed)
    }

    /// It does not get a message before which nothing was kept after this stamp.
    pub(crate) fn miss(&self, stamp: u64) {
        self.missed.fetch_min(stamp, Ordering::Relaxed);
    }

    /// Whether everything that was published for it has come, as far as anybody knows.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.lag.load(Ordering::Relaxed) <= 0
    }

    pub(crate) fn is_even(&self) -> bool {
        self.is_settled() && self.missed.load(Ordering::Relaxed) == NOTHING
    }

    /// Waits until it has caught up, or nobody waits for it any more.
    pub async fn relieved(&self) {
        poll_fn(|cx| self.poll_relieved(cx)).await;
    }

    fn poll_relieved(&self, cx: &Context<'_>) -> Poll<()> {
        let mut waiting = self.waiting();
        // Looked at under the lock, so that whoever takes something off it meanwhile finds whom to wake.
        if self.lag.load(Ordering::Relaxed) <= RELIEF {
            return Poll::Ready(());
        }
        if !waiting.iter().any(|waker| waker.will_wake(cx.waker())) {
            waiting.push(cx.waker().clone());
        }
        Poll::Pending
    }

    fn wake_all(&self) {
        let waiting = std::mem::take(&mut *self.waiting());
        waiting.into_iter().for_each(Waker::wake);
    }

    fn waiting(&self) -> MutexGuard<'_, Vec<Waker>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether its client keeps more from coming: as much waits for it as may wait, however little of that it takes now and then, or
    /// it has acknowledged nothing since it was first said so.
    pub(crate) fn note_still(&self, is_full: bool, is_unacknowledged: bool, now: Duration) {
        match (is_full, is_unacknowledged) {
            (true, _) => self.still_since_ms.store(1, Ordering::Relaxed),
            (false, true) => {
                let _ = self.still_since_ms.compare_exchange(0, ms(now).max(1), Ordering::Relaxed, Ordering::Relaxed);
            }
            (false, false) => self.still_since_ms.store(0, Ordering::Relaxed),
        }
    }

    /// Somebody waited for it, and waits `still` for one who does not read. If it was behind for so long, or for as long as anybody is
    /// waited for, it is not waited for during a while, longer each time; one that had caught up in between is waited for again.
    /// Whether that is so.
    pub(crate) fn forgive(&self, now: Duration, still: Duration) -> bool {
        let lasts = |since: u64, time: Duration| since != 0 && ms(now).saturating_sub(since) >= ms(time);
        let behind_since = self.behind_since_ms.load(Ordering::Relaxed);
        let is_still = lasts(self.still_since_ms.load(Ordering::Relaxed), still) && lasts(behind_since, still);
        if !is_still && !lasts(behind_since, PATIENCE) {
            return false;
        }
        let (last, at) = (self.forgiven_for_ms.load(Ordering::Relaxed), self.forgiven_at_ms.swap(ms(now), Ordering::Relaxed));
        let is_mended = ms(now) > at + last + ms(MENDED);
        let next = if is_mended { 0 } else { 2 * last }.clamp(ms(FORGIVEN), ms(FORGIVEN_LONGEST));
        self.forgiven_for_ms.store(next, Ordering::Relaxed);
        self.forgiven_until_ms.store(ms(now) + next, Ordering::Relaxed);
        self.behind_since_ms.store(0, Ordering::Relaxed);
        self.wake_all();
        true
    }

    /// It has caught up. Whoever was forgiven once is waited for again at once, whoever was so several times in a while only later:
    /// nobody is to slow others down by reading now and then.
    fn relieve(&self) {
        self.behind_since_ms.store(0, Ordering::Relaxed);
        if self.forgiven_for_ms.load(Ordering::Relaxed) <= ms(FORGIVEN) {
            self.forgiven_until_ms.store(0, Ordering::Relaxed);
        }
        self.wake_all();
    }
}

impl LagGuard {
    pub(crate) fn open(readers: &Arc<Readers>) -> LagGuard {
        LagGuard { lag: Arc::default(), readers: Arc::clone(readers), held: Vec::new() }
    }

    pub(crate) fn lag(&self) -> Arc<SubscriberLag> {
        Arc::clone(&self.lag)
    }

    /// The long messages that were on their way to him when he was here before go to him.
    pub(crate) fn inherit(&self, before: &LagGuard) {
        *self.lag.parcels() = std::mem::take(&mut before.lag.parcels());
    }

    /// He asks for a filter: what is published from now on is to reach the router.
    pub(crate) fn ask(&mut self, filter: &Arc<str>) {
        self.enter(filter, false);
    }

    /// He holds it: from now on what is published is owed to him.
    pub(crate) fn hold(&mut self, filter: &Arc<str>) {
        self.enter(filter, true);
    }

    pub(crate) fn strike(&mut self, filter: &str) {
        self.held.retain(|held| &**held != filter);
        self.lag.filters.store(count(&self.held), Ordering::Relaxed);
        self.readers.strike(filter, &self.lag);
    }

    /// He has gone, and comes again: the router is to keep messages for him, and nobody waits for him.
    pub(crate) fn leave(&mut self) {
        for filter in &self.held {
            self.readers.enter(filter, &self.lag, false);
        }
        let _ = self.lag.settle();
    }

    fn enter(&mut self, filter: &Arc<str>, is_owed: bool) {
        self.readers.enter(filter, &self.lag, is_owed);
        if !self.held.contains(filter) {
            self.held.push(Arc::clone(filter));
            self.lag.filters.store(count(&self.held), Ordering::Relaxed);
        }
    }
}

impl Drop for LagGuard {
    fn drop(&mut self) {
        for filter in &self.held {
            self.readers.strike(filter, &self.lag);
        }
        // Whoever waits for him need not.
        let _ = self.lag.settle();
    }
}

fn count(held: &[Arc<str>]) -> i64 {
    i64::try_from(held.len()).unwrap_or(i64::MAX)
}

fn ms(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::STILL;

    const NOW: Duration = Duration::from_secs(100);

    /// It is behind, and was waited for as long as anybody waits, until then.
    fn stall(lag: &SubscriberLag, until: Duration) {
        lag.owe(LAG + 1, 0);
        assert!(lag.is_behind(until - PATIENCE));
        assert!(lag.forgive(until, STILL));
    }

    #[tokio::test]
    async fn whoever_lags_is_waited_for_until_he_has_caught_up() {
        let lag = Arc::new(SubscriberLag::default());
        assert!(!lag.owe(LAG, 0) && !lag.is_behind(NOW));
        assert!(lag.owe(1, 0) && lag.is_behind(NOW));
        let waiting = tokio::spawn({
            let lag = Arc::clone(&lag);
            async move { lag.relieved().await }
        });
        tokio::task::yield_now().await;
        lag.came(LAG - RELIEF + 1);
        waiting.await.expect("he has caught up");
    }

    #[test]
    fn whoever_does_not_read_is_not_waited_for_longer_and_longer() {
        let lag = SubscriberLag::default();
        stall(&lag, NOW);
        assert!(!lag.is_behind(NOW + FORGIVEN - Duration::from_millis(1)));
        stall(&lag, NOW + FORGIVEN + PATIENCE);
        let again = NOW + FORGIVEN + PATIENCE;
        assert!(!lag.is_behind(again + FORGIVEN) && lag.is_behind(again + 2 * FORGIVEN));
    }

    /// Several wait for several: one whose wait is over is no reason not to wait for those who read.
    #[test]
    fn whoever_has_caught_up_in_between_is_not_forgiven() {
        let lag = SubscriberLag::default();
        assert!(lag.owe(LAG + 1, 0) && lag.is_behind(NOW));
        lag.came(LAG + 1);
        assert!(lag.owe(LAG + 1, 0) && lag.is_behind(NOW + PATIENCE / 2));
        assert!(!lag.forgive(NOW + PATIENCE, STILL));
        assert!(lag.is_behind(NOW + PATIENCE), "it reads, and is waited for");
        assert!(lag.forgive(NOW + PATIENCE + PATIENCE / 2, STILL));
        assert!(!lag.is_behind(NOW + 2 * PATIENCE), "now it does not");
    }

    /// What stands behind a flood does not wait long for one who does not read, and no healthy one is taken for such a one.
    #[test]
    fn whoever_does_not_read_is_waited_for_only_a_moment() {
        let behind = || {
            let lag = SubscriberLag::default();
            assert!(lag.owe(LAG + 1, 0) && lag.is_behind(NOW));
            lag
        };
        let almost = NOW + STILL - Duration::from_millis(1);
        let slow = behind();
        assert!(!slow.forgive(NOW + STILL, STILL), "the router may be the slow one");
        let full = behind();
        full.note_still(true, false, almost);
        assert!(!full.forgive(almost, STILL) && full.forgive(NOW + STILL, STILL), "a trickle out of a full room is no reading");
        let silent = behind();
        silent.note_still(false, true, NOW);
        silent.note_still(false, true, almost);
        assert!(!silent.forgive(almost, STILL) && silent.forgive(NOW + STILL, STILL));
        let answering = behind();
        answering.note_still(false, true, NOW);
        answering.note_still(false, false, almost);
        answering.note_still(false, true, almost);
        assert!(!answering.forgive(NOW + STILL, STILL), "it has acknowledged some in between");
    }

    #[test]
    fn whoever_reads_again_is_waited_for_again_unless_he_makes_a_habit_of_it() {
        let lag = SubscriberLag::default();
        stall(&lag, NOW);
        lag.came(LAG + 1);
        assert!(lag.owe(LAG + 1, 0) && lag.is_behind(NOW + PATIENCE), "he has caught up");
        stall(&lag, NOW + 2 * PATIENCE);
        lag.came(3 * LAG);
        assert!(lag.owe(LAG + 1, 0) && !lag.is_behind(NOW + 3 * PATIENCE), "the second time in a while");
        assert!(lag.is_behind(NOW + 3 * FORGIVEN));
        stall(&lag, NOW + 2 * MENDED);
        lag.came(5 * LAG);
        assert!(lag.owe(LAG + 1, 0) && lag.is_behind(NOW + 2 * MENDED + PATIENCE), "a good while later");
    }

    #[test]
    fn what_the_router_cannot_hold_is_missed_and_no_debt() {
        let lag = SubscriberLag::default();
        lag.owe(ROUTER_KEEPS, 7);
        assert_eq!(lag.settle(), None, "nothing can be lost");
        for stamp in 7..1000 {
            lag.owe(ROUTER_KEEPS / 10, stamp);
        }
        lag.came(ROUTER_HOLDS - RELIEF);
        assert!(!lag.owe(1, 8) && !lag.is_behind(NOW), "what was lost is not waited for");
        assert_eq!((lag.settle(), lag.settle()), (Some(17), None), "from when on it may have been lost");
    }

    #[test]
    fn a_long_message_that_was_lost_is_missed() {
        let (lag, label) = (SubscriberLag::default(), Label { number: 1, stamp: 17, length: 4 });
        lag.expect(1, &Bytes::from_static(b"long"));
        assert_eq!((lag.parcel(label), lag.is_even()), (Some(Bytes::from_static(b"long")), true));
        lag.received(1);
        assert_eq!((lag.parcel(label), lag.settle()), (None, Some(17)));
    }

    #[test]
    fn it_is_settled_when_everything_has_come() {
        let lag = SubscriberLag::default();
        assert!(lag.is_settled());
        assert!(!lag.owe(2, 0) && !lag.is_settled());
        lag.came(1);
        assert!(!lag.is_settled());
        lag.came(1);
        assert!(lag.is_settled());
    }

    #[test]
    fn what_nobody_counted_when_it_was_published_is_no_credit() {
        let lag = SubscriberLag::default();
        lag.came(5000);
        assert!(lag.owe(LAG + 1, 0) && lag.is_behind(NOW));
    }
}
