//! One message, which all who get it have in common, and which is counted for as long as anybody has it.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use bytes::Bytes;

use crate::limits::MESSAGE_COST;
use crate::packet::Qos;

/// Tells one subscriber from others, for as long as the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SubscriberId(pub(crate) u64);

/// A message as it was published.
#[derive(Debug)]
pub struct Message {
    topic: Arc<str>,
    payload: Box<[u8]>,
    qos: Qos,
    /// Whether it was to be kept.
    retain: bool,
    /// What its publisher said beside it, written as properties of MQTT 5.
    properties: Box<[u8]>,
    /// From when on it is good for nobody.
    expires_at: Option<Duration>,
    /// Who published it, if that was a client that is here.
    publisher: Option<SubscriberId>,
    /// What is kept later than this was kept no earlier than this message was published.
    pub(crate) stamp: u64,
    /// The bytes of all messages that anybody has.
    alive: Arc<AtomicUsize>,
}

/// What is to become a message.
#[derive(Clone, Debug)]
pub(crate) struct Draft<'a> {
    pub(crate) topic: Arc<str>,
    pub(crate) payload: &'a [u8],
    pub(crate) qos: Qos,
    pub(crate) retain: bool,
    pub(crate) properties: &'a [u8],
    pub(crate) expires_at: Option<Duration>,
    pub(crate) publisher: Option<SubscriberId>,
}

/// A message, for the sake of its payload.
struct Payload(Arc<Message>);

#[cfg(test)]
impl<'a> Draft<'a> {
    /// One with nothing beside it.
    pub(crate) fn plain(topic: &str, payload: &'a [u8], qos: Qos) -> Draft<'a> {
        Draft { topic: Arc::from(topic), payload, qos, retain: false, properties: &[], expires_at: None, publisher: None }
    }
}

impl Message {
    pub(crate) fn new(draft: Draft<'_>, stamp: u64, alive: &Arc<AtomicUsize>) -> Message {
        let Draft { topic, payload, qos, retain, properties, expires_at, publisher } = draft;
        let (payload, properties, alive) = (payload.into(), properties.into(), Arc::clone(alive));
        let message = Message { topic, payload, qos, retain, properties, expires_at, publisher, stamp, alive };
        message.alive.fetch_add(message.cost(), Ordering::Relaxed);
        message
    }

    /// Where it was published.
    #[must_use]
    pub fn topic(&self) -> &str {
        &self.topic
    }

    /// What was said.
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        &self.payload
    }

    /// How it was published: nobody gets it more surely than that.
    #[must_use]
    pub const fn qos(&self) -> Qos {
        self.qos
    }

    pub(crate) const fn retain(&self) -> bool {
        self.retain
    }

    pub(crate) fn properties(&self) -> &[u8] {
        &self.properties
    }

    /// For how long it is good still, in seconds, if not for ever; `Some(0)`: for no longer (MQTT 5, section 3.3.2.3.3).
    pub(crate) fn good_for_s(&self, now: Duration) -> Option<u32> {
        let left = self.expires_at?.saturating_sub(now);
        // One that has begun is a whole one: only what is over is 0.
        Some(u32::try_from(left.as_millis().div_ceil(1000)).unwrap_or(u32::MAX))
    }

    /// Whether it is good for nobody any more.
    pub(crate) fn is_over(&self, now: Duration) -> bool {
        self.expires_at.is_some_and(|at| at <= now)
    }

    /// Whether this one has published it.
    pub(crate) fn is_by(&self, subscriber: SubscriberId) -> bool {
        self.publisher == Some(subscriber)
    }

    pub(crate) const fn expires_at(&self) -> Option<Duration> {
        self.expires_at
    }

    /// What it takes, in bytes, about.
    pub(crate) fn cost(&self) -> usize {
        MESSAGE_COST + self.topic.len() + self.payload.len() + self.properties.len()
    }

    pub(crate) fn shared_topic(&self) -> Arc<str> {
        Arc::clone(&self.topic)
    }

    /// Its payload, which is not copied, and with it the whole of it.
    pub(crate) fn shared_payload(self: &Arc<Message>) -> Bytes {
        Bytes::from_owner(Payload(Arc::clone(self)))
    }
}

impl Drop for Message {
    fn drop(&mut self) {
        self.alive.fetch_sub(self.cost(), Ordering::Relaxed);
    }
}

impl AsRef<[u8]> for Payload {
    fn as_ref(&self) -> &[u8] {
        &self.0.payload
    }
}
