//! Who publishes a message, as far as that is known, and what he may. How somebody at our own broker has shown who he is, is the
//! gate's business.

use std::sync::Arc;

use crate::access::{Caller, Need};
use crate::api::door;
use hallsweep_core::command::{Issuer, Refused};

/// The name in records of whoever commands through somebody else's broker.
const NOBODY_KNOWN: &str = "mqtt";

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Publisher {
    /// Somebody at our own broker.
    Known {
        caller: Caller,
        /// The address, as `192.0.2.7`.
        from: Arc<str>,
    },
    /// Somebody at somebody else's broker, which alone knows who, and decides by its own rights who may publish commands.
    Unknown {
        /// That broker's host.
        broker: Arc<str>,
    },
}

impl Publisher {
    pub fn may(&self, need: Need) -> Result<(), Refused> {
        match self {
            Publisher::Known { caller, .. } => caller.may(need).map_err(Refused::NotAllowed),
            Publisher::Unknown { .. } => Ok(()),
        }
    }

    pub(super) fn is_viewer(&self) -> bool {
        self.may(Need::Act).is_err()
    }

    /// The name of the key that he has shown; `None` where nobody is told from another by one.
    pub(super) fn key(&self) -> Option<Arc<str>> {
        match self {
            Publisher::Known { caller: Caller::Known(signed_in), .. } => Some(Arc::clone(&signed_in.name)),
            Publisher::Known { caller: Caller::Here, .. } | Publisher::Unknown { .. } => None,
        }
    }

    pub fn issuer(&self) -> Issuer {
        let (who, from) = match self {
            Publisher::Known { caller, from } => (caller.name(), Arc::clone(from)),
            Publisher::Unknown { broker } => (Arc::from(NOBODY_KNOWN), Arc::clone(broker)),
        };
        Issuer { door: door::MQTT, who, from }
    }
}
