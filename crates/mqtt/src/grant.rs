//! The terms of one granted subscription. They are what its SUBSCRIBE asked for, because this broker never lowers a
//! QoS.

use std::sync::Arc;

use super::packet::Qos;
use super::packet::filters::Options;

/// Subscription ids of a message; most messages have none.
pub(crate) type Ids = Option<Arc<[u32]>>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grant {
    pub(crate) options: Options,
    pub(crate) id: Option<u32>,
}

impl Grant {
    /// A grant of this QoS. Its other terms are those of MQTT 3.1.1.
    pub(crate) const fn at(qos: Qos) -> Grant {
        Grant { options: Options::at(qos), id: None }
    }

    pub(crate) fn ids(&self) -> Ids {
        self.id.map(|id| Arc::from([id]))
    }
}
