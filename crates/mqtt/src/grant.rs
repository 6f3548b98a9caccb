//! The terms of one granted subscription. They are the terms that its SUBSCRIBE asked for, since no QoS is lowered.

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
    /// A grant of this QoS, and otherwise on the terms of MQTT 3.1.1.
    pub(crate) const fn at(qos: Qos) -> Grant {
        Grant { options: Options::at(qos), id: None }
    }

    pub(crate) fn ids(&self) -> Ids {
        self.id.map(|id| Arc::from([id]))
    }
}
