//! The sender of a message, as far as it is known, and its rights. The gate checks the credentials of our own broker's clients.

use std::sync::Arc;

use crate::access::{Caller, Need};
use crate::api::door;
use hallsweep_core::command::Issuer;
use hallsweep_core::refused::Refused;

/// Name of a sender at another broker, as recorded.
const NOBODY_KNOWN: &str = "mqtt";

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Publisher {
    Known {
        caller: Caller,
        /// The address, such as `192.0.2.7`.
        from: Arc<str>,
    },
    /// A client of another broker. Only that broker knows who the client is, and decides by its own rights who may publish
    /// commands.
    Unknown { broker: Arc<str> },
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

    /// The name of the sender's key; `None` if keys do not tell senders apart.
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
