//! The sender of a message and the sender's rights. For clients of our own broker, the gate has checked the
//! credentials.

use std::sync::Arc;

use crate::access::{Caller, Need};
use crate::api::door;
use hallsweep_core::command::Issuer;
use hallsweep_core::refused::Refused;

/// The recorded name of every sender at another broker.
const NOBODY_KNOWN: &str = "mqtt";

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Publisher {
    Known {
        caller: Caller,
        /// The address, such as `192.0.2.7`.
        from: Arc<str>,
    },
    /// A client of another broker. Only that broker knows the client, and decides who may publish commands.
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

    /// Returns the name of the sender's key, or `None` if the sender has no key.
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
