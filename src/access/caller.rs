//! Who is admitted, and who a client is. Either everybody on this machine is admitted, or everybody who has a key.
//! Each door (HTTP, CoAP, MQTT) decides how a client sends its key.

use std::net::IpAddr;
use std::sync::Arc;

use super::keyring::Keyring;
use super::keys::{OPERATOR, SignedIn, sees};
use super::moment::Moment;
use super::network::is_this_machine;
use super::role::{Need, Role};
use hallsweep_core::hall::HallId;

#[derive(Clone, Debug)]
pub enum Access {
    /// Admits everybody on this machine as the operator, and nobody else.
    Open,
    Keys(Keyring),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Caller {
    /// A client on this machine, where no key is required.
    Here,
    Known(SignedIn),
}

impl Access {
    pub fn unasked(&self, address: IpAddr) -> Option<Caller> {
        (matches!(self, Access::Open) && is_this_machine(address)).then_some(Caller::Here)
    }

    /// Name of the key for which the caller's quotas are counted; `None` when no keys are required.
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

    /// The caller's name in records and on pages: the name of the key. If a person gave a name, it follows in
    /// brackets, as in `operator (Anna)`.
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

    /// Whether the caller may know of this hall. What the caller may do there, its role says: see `may`.
    pub fn sees(&self, hall: &HallId) -> bool {
        match self {
            Caller::Here => true,
            Caller::Known(signed_in) => sees(signed_in.halls.as_deref(), hall),
        }
    }

    /// Checks that the caller has the right `need`. The error is a message for the caller.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::keys::{Keys, halls};

    #[test]
    fn a_limited_key_sees_its_halls_and_no_other_and_its_role_stays_its_role() {
        let [main, south, east, sout] = ["main", "south", "east", "sout"].map(|name| HallId::new(name).unwrap());
        let mut keys = Keys::first().unwrap();
        let limited = Some(halls(["south", "east"]).unwrap());
        keys.add("lobby", Role::Viewer, limited.clone()).unwrap();
        keys.add("south-desk", Role::Operator, limited).unwrap();
        keys.add("wall", Role::Viewer, None).unwrap();
        let caller = |name: &str| Caller::Known(keys.check(keys.named(name).unwrap().token.reveal()).unwrap());
        for (caller, sees_all, may_act) in [
            (Caller::Here, true, true),
            (caller("operator"), true, true),
            (caller("wall"), true, false),
            (caller("lobby"), false, false),
            (caller("south-desk"), false, true),
        ] {
            let seen = [&south, &east, &main, &sout].map(|hall| caller.sees(hall));
            assert_eq!(seen, [true, true, sees_all, sees_all], "{caller:?}");
            assert_eq!(caller.may(Need::Act).is_ok(), may_act, "{caller:?}");
        }
        for key in keys.iter() {
            assert!([&south, &main].iter().all(|hall| key.sees(hall) == caller(&key.name).sees(hall)), "{}", key.name);
        }
    }
}
