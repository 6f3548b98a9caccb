//! The events of a connection to another broker.

use bytes::Bytes;

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Event {
    Greeted {
        /// Maximum packet size that the broker accepts, in bytes. `None` if the broker names no maximum.
        largest: Option<u32>,
        /// Maximum number of unacknowledged messages that the broker accepts. `None` if the broker names no maximum.
        receive_maximum: Option<u16>,
    },
    /// For each of our filters, in their order: whether the broker granted it.
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
    /// The packet id. It is 0 for a message with QoS 0.
    pub(super) id: u16,
    pub(super) is_duplicate: bool,
    pub(super) retain: bool,
    /// Response topic and correlation data of MQTT 5.
    pub(super) answer_to: Option<(String, Option<Bytes>)>,
}
