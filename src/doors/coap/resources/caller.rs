//! The identity of a sender, known by its address alone. A sender on this machine counts as the operator. All others
//! may only read. The endpoint decides whether an address is verified. Only the other doors use keys.

use std::net::SocketAddr;

use crate::access::{Need, OPERATOR, is_this_machine};
use crate::api::door;
use hallsweep_core::command::Issuer;
use hallsweep_core::refused::Refused;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Caller {
    Here,
    Beyond,
}

impl Caller {
    pub(super) fn of(peer: SocketAddr) -> Caller {
        if is_this_machine(peer.ip()) { Caller::Here } else { Caller::Beyond }
    }

    pub(super) fn check(self, need: Need) -> Result<(), Refused> {
        match (self, need) {
            (Caller::Here, _) | (Caller::Beyond, Need::Nothing | Need::See) => Ok(()),
            // The text is short, because an unverified address gets at most three times the bytes of its request.
            (Caller::Beyond, Need::Stop | Need::Act) => {
                Err(Refused::NotAllowed("CoAP commands work only on loopback: use HTTP".to_owned()))
            }
        }
    }
}

pub(super) fn issuer(peer: SocketAddr) -> Issuer {
    Issuer { door: door::COAP, who: OPERATOR.into(), from: peer.ip().to_canonical().to_string().into() }
}

#[cfg(test)]
pub(super) const fn in_words(need: Need) -> &'static str {
    match need {
        Need::Nothing | Need::See => "anybody",
        Need::Stop | Need::Act => "this machine",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn caller(address: &str) -> Caller {
        Caller::of(SocketAddr::new(address.parse().unwrap(), 40_000))
    }

    /// Safety A4.
    #[test]
    fn who_is_not_on_this_machine_may_look_and_nothing_else() {
        for here in ["127.0.0.1", "127.8.0.9", "::1", "::ffff:127.0.0.1"] {
            assert!(caller(here).check(Need::Act).is_ok(), "{here}");
        }
        for beyond in ["192.0.2.7", "::ffff:192.0.2.7", "2001:db8::1", "0.0.0.0", "fe80::1"] {
            assert!(caller(beyond).check(Need::See).is_ok(), "{beyond}");
            for need in [Need::Act, Need::Stop] {
                assert_eq!(caller(beyond).check(need).unwrap_err().code(), "notAllowed", "{beyond}");
            }
        }
    }

    /// Safety A6.
    #[test]
    fn records_name_the_door_and_the_address() {
        let issuer = issuer("[::ffff:127.0.0.1]:40000".parse().unwrap());
        assert_eq!(issuer.to_string(), "operator (coap, 127.0.0.1)");
    }
}
