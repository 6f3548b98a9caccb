//! The terms of one granted subscription: those that its SUBSCRIBE asked for, since no QoS is lowered.

use std::sync::Arc;

use super::packet::Qos;
use super::packet::filters::Options;

/// Subscription ids; most messages have none.
pub(crate) type Ids = Option<Arc<[u32]>>;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grant {
    pub(crate) options: Options,
    pub(crate) id: Option<u32>,
}

impl Grant {
    /// This QoS, and otherwise the terms of MQTT 3.1.1.
    pub(crate) const fn at(qos: Qos) -> Grant {
        Grant { options: Options::at(qos), id: None }
    }

    pub(crate) fn ids(&self) -> Ids {
        self.id.map(|id| Arc::from([id]))
    }
}
