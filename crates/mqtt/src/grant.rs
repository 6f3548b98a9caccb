//! What was granted for one subscription.

use std::sync::Arc;

use super::packet::Qos;
use super::packet::filters::Options;

/// Numbers of subscriptions; most have none.
pub(crate) type Ids = Option<Arc<[u32]>>;

/// What a subscriber wanted of a filter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grant {
    pub(crate) options: Options,
    /// The number that he gave it.
    pub(crate) id: Option<u32>,
}

impl Grant {
    /// At this quality, and else as in MQTT 3.1.1.
    pub(crate) const fn at(qos: Qos) -> Grant {
        Grant { options: Options::at(qos), id: None }
    }

    /// Its number, alone.
    pub(crate) fn ids(&self) -> Ids {
        self.id.map(|id| Arc::from([id]))
    }
}
