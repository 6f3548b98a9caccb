//! What happens on a connection to a broker.

use bytes::Bytes;

/// What happens on a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Event {
    /// We are let in.
    Greeted {
        /// The longest packet that the broker takes, in bytes, if it says so,
        largest: Option<u32>,
        /// and how many messages it leaves unacknowledged.
        receive_maximum: Option<u16>,
    },
    /// Whether each of our filters was granted.
    Subscribed(Vec<bool>),
    /// The broker has the publication of this id.
    Acknowledged {
        id: u16,
        /// It says that it does not take it.
        is_refused: bool,
    },
    /// Somebody has said something.
    Heard(Heard),
    /// A publication is on its way under this id.
    Sent(u16),
    /// Our farewell is on its way.
    HungUp,
    /// What nobody needs to know.
    Other,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Heard {
    pub(super) topic: String,
    pub(super) payload: Bytes,
    /// 0 at QoS 0.
    pub(super) id: u16,
    pub(super) is_duplicate: bool,
    pub(super) retain: bool,
    /// Where an answer is wanted, and by what it is known.
    pub(super) answer_to: Option<(String, Option<Bytes>)>,
}
