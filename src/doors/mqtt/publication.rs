//! One message that goes out, ready to be published. How it gets to a broker is not here.

use bytes::Bytes;

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
}
