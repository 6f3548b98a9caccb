//! Who is admitted, and who a sender is: everybody on this machine, or whoever has a key. Each door decides how a client shows
//! its key.

use std::net::IpAddr;
use std::sync::Arc;

use super::keyring::Keyring;
use super::keys::{OPERATOR, SignedIn};
use super::moment::Moment;
use super::network::is_this_machine;
use super::role::{Need, Role};

#[derive(Clone, Debug)]
pub enum Access {
    /// Everybody on this machine, as the operator; nobody else.
    Open,
    Keys(Keyring),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Caller {
    /// Somebody on this machine, at an open door.
    Here,
    Known(SignedIn),
}

impl Access {
    pub fn unasked(&self, address: IpAddr) -> Option<Caller> {
        (matches!(self, Access::Open) && is_this_machine(address)).then_some(Caller::Here)
    }

    /// The key by which quotas are counted; `None` without a key.
    pub fn key_of(&self, caller: &Caller) -> Option<Arc<str>> {
        match self {
            Access::Open => None,
            Access::Keys(_) => Some(caller.name()),
        }
    }

    pub fn still_knows(&self, caller: &Caller, now: Moment) -> bool {
        match (self, caller) {
            (Access::Open, Caller::Here) => true,
            (Access::Keys(keyring), Caller::Known(signed_in)) => keyring.still_knows(signed_in, now),
            (Access::Open, Caller::Known(_)) | (Access::Keys(_), Caller::Here) => false,
        }
    }
}

impl Caller {
    pub fn name(&self) -> Arc<str> {
        match self {
            Caller::Here => Arc::from(OPERATOR),
            Caller::Known(signed_in) => Arc::clone(&signed_in.name),
        }
    }

    /// Name of the caller in records and on pages: the key, followed by the person who gave a name, such as `operator (Anna)`.
    pub fn signature(&self) -> Arc<str> {
        match self {
            Caller::Known(SignedIn { name, person: Some(person), .. }) => format!("{name} ({person})").into(),
            Caller::Here | Caller::Known(_) => self.name(),
        }
    }

    pub const fn role(&self) -> Role {
        match self {
            Caller::Here => Role::Operator,
            Caller::Known(signed_in) => signed_in.role,
        }
    }

    /// The error is a message for the caller.
    pub fn may(&self, need: Need) -> Result<(), String> {
        if self.role().may(need) {
            return Ok(());
        }
        Err(format!(
            "you are signed in as `{}` with the role {}, which may see everything and press STOP; this request needs an \
             operator's key",
            self.name(),
            self.role().name()
        ))
    }
}
