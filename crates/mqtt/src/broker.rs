//! What all connections of a broker share. Each part looks after its own lock.

use std::future::poll_fn;
use std::hash::{BuildHasher, Hash, RandomState};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::limits::AWAY;
use crate::message::Message;
use crate::packet::Qos;
use crate::passage::{Passage, Router};
use crate::readers::{Reader, Readers};
use crate::retained::Retained;
use crate::rights::{Payer, Rights, Tier};
use crate::subscriber::{Delivery, Subscriber, Subscription};

/// What all connections of a broker share.
#[derive(Debug)]
pub struct Broker {
    pub(crate) rights: Box<dyn Rights>,
    pub(crate) retained: Retained,
    pub(crate) readers: Arc<Readers>,
    /// The bytes of all messages that anybody has.
    alive: Arc<AtomicUsize>,
    /// Nobody outside can know two texts of one print.
    hasher: RandomState,
}

/// What the program itself listens to.
#[derive(Debug)]
pub struct OwnSubscription(Subscription);

impl Broker {
    /// A broker at which nothing was said yet, and which brings messages to those who read them itself.
    #[must_use]
    pub fn new(rights: impl Rights + 'static) -> Broker {
        Broker::of(rights, None)
    }

    /// One for which this router does it.
    #[must_use]
    pub fn with_router(rights: impl Rights + 'static, router: impl Router + 'static) -> Broker {
        Broker::of(rights, Some(Box::new(router)))
    }

    fn of(rights: impl Rights + 'static, router: Option<Box<dyn Router>>) -> Broker {
        Broker {
            rights: Box::new(rights),
            retained: Retained::default(),
            readers: Arc::new(Readers::new(router)),
            alive: Arc::default(),
            hasher: RandomState::new(),
        }
    }

    /// Whether one may leave a will there: asked before its CONNECT is answered.
    #[must_use]
    pub fn may_leave_will(&self, who: Tier, topic: &str) -> bool {
        self.rights.may_leave_will(who, topic)
    }

    /// The program itself says something at QoS 1, wherever it likes, and waits for nobody. What is to be kept is so, if there is room:
    /// whether there was.
    pub fn publish(&self, topic: &str, payload: &[u8], retain: bool) -> bool {
        let message = self.message(Arc::from(topic), payload, Qos::One);
        let is_kept = !retain || self.rights.is_for_commands(topic) || self.retained.keep(&Payer::Program, &message);
        // Kept first: a newcomer that nobody knew of yet finds it there.
        self.send(&message, &self.readers.of(topic));
        is_kept
    }

    /// The program itself subscribes to these filters, each of which has to be a good one.
    #[must_use]
    pub fn subscribe(&self, filters: &[&str]) -> OwnSubscription {
        let mut subscription = Subscription::new(&self.readers);
        for filter in filters {
            subscription.hold(filter, Qos::One);
        }
        OwnSubscription(subscription)
    }

    /// How many bytes the messages take that wait for clients and are not kept.
    #[must_use]
    pub fn beside(&self) -> usize {
        let kept = self.retained.bytes();
        self.alive.load(Ordering::Relaxed).saturating_sub(kept)
    }

    pub(crate) fn message(&self, topic: Arc<str>, payload: &[u8], qos: Qos) -> Arc<Message> {
        Arc::new(Message::new(topic, payload, qos, self.retained.stamp(), &self.alive))
    }

    /// To each of those who read it.
    pub(crate) fn send(&self, message: &Arc<Message>, readers: &[Reader]) {
        if let Some(router) = self.readers.router().filter(|_| !readers.is_empty()) {
            return router.carry(Passage::begin(Arc::clone(message), readers, self.has_room_for_away()));
        }
        for reader in readers {
            reader.subscriber.put(Delivery::of(message, reader.qos), || self.has_room_for_away());
        }
    }

    /// Whether something may wait for one who is away: he cannot read, and may be many.
    pub(crate) fn has_room_for_away(&self) -> bool {
        self.beside() <= AWAY
    }

    pub(crate) fn print(&self, of: impl Hash) -> u64 {
        self.hasher.hash_one(of)
    }
}

impl OwnSubscription {
    /// The next message.
    pub async fn next(&self) -> Arc<Message> {
        let subscriber: &Subscriber = self.0.subscriber();
        loop {
            poll_fn(|cx| subscriber.poll_come(true, cx)).await;
            if let Some(delivery) = subscriber.next(true) {
                return delivery.message;
            }
        }
    }
}
