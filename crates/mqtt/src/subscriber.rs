//! The queue of one subscriber: messages that were not sent to its client yet. The client may be away. Flooding
//! publishers wait for a subscriber that is behind but reads. For a subscriber that does not read, they wait only
//! briefly, and then not at all for a while. Such a subscriber loses messages, the oldest first, and the loss is
//! noted. `readers` knows which subscriber reads which topics.
//!
//! ```text
//!   publisher ─ put(message) for each matching reader ─► Subscriber ─ next() ─► its connection
//!        waits while it is more than LAG behind, until it is at most RELIEF behind or is forgiven
//! ```

use std::collections::VecDeque;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use super::grant::Ids;
use super::limits::{
    FORGIVEN, FORGIVEN_LONGEST, HEAVIEST, LAG, LAG_BYTES, MENDED, PATIENCE, QUEUE, QUEUE_BYTES, RELIEF, RELIEF_BYTES,
};
use super::message::Message;
use super::message::SubscriberId;
use super::packet::Qos;
use super::rights::Scope;

/// Capacity retained by an empty queue, in messages.
const ROOM: usize = 256;

/// The value of `missed` when no message was missed. It is higher than any stamp, because `missed` keeps the lowest
/// stamp.
const NOTHING: u64 = u64::MAX;

/// A subscriber with the terms of all its filters that match one topic.
#[derive(Clone, Debug)]
pub(crate) struct TopicReader {
    pub(crate) subscriber: Arc<Subscriber>,
    /// The highest QoS at which messages are sent to the subscriber.
    pub(crate) qos: Qos,
    /// Whether messages keep the RETAIN flag with which they were published.
    pub(crate) as_published: bool,
    pub(crate) ids: Ids,
}

/// The messages that wait for one subscriber, within limits. Beyond the limits the oldest messages are lost, and the
/// loss is noted.
#[derive(Debug)]
pub struct Subscriber {
    id: SubscriberId,
    queue: Mutex<Queue>,
    /// Weight of the messages in the queue, and of messages that a router has on their way to this subscriber.
    lag: AtomicUsize,
    waiting: Mutex<Vec<Waker>>,
    /// Since when every check found that the subscriber lags behind, in milliseconds on the clock of all connections.
    /// The value is 0 if it does not lag behind.
    behind_since_ms: AtomicU64,
    /// Since when the client has read nothing, in milliseconds on the clock of all connections. The value is 0 if it
    /// reads.
    still_since_ms: AtomicU64,
    /// Until when no publisher waits for the subscriber, in milliseconds on the clock of all connections.
    forgiven_until_ms: AtomicU64,
    /// How long no publisher waits for the subscriber after it is forgiven, in milliseconds. It doubles each time.
    forgiven_for_ms: AtomicU64,
    /// When the subscriber was last forgiven, in milliseconds on the clock of all connections.
    forgiven_at_ms: AtomicU64,
    /// Messages that were retained after this stamp may be new to the subscriber, because it missed a message.
    missed: AtomicU64,
    /// The topics that exist for the client. A later connection of its session may have another scope.
    scope: RwLock<Scope>,
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
    /// No connection takes messages now, but a later one may: the session is stored.
    Away,
    /// No connection will take messages again: the subscription was dropped.
    Gone,
}

#[derive(Clone, Debug)]
pub(crate) struct Delivery {
    pub(crate) message: Arc<Message>,
    /// The lower of the message's QoS and the subscription's QoS.
    pub(crate) qos: Qos,
    /// The RETAIN flag to send. A subscriber gets the published flag only on request (Retain As Published).
    pub(crate) retain: bool,
    pub(crate) ids: Ids,
}

impl Queue {
    /// The index of a message to drop; `None` if the queue is within its limits. The newest message is never dropped.
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
    /// A delivery at the lower of the message's QoS and the subscription's QoS (section 3.8.4).
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
            scope: RwLock::default(),
        }
    }
}

impl Subscriber {
    pub(crate) const fn id(&self) -> SubscriberId {
        self.id
    }

    /// Whether the client may receive messages on this topic.
    pub(crate) fn may_read(&self, topic: &str) -> bool {
        self.scope.read().unwrap_or_else(PoisonError::into_inner).contains(topic)
    }

    pub(crate) fn set_scope(&self, scope: Scope) {
        *self.scope.write().unwrap_or_else(PoisonError::into_inner) = scope;
    }

    /// Notes that the client is away and may come back. The queue is emptied unless `has_room` is set.
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

    /// Notes that the client will never come back, so no publisher needs to wait for it.
    pub(crate) fn go(&self) {
        *self.queue() = Queue { presence: Presence::Gone, ..Queue::default() };
        self.lag.store(0, Ordering::Relaxed);
        self.wake_all();
    }

    /// Counts a message on its way to this subscriber as if it had arrived.
    pub(crate) fn expect(&self, message: &Message) {
        self.lag.fetch_add(weight(message), Ordering::Relaxed);
    }

    /// Ends the count that `expect` began, because the message now arrives.
    pub(crate) fn unexpect(&self, message: &Message) {
        self.lag.fetch_sub(weight(message), Ordering::Relaxed);
    }

    /// Queues a message, and drops the oldest messages beyond the limits. `has_room` says whether there is room for
    /// messages to a subscriber that is away.
    pub(crate) fn put(&self, delivery: Delivery, has_room: impl FnOnce() -> bool) {
        let stamp = delivery.message.stamp;
        let mut queue = self.queue();
        match queue.presence {
            Presence::Here => {}
            // A subscriber that is away cannot read, and there may be many such subscribers.
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

    /// Removes and returns the next message to send, if any. If `has_window` is false, returns no message that needs
    /// an acknowledgement: the client has to acknowledge earlier messages first.
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

    /// Whether publishers that wait for this subscriber have to wait longer, with this many bytes in its queue.
    fn is_unrelieved(&self, bytes: usize) -> bool {
        self.lag.load(Ordering::Relaxed) > RELIEF || bytes > RELIEF_BYTES
    }

    /// Ready when the next message can be sent. `has_window` says whether a message that needs an acknowledgement can
    /// be sent. If not ready, wakes the caller when a message arrives.
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

    /// Size in bytes of the queued messages, which other subscribers may share.
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

    /// Whether the queue is empty. Messages that a router has on their way are not in the queue.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.queue().waiting.is_empty()
    }

    /// Notes that the subscriber misses a message with this stamp. Messages retained up to this stamp came before the
    /// missed one.
    pub(crate) fn miss(&self, stamp: u64) {
        self.missed.fetch_min(stamp, Ordering::Relaxed);
    }

    /// Takes the stamp after which retained messages may be new to the subscriber, because it missed a message.
    /// `None` if it has missed none since the last call.
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

    /// Whether the subscriber is connected and lags behind: messages of more weight than `LAG`, or of more bytes than
    /// `LAG_BYTES`, wait for it.
    pub(crate) fn lags(&self) -> bool {
        let queue = self.queue();
        queue.presence == Presence::Here && (self.lag.load(Ordering::Relaxed) > LAG || queue.bytes > LAG_BYTES)
    }

    /// Ready when the subscriber has caught up. Otherwise wakes the caller as soon as it has caught up, or as soon as
    /// publishers need not wait for it any more.
    pub fn poll_relieved(&self, cx: &Context<'_>) -> Poll<()> {
        let mut waiting = self.waiting();
        // Checked under the lock, so that a thread that takes a message meanwhile finds the waker.
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

    /// Notes whether the client has stopped reading. A client has stopped if its outbox is full, even if it reads a
    /// little now and then. It has also stopped if its window is full and it acknowledges nothing.
    pub(crate) fn note_still(&self, is_full: bool, is_unacknowledged: bool, now: Duration) {
        match (is_full, is_unacknowledged) {
            (true, _) => self.still_since_ms.store(1, Ordering::Relaxed),
            (false, true) => {
                let _ = self.still_since_ms.compare_exchange(0, ms(now).max(1), Ordering::Relaxed, Ordering::Relaxed);
            }
            (false, false) => self.still_since_ms.store(0, Ordering::Relaxed),
        }
    }

    /// Ends a publisher's wait for this subscriber. `still` is how long the publisher waits for a subscriber that
    /// does not read. If this subscriber lagged behind for `still` without reading, or for `PATIENCE`, no publisher
    /// waits for it for a while. This time grows with each call. Otherwise nothing changes and the call returns
    /// false, for example because the subscriber caught up in between.
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

    /// Notes that the subscriber has caught up. If it was forgiven only once, publishers wait for it again at once.
    /// If it was forgiven repeatedly, they do not, so that it cannot slow them down by reading now and then.
    fn relieve(&self) {
        self.behind_since_ms.store(0, Ordering::Relaxed);
        if self.forgiven_for_ms.load(Ordering::Relaxed) <= ms(FORGIVEN) {
            self.forgiven_until_ms.store(0, Ordering::Relaxed);
        }
        self.wake_all();
    }
}

/// The weight of a message in a queue. A long message is in memory only once for all its readers, so its weight is
/// bounded.
fn weight(message: &Message) -> usize {
    message.cost().min(HEAVIEST)
}

fn ms(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
#[path = "subscriber_tests.rs"]
mod tests;
