//! The events of a connection to a broker.

use bytes::Bytes;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Event {
    Greeted {
        /// Maximum packet size of the broker in bytes, if it sends one.
        largest: Option<u32>,
        /// Maximum number of messages that the broker leaves unacknowledged, if it sends one.
        receive_maximum: Option<u16>,
    },
    /// Whether each of our filters was granted, in the order of the filters.
    Subscribed(Vec<bool>),
    Acknowledged {
        id: u16,
        is_refused: bool,
    },
    Heard(Heard),
    Sent(u16),
    /// Our DISCONNECT was sent.
    HungUp,
    Other,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Heard {
    pub(super) topic: String,
    pub(super) payload: Bytes,
    /// The packet id, 0 at QoS 0.
    pub(super) id: u16,
    pub(super) is_duplicate: bool,
    pub(super) retain: bool,
    /// Response topic and correlation data.
    pub(super) answer_to: Option<(String, Option<Bytes>)>,
}
