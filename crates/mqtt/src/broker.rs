//! What all connections of a broker share. Each part looks after its own lock.

use std::future::poll_fn;
use std::hash::{BuildHasher, Hash, RandomState};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use crate::connection::refusals::Lines;
use crate::filter;
use crate::grant::Grant;
use crate::limits::AWAY;
use crate::message::{Draft, Message};
use crate::packet::Qos;
use crate::packet::connect::Will;
use crate::packet::properties::{Property, that_go_on};
use crate::readers::{Readers, TopicReaders};
use crate::retained::Retained;
use crate::rights::{Payer, Rights, Tier};
use crate::routed_delivery::{RoutedDelivery, Router};
use crate::subscriber::{Delivery, Subscriber, TopicReader};
use crate::subscription::Subscription;

/// What all connections of a broker share.
#[derive(Debug)]
pub struct Broker {
    pub(crate) rights: Box<dyn Rights>,
    pub(crate) retained: Retained,
    pub(crate) readers: Arc<Readers>,
    /// The bytes of all messages that anybody has.
    alive: Arc<AtomicUsize>,
    /// What is written of refusals.
    pub(crate) lines: Lines,
    /// Nobody outside can know two texts of one print.
    hasher: RandomState,
}

/// What the program itself says.
#[derive(Clone, Copy, Debug)]
pub struct Announcement<'a> {
    /// Where: any topic.
    pub topic: &'a str,
    /// What.
    pub payload: &'a [u8],
    /// Whether it is kept, if there is room.
    pub retain: bool,
    /// What those of MQTT 5 are told beside it.
    pub properties: &'a [Property<'a>],
}

/// What the program itself listens to.
#[derive(Debug)]
pub struct OwnSubscription(Subscription);

impl<'a> Announcement<'a> {
    /// One with nothing beside it, that is not kept.
    #[must_use]
    pub const fn passing(topic: &'a str, payload: &'a [u8]) -> Announcement<'a> {
        Announcement { topic, payload, retain: false, properties: &[] }
    }
}

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
            lines: Lines::default(),
            hasher: RandomState::new(),
        }
    }

    /// Whether one may leave a will there: asked before its CONNECT is answered.
    #[must_use]
    pub fn may_leave_will(&self, who: Tier, topic: &str) -> bool {
        filter::topic(topic).is_ok() && self.rights.may_leave_will(who, topic)
    }

    /// Whether one may share this filter with others: asked of those that are shared.
    pub(crate) fn may_share(&self, who: Tier, filter: &str) -> bool {
        self.rights.may_share(who, filter)
    }

    /// The program itself says something at QoS 1, and waits for nobody. What is to be kept is so, if there is room: whether there was.
    pub fn publish(&self, announcement: &Announcement<'_>) -> bool {
        let Announcement { topic, payload, retain, properties } = *announcement;
        let properties = that_go_on(properties.iter().copied());
        let draft = Draft {
            topic: Arc::from(topic),
            payload,
            qos: Qos::One,
            retain,
            properties: &properties,
            expires_at: None,
            publisher: None,
        };
        let message = self.message(draft);
        let is_kept =
            !retain || self.rights.is_for_commands(topic) || self.retained.keep(&Payer::Program, &message, Duration::ZERO);
        // Kept first: a newcomer that nobody knew of yet finds it there.
        self.send(&message, &self.readers.of(topic, None));
        is_kept
    }

    /// A will is published, `now` on the clock of all connections, for somebody who may leave it.
    pub(crate) fn publish_will(&self, will: &Will, payer: &Payer, now: Duration) {
        let message = self.message(Draft {
            topic: Arc::from(will.topic.as_str()),
            payload: &will.payload,
            qos: will.qos,
            retain: will.retain,
            properties: &will.properties,
            expires_at: will.expiry_s.map(|seconds| now + Duration::from_secs(u64::from(seconds))),
            publisher: None,
        });
        if will.retain && !self.retained.keep(payer, &message, now) && self.lines.admit(now) {
            tracing::warn!(topic = will.topic, "a will is not kept, there being too many kept messages");
        }
        self.send(&message, &self.readers.of(&will.topic, None));
    }

    /// The program itself subscribes to these filters, each of which has to be a good one.
    #[must_use]
    pub fn subscribe(&self, filters: &[&str]) -> OwnSubscription {
        let mut subscription = Subscription::new(&self.readers);
        for filter in filters {
            subscription.hold(filter, Grant::at(Qos::One));
        }
        OwnSubscription(subscription)
    }

    /// How many bytes the messages take that wait for clients and are not kept.
    #[must_use]
    pub fn beside(&self) -> usize {
        let kept = self.retained.bytes();
        self.alive.load(Ordering::Relaxed).saturating_sub(kept)
    }

    pub(crate) fn message(&self, draft: Draft<'_>) -> Arc<Message> {
        Arc::new(Message::new(draft, self.retained.stamp(), &self.alive))
    }

    /// To each of those who read it, and to one of each group. Groups are of the gate alone: no router knows of them.
    pub(crate) fn send(&self, message: &Arc<Message>, readers: &TopicReaders) {
        let put = |reader: &TopicReader| reader.subscriber.put(Delivery::of(message, reader), || self.has_room_for_away());
        match self.readers.router().filter(|_| !readers.each.is_empty()) {
            Some(router) => router.carry(RoutedDelivery::begin(Arc::clone(message), &readers.each, self.has_room_for_away())),
            None => readers.each.iter().for_each(put),
        }
        self.readers.in_turn(&readers.groups).for_each(put);
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
