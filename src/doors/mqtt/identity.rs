//! Who a client is, by what its CONNECT shows: our own session, somebody on this machine at an open door, or whoever has a key, whose
//! name is the user name and whose token is the password.

use std::net::IpAddr;
use std::sync::Arc;

use subtle::ConstantTimeEq;

use super::commands::{Commands, IncomingMessage, Publisher, Taken};
use super::incoming::Origin;
use super::rights;
use super::seats::Holder;
use crate::access::{Access, Caller, Need, Token};
use hallsweep_core::units;
use mqtt_gate::Principal;
use mqtt_gate::packet::connect;
use mqtt_gate::{CommandDecision, Epoch, Listener};

/// The name by which our own session comes. No key can have it.
pub const OWN_SESSION: &str = "$hallsweep";

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Identity {
    OwnSession,
    Somebody(Caller),
}

/// Why it is nobody.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unknown {
    /// It shows nothing, and something is asked for.
    Nothing,
    Wrong,
}

impl Identity {
    /// Who this client is, by the name and the password of its CONNECT.
    pub(super) fn of(credentials: &connect::Credentials, origin: &Origin, secret: &Token) -> Result<Identity, Unknown> {
        let password = credentials.password.as_deref().unwrap_or_default();
        let name = credentials.name.as_deref();
        if name == Some(OWN_SESSION) {
            let is_ours = secret.reveal().as_bytes().ct_eq(password);
            return if is_ours.into() { Ok(Identity::OwnSession) } else { Err(Unknown::Wrong) };
        }
        if let Some(caller) = origin.caller.clone().or_else(|| origin.access.unasked(origin.from)) {
            return Ok(Identity::Somebody(caller));
        }
        let (Access::Keys(keyring), Some(name)) = (&origin.access, name) else { return Err(Unknown::Nothing) };
        let token = std::str::from_utf8(password).unwrap_or_default();
        let signed_in = keyring.check(token).filter(|signed_in| &*signed_in.name == name);
        signed_in.map(|signed_in| Identity::Somebody(Caller::Known(signed_in))).ok_or(Unknown::Wrong)
    }

    pub(super) fn name(&self) -> Arc<str> {
        match self {
            Identity::OwnSession => Arc::from(OWN_SESSION),
            Identity::Somebody(caller) => caller.name(),
        }
    }

    /// Whether its name is that of a key.
    pub(super) const fn has_key(&self) -> bool {
        matches!(self, Identity::Somebody(Caller::Known(_)))
    }

    /// Whose seat it takes; our own session needs none.
    pub(super) fn holder(&self) -> Option<Holder> {
        let Identity::Somebody(caller) = self else { return None };
        Some(Holder { who: caller.name(), is_viewer: caller.may(Need::Act).is_err(), has_share: self.has_key() })
    }

    /// What the gate wants to know.
    pub(super) const fn principal(&self) -> Principal {
        match self {
            Identity::OwnSession => Principal::Program,
            Identity::Somebody(caller) => rights::principal(caller.role()),
        }
    }

    /// Whether it would be let in still; `now_s` in seconds since 1970.
    pub(super) fn is_known(&self, access: &Access, now_s: i64) -> bool {
        match self {
            Identity::OwnSession => true,
            Identity::Somebody(caller) => access.still_knows(caller, now_s),
        }
    }

    /// Who hears its commands. Our own session gives none: what it says on the old topics is news.
    pub(super) fn listener(&self, commands: &Commands, from: IpAddr) -> Arc<dyn Listener> {
        match self {
            Identity::OwnSession => Arc::new(Deaf),
            Identity::Somebody(caller) => {
                let from = Arc::from(from.to_canonical().to_string());
                Arc::new(CommandListener {
                    commands: commands.clone(),
                    publisher: Publisher::Known { caller: caller.clone(), from },
                })
            }
        }
    }
}

struct CommandListener {
    commands: Commands,
    publisher: Publisher,
}

struct Deaf;

impl Listener for CommandListener {
    fn hear(&self, topic: &str, payload: &[u8], (arrived, is_again): (Option<Epoch>, bool)) -> CommandDecision {
        let arrived = arrived.map(|Epoch(epoch)| units::Epoch(epoch));
        match self.commands.take(&IncomingMessage { topic, payload, arrived, is_again }, &self.publisher) {
            Taken::NotACommand | Taken::Taken => CommandDecision::Pass,
            Taken::Forbidden => CommandDecision::Forbidden,
        }
    }

    fn epoch(&self) -> Epoch {
        Epoch(self.commands.epoch().0)
    }

    fn hear_urgent(&self, topic: &[u8], payload: &[u8]) -> bool {
        self.commands.halts(topic, payload, &self.publisher)
    }
}

impl Listener for Deaf {
    fn hear(&self, _: &str, _: &[u8], _: (Option<Epoch>, bool)) -> CommandDecision {
        CommandDecision::Pass
    }

    fn epoch(&self) -> Epoch {
        Epoch(0)
    }

    fn hear_urgent(&self, _: &[u8], _: &[u8]) -> bool {
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::{Key, Keyring, Keys, Role};

    struct Tokens {
        access: Access,
        operator: String,
        viewer: String,
    }

    fn keys() -> Tokens {
        let [operator, viewer] = [Token::draw().unwrap(), Token::draw().unwrap()];
        let keys = vec![
            Key::new("operator", Role::Operator, operator.clone()).unwrap(),
            Key::new("screen", Role::Viewer, viewer.clone()).unwrap(),
        ];
        let access = Access::Keys(Keyring::of(Keys::new(keys).unwrap()));
        Tokens { access, operator: operator.reveal().to_owned(), viewer: viewer.reveal().to_owned() }
    }

    fn of(access: &Access, from: &str, login: Option<(&str, &str)>, secret: &Token) -> Result<Identity, Unknown> {
        let credentials = connect::Credentials {
            name: login.map(|(name, _)| name.to_owned()),
            password: login.map(|(_, password)| password.to_owned().into()),
            is_five: false,
        };
        let origin = Origin { from: from.parse().unwrap(), caller: None, access: access.clone() };
        Identity::of(&credentials, &origin, secret)
    }

    /// Safety A4.
    #[test]
    fn a_name_and_its_token_let_somebody_in_with_the_role_of_the_key() {
        let (keys, secret) = (keys(), Token::draw().unwrap());
        let try_in = |login| of(&keys.access, "192.0.2.7", login, &secret);
        let who = |login| try_in(Some(login)).map(|identity| identity.principal());
        assert_eq!(who(("operator", &keys.operator)), Ok(rights::principal(Role::Operator)));
        assert_eq!(who(("screen", &keys.viewer)), Ok(rights::principal(Role::Viewer)));
        assert_eq!(who(("operator", &keys.viewer)), Err(Unknown::Wrong), "somebody else's token");
        assert_eq!(who(("nobody", "secret")), Err(Unknown::Wrong));
        assert_eq!(try_in(None), Err(Unknown::Nothing));
        assert_eq!(of(&keys.access, "127.0.0.1", None, &secret), Err(Unknown::Nothing), "this machine is asked too");
    }

    /// Safety A1.
    #[test]
    fn an_open_door_is_open_to_this_machine_alone() {
        let secret = Token::draw().unwrap();
        let here = of(&Access::Open, "127.0.0.1", Some(("anybody", "at all")), &secret);
        assert_eq!(here, Ok(Identity::Somebody(Caller::Here)));
        assert_eq!(of(&Access::Open, "192.0.2.7", None, &secret), Err(Unknown::Nothing));
    }

    #[test]
    fn nobody_is_our_own_session_without_its_secret() {
        let secret = Token::draw().unwrap();
        assert_eq!(of(&Access::Open, "127.0.0.1", Some((OWN_SESSION, secret.reveal())), &secret), Ok(Identity::OwnSession));
        assert_eq!(of(&Access::Open, "127.0.0.1", Some((OWN_SESSION, "guess")), &secret), Err(Unknown::Wrong));
        assert!(Key::new(OWN_SESSION, Role::Viewer, secret).is_err(), "no key has this name");
    }
}
