//! What was published for one subscriber and has not gone out to its client: its queue, which it has also while it is away, and how far
//! behind it is. Whoever publishes in a flood is made to wait for those who read. A subscriber who does not read is not waited for long,
//! and then for a good while not at all: he alone misses messages, the oldest first, and it is noted that he did. Who reads what stands
//! in `readers`.
//!
//! ```text
//!   publisher ─ put(message) for each whose filters match ─► Subscriber ─ next() ─► its connection
//!        waits while it is more than LAG behind, until it is no more than RELIEF, or until it is forgiven
//! ```

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use super::grant::Ids;
use super::limits::{
    FORGIVEN, FORGIVEN_LONGEST, HEAVIEST, LAG, LAG_BYTES, MENDED, PATIENCE, QUEUE, QUEUE_BYTES, RELIEF, RELIEF_BYTES,
};
use super::message::Message;
use super::message::SubscriberId;
use super::packet::Qos;

/// So much room for deliveries is kept when none waits.
const ROOM: usize = 256;

/// Nothing was missed.
const NOTHING: u64 = u64::MAX;

/// Who reads something, and how.
#[derive(Clone, Debug)]
pub(crate) struct TopicReader {
    pub(crate) subscriber: Arc<Subscriber>,
    /// How surely it is to reach him at the most.
    pub(crate) qos: Qos,
    /// Whether he is told that it is to be kept.
    pub(crate) as_published: bool,
    /// The numbers of his subscriptions that match.
    pub(crate) ids: Ids,
}

/// What waits for one subscriber, and since when it does not keep up.
#[derive(Debug)]
pub struct Subscriber {
    id: SubscriberId,
    queue: Mutex<Queue>,
    /// What waits in the queue weighs so much.
    lag: AtomicUsize,
    /// Publishers who are to be woken when it has caught up.
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
    /// It did not get all messages: what was kept after this stamp it may not know.
    missed: AtomicU64,
}

#[derive(Debug, Default)]
struct Queue {
    waiting: VecDeque<Delivery>,
    /// How many bytes the messages in it take, which others may have as well.
    bytes: usize,
    presence: Presence,
    /// Who is to be woken when something comes.
    taker: Option<Waker>,
}

/// Whether somebody takes what waits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Presence {
    #[default]
    Here,
    /// Nobody does now, and somebody may later.
    Away,
    /// Nobody ever will.
    Gone,
}

/// A message on its way to one subscriber.
#[derive(Clone, Debug)]
pub(crate) struct Delivery {
    pub(crate) message: Arc<Message>,
    /// The lesser of that of the message and that of the subscription.
    pub(crate) qos: Qos,
    /// Whether it comes with the flag of what is to be kept.
    pub(crate) retain: bool,
    /// The numbers of the subscriptions by which it comes.
    pub(crate) ids: Ids,
}

impl Queue {
    /// Which of the messages is lost, if it has more than it may.
    fn too_much(&self, lag: usize) -> Option<usize> {
        let older = self.waiting.len().checked_sub(1).filter(|older| *older > 0)?;
        if lag > QUEUE {
            return Some(0);
        }
        let mut older = self.waiting.iter().take(older);
        if self.bytes > QUEUE_BYTES { older.position(|delivery| delivery.message.cost() > HEAVIEST) } else { None }
    }
}

impl Delivery {
    /// At the lesser of its own quality and that of the subscription (section 3.8.4).
    pub(crate) fn of(message: &Arc<Message>, reader: &TopicReader) -> Delivery {
        Delivery {
            message: Arc::clone(message),
            qos: message.qos().min(reader.qos),
            retain: reader.as_published && message.retain(),
            ids: reader.ids.clone(),
        }
    }

    fn weight(&self) -> usize {
        weight(&self.message)
    }
}

impl Default for Subscriber {
    fn default() -> Subscriber {
        static LAST: AtomicU64 = AtomicU64::new(0);
        let zero = AtomicU64::default;
        Subscriber {
            id: SubscriberId(LAST.fetch_add(1, Ordering::Relaxed)),
            queue: Mutex::default(),
            lag: AtomicUsize::default(),
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

impl Subscriber {
    pub(crate) const fn id(&self) -> SubscriberId {
        self.id
    }

    /// Nobody takes what comes now, and somebody may later; without room for it nothing waits.
    pub(crate) fn go_away(&self, has_room: bool) {
        let mut queue = self.queue();
        (queue.presence, queue.taker) = (Presence::Away, None);
        if !has_room {
            queue.waiting.drain(..).for_each(|lost| self.miss(lost.message.stamp));
            queue.bytes = 0;
            self.lag.store(0, Ordering::Relaxed);
        }
        drop(queue);
        self.wake_all();
    }

    /// Somebody takes what comes again.
    pub(crate) fn come_back(&self) {
        self.queue().presence = Presence::Here;
    }

    /// Nobody ever takes anything any more: whoever waits for it need not.
    pub(crate) fn go(&self) {
        *self.queue() = Queue { presence: Presence::Gone, ..Queue::default() };
        self.lag.store(0, Ordering::Relaxed);
        self.wake_all();
    }

    /// A message is on its way to it, and counts as if it had come.
    pub(crate) fn expect(&self, message: &Message) {
        self.lag.fetch_add(weight(message), Ordering::Relaxed);
    }

    /// It is not on its way any more: it comes just now.
    pub(crate) fn unexpect(&self, message: &Message) {
        self.lag.fetch_sub(weight(message), Ordering::Relaxed);
    }

    /// A message for it. Of more than there is room for the oldest are lost; `has_room` says whether something may wait for one who is away.
    pub(crate) fn put(&self, delivery: Delivery, has_room: impl FnOnce() -> bool) {
        let stamp = delivery.message.stamp;
        let mut queue = self.queue();
        match queue.presence {
            Presence::Here => {}
            // Whoever is away cannot read, and may be many.
            Presence::Away if delivery.qos > Qos::Zero && has_room() => {}
            Presence::Away => {
                self.miss(stamp);
                return;
            }
            Presence::Gone => return,
        }
        queue.bytes += delivery.message.cost();
        let mut lag = self.lag.fetch_add(delivery.weight(), Ordering::Relaxed) + delivery.weight();
        queue.waiting.push_back(delivery);
        while let Some(lost) = queue.too_much(lag).and_then(|place| queue.waiting.remove(place)) {
            queue.bytes -= lost.message.cost();
            lag = self.lag.fetch_sub(lost.weight(), Ordering::Relaxed) - lost.weight();
            self.miss(lost.message.stamp);
        }
        let taker = queue.taker.take();
        drop(queue);
        if let Some(taker) = taker {
            taker.wake();
        }
    }

    /// The next message that goes out, if there is one; none that is to be acknowledged, when its client has acknowledged too little.
    pub(crate) fn next(&self, has_window: bool) -> Option<Delivery> {
        let mut queue = self.queue();
        queue.waiting.front().filter(|next| has_window || next.qos == Qos::Zero)?;
        let delivery = queue.waiting.pop_front()?;
        let was_behind = self.is_unrelieved(queue.bytes);
        queue.bytes -= delivery.message.cost();
        self.lag.fetch_sub(delivery.weight(), Ordering::Relaxed);
        let is_relieved = was_behind && !self.is_unrelieved(queue.bytes);
        if queue.waiting.is_empty() && queue.waiting.capacity() > ROOM {
            queue.waiting = VecDeque::new();
        }
        drop(queue);
        if is_relieved {
            self.relieve();
        }
        Some(delivery)
    }

    /// Whether more waits for it, this being its bytes, than for one who has caught up.
    fn is_unrelieved(&self, bytes: usize) -> bool {
        self.lag.load(Ordering::Relaxed) > RELIEF || bytes > RELIEF_BYTES
    }

    /// Whether something waits for it that can go out; `has_window` says whether that may be something to be acknowledged. Else whoever asks
    /// is woken when it does.
    pub fn poll_come(&self, has_window: bool, cx: &Context<'_>) -> Poll<()> {
        let mut queue = self.queue();
        if queue.waiting.front().is_some_and(|next| has_window || next.qos == Qos::Zero) {
            return Poll::Ready(());
        }
        if !queue.taker.as_ref().is_some_and(|taker| taker.will_wake(cx.waker())) {
            queue.taker = Some(cx.waker().clone());
        }
        Poll::Pending
    }

    /// How many bytes the messages take that wait for it, which others may have as well.
    pub(crate) fn bytes(&self) -> usize {
        self.queue().bytes
    }

    /// How many bytes it takes that they wait.
    pub(crate) fn own_bytes(&self) -> usize {
        self.queue().waiting.len() * size_of::<Delivery>()
    }

    /// Whether somebody takes what comes for it.
    pub(crate) fn is_here(&self) -> bool {
        self.queue().presence == Presence::Here
    }

    /// Whether nothing waits for it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.queue().waiting.is_empty()
    }

    /// It does not get a message before which nothing was kept after this stamp.
    pub(crate) fn miss(&self, stamp: u64) {
        self.missed.fetch_min(stamp, Ordering::Relaxed);
    }

    /// What it has missed is made up for: what was kept after this stamp it may not know.
    pub(crate) fn take_missed(&self) -> Option<u64> {
        let missed = self.missed.swap(NOTHING, Ordering::Relaxed);
        (missed != NOTHING).then_some(missed)
    }

    pub(crate) fn is_behind(&self, now: Duration) -> bool {
        let is_behind = self.lags() && ms(now) >= self.forgiven_until_ms.load(Ordering::Relaxed);
        if is_behind {
            let _ = self.behind_since_ms.compare_exchange(0, ms(now).max(1), Ordering::Relaxed, Ordering::Relaxed);
        }
        is_behind
    }

    /// Whether it is here, and more waits for it than for one who keeps up.
    pub(crate) fn lags(&self) -> bool {
        let queue = self.queue();
        queue.presence == Presence::Here && (self.lag.load(Ordering::Relaxed) > LAG || queue.bytes > LAG_BYTES)
    }

    /// Whether it has caught up; else whoever asks is woken when it has, or nobody waits for it any more.
    pub fn poll_relieved(&self, cx: &Context<'_>) -> Poll<()> {
        let mut waiting = self.waiting();
        // Looked at under the lock, so that whoever takes something off it meanwhile finds whom to wake.
        if !self.is_unrelieved(self.bytes()) {
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

    fn queue(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
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

/// What a message counts while it waits for somebody: a long one is there once for all who wait for it.
fn weight(message: &Message) -> usize {
    message.cost().min(HEAVIEST)
}

fn ms(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
#[path = "subscriber_tests.rs"]
mod tests;
