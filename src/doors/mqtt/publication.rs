//! One message that goes out, ready to be published. How it gets to a broker is not here.

use bytes::Bytes;

/// No message is larger, in either direction: a photo with some room. At rumqttc's own 10 KiB the first map ends a connection.
pub(super) const LARGEST: usize = 2 << 20;

/// A publication's headers are never longer than this, its topic aside.
const HEADERS: usize = 16;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Publication {
    pub topic: String,
    pub payload: Bytes,
    /// Whether a broker keeps it for whoever subscribes later.
    pub retain: bool,
}

impl Publication {
    /// The state of something: kept by the broker, so that a newcomer sees it at once.
    pub fn kept(topic: String, payload: impl Into<Bytes>) -> Publication {
        Publication { topic, payload: payload.into(), retain: true }
    }

    /// Something that happened: for those who listen now.
    pub fn passing(topic: String, payload: impl Into<Bytes>) -> Publication {
        Publication { topic, payload: payload.into(), retain: false }
    }

    /// Whether a broker takes it; the log says so of one that it would not: sent, that would end every connection anew.
    pub(super) fn fits(&self) -> bool {
        let size = self.topic.len() + self.payload.len() + HEADERS;
        if size > LARGEST {
            tracing::warn!(topic = self.topic, size_bytes = size, "a message is not published, because it is too large");
        }
        size <= LARGEST
    }
}
