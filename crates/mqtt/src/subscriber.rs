//! The queue of one subscriber: messages that were published for it and have not gone out to its client, which may be
//! away, and how far it is behind. Flooding publishers wait for subscribers that read. One that does not read is waited
//! for only briefly, and then not at all for a while: it alone loses messages, the oldest first, and the loss is noted.
//! Who reads what stands in `readers`.
//!
//! ```text
//!   publisher ─ put(message) for each matching reader ─► Subscriber ─ next() ─► its connection
//!        waits while it is more than LAG behind, until it is at most RELIEF behind or is forgiven
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

/// Empty places kept in the queue when nothing waits.
const ROOM: usize = 256;

/// Stands for nothing missed: any stamp is lower, and the lowest is the one that counts.
const NOTHING: u64 = u64::MAX;

/// A subscriber with the terms of all its filters that match one topic.
#[derive(Clone, Debug)]
pub(crate) struct TopicReader {
    pub(crate) subscriber: Arc<Subscriber>,
    /// The highest QoS at which it is sent messages.
    pub(crate) qos: Qos,
    /// Whether its messages carry the RETAIN flag with which they were published.
    pub(crate) as_published: bool,
    pub(crate) ids: Ids,
}

/// What waits for one subscriber, within bounds: beyond them the oldest messages are lost, and the loss is noted.
#[derive(Debug)]
pub struct Subscriber {
    id: SubscriberId,
    queue: Mutex<Queue>,
    /// Weight of the messages in the queue, and of those that a router has on their way to it.
    lag: AtomicUsize,
    waiting: Mutex<Vec<Waker>>,
    /// Since when every check found it behind, in milliseconds on the clock of all connections; 0: it is not behind.
    behind_since_ms: AtomicU64,
    /// Since when its client has read nothing, on the same clock; 0: it reads.
    still_since_ms: AtomicU64,
    /// Until when nobody waits for it, on the same clock.
    forgiven_until_ms: AtomicU64,
    /// How long nobody waits for it once it is forgiven, in milliseconds; twice as long each time.
    forgiven_for_ms: AtomicU64,
    /// When it was last forgiven, on the same clock.
    forgiven_at_ms: AtomicU64,
    /// Stamp after which retained messages may be new to it, since it missed some.
    missed: AtomicU64,
}

#[derive(Debug, Default)]
struct Queue {
    waiting: VecDeque<Delivery>,
    /// Size in bytes of the queued messages, which other subscribers may share.
    bytes: usize,
    presence: Presence,
    taker: Option<Waker>,
}

/// Whether a connection takes messages from the queue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Presence {
    #[default]
    Here,
    /// No connection does now, but one may later: its session is stored.
    Away,
    /// None ever will again: the subscription was dropped.
    Gone,
}

#[derive(Clone, Debug)]
pub(crate) struct Delivery {
    pub(crate) message: Arc<Message>,
    /// The lesser of the message's QoS and the subscription's.
    pub(crate) qos: Qos,
    /// The RETAIN flag that it is sent with, which a subscriber gets as published only on request.
    pub(crate) retain: bool,
    pub(crate) ids: Ids,
}

impl Queue {
    /// The index of the message to drop, if the queue exceeds its limits. The newest one always stays.
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
    /// At the lesser of the message's QoS and the subscription's (section 3.8.4).
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

    /// Its client is away and may come back. Without room the queue is emptied.
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

    pub(crate) fn come_back(&self) {
        self.queue().presence = Presence::Here;
    }

    /// Its client will never come back, so nobody needs to wait for it.
    pub(crate) fn go(&self) {
        *self.queue() = Queue { presence: Presence::Gone, ..Queue::default() };
        self.lag.store(0, Ordering::Relaxed);
        self.wake_all();
    }

    /// Counts a message that is on its way to it as if it had arrived.
    pub(crate) fn expect(&self, message: &Message) {
        self.lag.fetch_add(weight(message), Ordering::Relaxed);
    }

    /// Ends the count of `expect`, as the message arrives now.
    pub(crate) fn unexpect(&self, message: &Message) {
        self.lag.fetch_sub(weight(message), Ordering::Relaxed);
    }

    /// Queues a message, and drops the oldest beyond the limits; `has_room` says whether messages may wait for
    /// subscribers that are away.
    pub(crate) fn put(&self, delivery: Delivery, has_room: impl FnOnce() -> bool) {
        let stamp = delivery.message.stamp;
        let mut queue = self.queue();
        match queue.presence {
            Presence::Here => {}
            // A subscriber that is away cannot read, and there may be many of them.
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

    /// The next message to send, if there is one. Without a window, messages that have to be acknowledged stay: the
    /// client has acknowledged too little.
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

    /// Whether publishers that wait for it go on waiting, with this many bytes in its queue.
    fn is_unrelieved(&self, bytes: usize) -> bool {
        self.lag.load(Ordering::Relaxed) > RELIEF || bytes > RELIEF_BYTES
    }

    /// Ready when a message waits that can be sent; `has_window` says whether that may be one that has to be
    /// acknowledged. Otherwise wakes the caller when one does.
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

    /// Size in bytes of the messages that wait for it, which other subscribers may share.
    pub(crate) fn bytes(&self) -> usize {
        self.queue().bytes
    }

    /// Size in bytes of the queue itself, without the messages.
    pub(crate) fn own_bytes(&self) -> usize {
        self.queue().waiting.len() * size_of::<Delivery>()
    }

    pub(crate) fn is_here(&self) -> bool {
        self.queue().presence == Presence::Here
    }

    /// Whether its queue is empty; messages that a router has on their way are not in it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.queue().waiting.is_empty()
    }

    /// Notes that it misses a message; whatever was retained up to this stamp came before that message.
    pub(crate) fn miss(&self, stamp: u64) {
        self.missed.fetch_min(stamp, Ordering::Relaxed);
    }

    /// The stamp after which retained messages may be new to it, since it missed some; `None`: nothing was missed since
    /// the last call.
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

    /// Whether it is connected and more than `LAG` or `LAG_BYTES` behind.
    pub(crate) fn lags(&self) -> bool {
        let queue = self.queue();
        queue.presence == Presence::Here && (self.lag.load(Ordering::Relaxed) > LAG || queue.bytes > LAG_BYTES)
    }

    /// Ready when it has caught up. Otherwise wakes the caller when it has, or when nobody waits for it any more.
    pub fn poll_relieved(&self, cx: &Context<'_>) -> Poll<()> {
        let mut waiting = self.waiting();
        // Checked under the lock, so that whoever takes a message meanwhile finds the waker.
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

    /// Notes whether its client has stopped reading: its queue is full, however little it takes now and then, or it has
    /// acknowledged nothing since the window was first found full.
    pub(crate) fn note_still(&self, is_full: bool, is_unacknowledged: bool, now: Duration) {
        match (is_full, is_unacknowledged) {
            (true, _) => self.still_since_ms.store(1, Ordering::Relaxed),
            (false, true) => {
                let _ = self.still_since_ms.compare_exchange(0, ms(now).max(1), Ordering::Relaxed, Ordering::Relaxed);
            }
            (false, false) => self.still_since_ms.store(0, Ordering::Relaxed),
        }
    }

    /// A publisher has waited for it; `still` is how long it waits for subscribers that do not read. If this one was
    /// behind for so long and did not read, or was behind for `PATIENCE`, nobody waits for it during a while, longer
    /// each time. One that caught up in between is waited for again. Returns whether nobody waits for it now.
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

    /// Notes that it has caught up. Publishers wait for it again at once if it was forgiven once, and later if it was
    /// forgiven repeatedly: nobody is to slow others down by reading now and then.
    fn relieve(&self) {
        self.behind_since_ms.store(0, Ordering::Relaxed);
        if self.forgiven_for_ms.load(Ordering::Relaxed) <= ms(FORGIVEN) {
            self.forgiven_until_ms.store(0, Ordering::Relaxed);
        }
        self.wake_all();
    }
}

/// The weight of a message in a queue: a long one is in memory once for all its readers.
fn weight(message: &Message) -> usize {
    message.cost().min(HEAVIEST)
}

fn ms(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
#[path = "subscriber_tests.rs"]
mod tests;
