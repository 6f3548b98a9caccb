//! The state that all connections of a broker share. Each part has its own lock.

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

/// What all connections share: rights, retained messages and subscriptions. Every method takes `&self`, so
/// connections hold the broker in an `Arc`.
#[derive(Debug)]
pub struct Broker {
    pub(crate) rights: Box<dyn Rights>,
    pub(crate) retained: Retained,
    pub(crate) readers: Arc<Readers>,
    /// Total size in bytes of all messages in memory.
    alive: Arc<AtomicUsize>,
    /// Limits the log lines about refusals of all clients together. A limit for each client would not be enough,
    /// because a client may reconnect for ever.
    pub(crate) lines: Lines,
    /// Randomly seeded, so that no client can construct two texts with the same fingerprint.
    hasher: RandomState,
}

/// A message of the program itself, which may use any topic and has its own room for retained messages.
#[derive(Clone, Copy, Debug)]
pub struct Announcement<'a> {
    /// Any topic, even one that begins with `$`. The caller must make sure that it has no wildcards.
    pub topic: &'a str,
    /// May be empty. An empty payload with `retain` removes the topic's retained message.
    pub payload: &'a [u8],
    /// Whether to retain the message. It is retained only if there is room, and never on a topic of commands.
    pub retain: bool,
    /// Properties for readers of MQTT 5. Only properties that MQTT forwards are sent (section 3.3.2.3), such as the
    /// content type.
    pub properties: &'a [Property<'a>],
}

/// The program's own subscription, at QoS 1. Dropping the value ends the subscription.
#[derive(Debug)]
pub struct OwnSubscription(Subscription);

impl<'a> Announcement<'a> {
    /// A message for present subscribers only: not retained, and without properties.
    #[must_use]
    pub const fn passing(topic: &'a str, payload: &'a [u8]) -> Announcement<'a> {
        Announcement { topic, payload, retain: false, properties: &[] }
    }
}

impl Broker {
    /// A broker that puts messages into its subscribers' queues itself, within the call that publishes them.
    #[must_use]
    pub fn new(rights: impl Rights + 'static) -> Broker {
        Broker::of(rights, None)
    }

    /// A broker whose messages this router delivers. The broker itself delivers to shared subscriptions, because no
    /// router knows them.
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

    /// Makes connections ask the [`Rights`] again. Call this when an answer of theirs has changed.
    pub fn rights_changed(&self) {
        self.readers.note_change();
    }

    /// Multiplies the room for the program's retained messages, `limits::PROGRAM_KEPT` and its bytes. For a program
    /// that publishes the same topics for several things.
    pub fn set_program_room(&self, times: usize) {
        self.retained.set_program_room(times);
    }

    /// Whether a client may leave a will on this topic, if the topic is in its `Scope`. Call this before answering
    /// the client's CONNECT.
    #[must_use]
    pub fn may_leave_will(&self, who: Tier, topic: &str) -> bool {
        filter::topic(topic).is_ok() && self.rights.may_leave_will(who, topic)
    }

    pub(crate) fn may_share(&self, who: Tier, filter: &str) -> bool {
        self.rights.may_share(who, filter)
    }

    /// Publishes a message of the program at QoS 1, without waiting for any subscriber. Returns false only if the
    /// message was to be retained and there was no room.
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
        // The message is retained before it is sent, so that a client that subscribes in between gets it.
        self.send(&message, &self.readers.of(topic, None));
        is_kept
    }

    /// Publishes the will of a client. The caller has checked that the client may leave it. `now` is on the clock of
    /// all connections.
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
            tracing::warn!(topic = will.topic, "the will is not retained, because there are too many retained messages");
        }
        self.send(&message, &self.readers.of(&will.topic, None));
    }

    /// Subscribes the program itself at QoS 1. The filters must be valid: they are not checked here.
    #[must_use]
    pub fn subscribe(&self, filters: &[&str]) -> OwnSubscription {
        let mut subscription = Subscription::new(&self.readers);
        for filter in filters {
            subscription.hold(filter, Grant::at(Qos::One));
        }
        OwnSubscription(subscription)
    }

    /// Size in bytes of the messages that wait for clients and are not retained.
    #[must_use]
    pub fn beside(&self) -> usize {
        let kept = self.retained.bytes();
        self.alive.load(Ordering::Relaxed).saturating_sub(kept)
    }

    pub(crate) fn message(&self, draft: Draft<'_>) -> Arc<Message> {
        Arc::new(Message::new(draft, self.retained.stamp(), &self.alive))
    }

    /// Sends a message to each of its readers, and to one reader of each group with a shared subscription. The broker
    /// itself delivers to groups, because no router knows them.
    pub(crate) fn send(&self, message: &Arc<Message>, readers: &TopicReaders) {
        let put = |reader: &TopicReader| reader.subscriber.put(Delivery::of(message, reader), || self.has_room_for_away());
        match self.readers.router().filter(|_| !readers.each.is_empty()) {
            Some(router) => router.carry(RoutedDelivery::begin(Arc::clone(message), &readers.each, self.has_room_for_away())),
            None => readers.each.iter().for_each(put),
        }
        self.readers.in_turn(&readers.groups).for_each(put);
    }

    /// Whether more messages may be stored for clients that are away. Such clients cannot read, and there may be many
    /// of them.
    pub(crate) fn has_room_for_away(&self) -> bool {
        self.beside() <= AWAY
    }

    pub(crate) fn print(&self, of: impl Hash) -> u64 {
        self.hasher.hash_one(of)
    }
}

impl OwnSubscription {
    /// Waits for the next message. A program that reads too slowly loses the oldest messages, like any subscriber.
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
