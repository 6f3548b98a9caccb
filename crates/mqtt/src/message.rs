//! One message, which all who get it have in common, and which is counted for as long as anybody has it.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use bytes::Bytes;

use crate::limits::MESSAGE_COST;
use crate::packet::Qos;

/// A message as it was published.
#[derive(Debug)]
pub struct Message {
    topic: Arc<str>,
    payload: Box<[u8]>,
    qos: Qos,
    /// What is kept later than this was kept no earlier than this message was published.
    pub(crate) stamp: u64,
    /// The bytes of all messages that anybody has.
    alive: Arc<AtomicUsize>,
}

/// A message, for the sake of its payload.
struct Payload(Arc<Message>);

impl Message {
    pub(crate) fn new(topic: Arc<str>, payload: &[u8], qos: Qos, stamp: u64, alive: &Arc<AtomicUsize>) -> Message {
        let message = Message { topic, payload: payload.into(), qos, stamp, alive: Arc::clone(alive) };
        alive.fetch_add(message.cost(), Ordering::Relaxed);
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

    /// What it takes, in bytes, about.
    pub(crate) fn cost(&self) -> usize {
        MESSAGE_COST + self.topic.len() + self.payload.len()
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
