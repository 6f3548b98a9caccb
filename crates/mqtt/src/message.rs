//! One message, shared by all its receivers and counted while it is in memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use bytes::Bytes;

use crate::limits::MESSAGE_COST;
use crate::packet::Qos;

/// An id that is never used again while the program runs, since a message may outlive its publisher.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SubscriberId(pub(crate) u64);

/// A message as it was published. It never changes, and is shared by all its readers.
#[derive(Debug)]
pub struct Message {
    topic: Arc<str>,
    payload: Box<[u8]>,
    qos: Qos,
    retain: bool,
    /// Its publisher's properties, in the encoding of MQTT 5.
    properties: Box<[u8]>,
    expires_at: Option<Duration>,
    /// The client that published the message. `None` for a message of the program, and for a client's will.
    publisher: Option<SubscriberId>,
    /// The stamp of the message that was retained last when this message was made. A stamp is a sequence number:
    /// messages that are retained later have higher stamps.
    pub(crate) stamp: u64,
    /// Total size in bytes of all messages in memory.
    alive: Arc<AtomicUsize>,
}

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

/// Shares a message's payload without a copy. The message stays in memory while the payload is used.
struct Payload(Arc<Message>);

#[cfg(test)]
impl<'a> Draft<'a> {
    /// A draft without properties.
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

    /// The topic on which the message was published, never a topic alias.
    #[must_use]
    pub fn topic(&self) -> &str {
        &self.topic
    }

    /// The payload. It is empty when a publisher removes the topic's retained message (section 3.3.1.3).
    #[must_use]
    pub fn payload(&self) -> &[u8] {
        &self.payload
    }

    /// The QoS at which the message was published. Subscribers get it at this QoS or a lower one.
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

    /// The seconds until the message expires; `None` if it never does, `Some(0)` if it has expired (MQTT 5, section
    /// 3.3.2.3.3).
    pub(crate) fn good_for_s(&self, now: Duration) -> Option<u32> {
        let left = self.expires_at?.saturating_sub(now);
        // Rounded up, so that 0 stands for expired messages only.
        Some(u32::try_from(left.as_millis().div_ceil(1000)).unwrap_or(u32::MAX))
    }

    pub(crate) fn is_over(&self, now: Duration) -> bool {
        self.expires_at.is_some_and(|at| at <= now)
    }

    pub(crate) fn is_by(&self, subscriber: SubscriberId) -> bool {
        self.publisher == Some(subscriber)
    }

    pub(crate) const fn expires_at(&self) -> Option<Duration> {
        self.expires_at
    }

    /// Approximate memory that the message takes, in bytes.
    pub(crate) fn cost(&self) -> usize {
        MESSAGE_COST + self.topic.len() + self.payload.len() + self.properties.len()
    }

    pub(crate) fn shared_topic(&self) -> Arc<str> {
        Arc::clone(&self.topic)
    }

    /// Returns the payload without a copy. The whole message stays in memory while the payload is used.
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
