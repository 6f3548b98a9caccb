//! Determines the identity of a client from its CONNECT. If the door requires no key, the client only has to be on
//! this machine. Otherwise the user name must be the name of a key, and the password must be the token of that key.

use std::net::IpAddr;
use std::sync::Arc;

use super::commands::{Commands, IncomingMessage, Publisher, Taken};
use super::halls::Halls;
use super::incoming::Origin;
use super::rights;
use super::topic_map::TopicMap;
use crate::access::{Access, Caller, Moment, Need};
use crate::doors::connection_limits::SessionOwner;
use hallsweep_core::hall::HallId;
use hallsweep_core::units;
use mqtt_gate::packet::connect;
use mqtt_gate::{AnswerTo, CommandDecision, Epoch, Listener, Said, Scope, Tier};

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Identity(pub(super) Caller);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unknown {
    /// The client sent no credentials, although the door requires them.
    Nothing,
    Wrong,
}

impl Identity {
    pub(super) fn of(credentials: &connect::Credentials, origin: &Origin) -> Result<Identity, Unknown> {
        if let Some(caller) = origin.caller.clone().or_else(|| origin.access.unasked(origin.from)) {
            return Ok(Identity(caller));
        }
        let (Access::Keys(keyring), Some(name)) = (&origin.access, credentials.name.as_deref()) else {
            return Err(Unknown::Nothing);
        };
        let token = std::str::from_utf8(credentials.password.as_deref().unwrap_or_default()).unwrap_or_default();
        let signed_in = keyring.check(token).filter(|signed_in| &*signed_in.name == name);
        signed_in.map(|signed_in| Identity(Caller::Known(signed_in))).ok_or(Unknown::Wrong)
    }

    pub(super) fn name(&self) -> Arc<str> {
        self.0.name()
    }

    pub(super) const fn has_key(&self) -> bool {
        matches!(self.0, Caller::Known(_))
    }

    pub(super) fn owner(&self) -> SessionOwner {
        SessionOwner { who: self.name(), is_viewer: self.0.may(Need::Act).is_err(), has_share: self.has_key() }
    }

    pub(super) const fn tier(&self) -> Tier {
        rights::tier(self.0.role())
    }

    pub(super) fn is_known(&self, access: &Access, now: units::Now) -> bool {
        let now = Moment { elapsed: now.since_start, unix_s: now.wall.unix_ms.div_euclid(1000) };
        access.still_knows(&self.0, now)
    }

    /// The topics that exist for the client: those of the halls that it may see, and those of no hall.
    pub(super) fn scope(&self, topics: &TopicMap) -> Scope {
        if self.0 == Caller::Here {
            return Scope::default();
        }
        let (caller, topics) = (self.0.clone(), topics.clone());
        Scope::of(move |topic| topics.hall_of(topic).is_none_or(|hall| caller.sees(&hall)))
    }

    pub(super) fn listener(&self, halls: &Halls, from: IpAddr) -> Arc<dyn Listener> {
        let from = Arc::from(from.to_canonical().to_string());
        let publisher = Publisher::Known { caller: self.0.clone(), from };
        Arc::new(CommandListener { halls: halls.clone(), scope: self.scope(halls.topics()), caller: self.0.clone(), publisher })
    }
}

struct CommandListener {
    halls: Halls,
    scope: Scope,
    caller: Caller,
    publisher: Publisher,
}

impl CommandListener {
    /// Returns the commands of the hall to which a topic belongs; `None` if there is no such hall for this client.
    fn commands_on(&self, topic: &str) -> Option<(HallId, Arc<Commands>)> {
        self.halls.on(topic).filter(|(hall, _)| self.caller.sees(hall))
    }

    /// Returns the topic that the client requested for an answer, if the client may publish there.
    fn answer_to<'a>(&self, commands: &Commands, wanted: Option<AnswerTo<'a>>) -> Option<AnswerTo<'a>> {
        commands.answer_to(wanted.filter(|wanted| self.scope.contains(wanted.topic)), &self.publisher)
    }
}

impl Listener for CommandListener {
    fn hear(&self, topic: &str, said: Said<'_>, arrived: Option<Epoch>, is_again: bool) -> CommandDecision {
        let Some((hall, commands)) = self.commands_on(topic) else { return CommandDecision::Forbidden };
        let heard = IncomingMessage {
            topic,
            payload: said.payload,
            arrived: arrived.map(|epoch| self.halls.arrived(&hall, epoch)),
            is_again,
            answer_to: self.answer_to(&commands, said.answer_to),
        };
        match commands.take(&heard, &self.publisher) {
            Taken::NotACommand | Taken::Taken => CommandDecision::Pass,
            Taken::InConfidence => CommandDecision::Keep,
            Taken::Forbidden => CommandDecision::Forbidden,
        }
    }

    fn epoch(&self) -> Epoch {
        self.halls.epoch()
    }

    fn hear_urgent(&self, Said { topic, payload, answer_to }: Said<'_>) -> bool {
        let Some((_, commands)) = self.commands_on(&String::from_utf8_lossy(topic)) else { return false };
        commands.halts(topic, payload, self.answer_to(&commands, answer_to), &self.publisher)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mqtt_gate::packet::Version;

    use crate::access::{Key, Keyring, Keys, Role, Token};

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
        let access = Access::Keys(Keyring::of(Keys::new(keys).unwrap()).unwrap());
        Tokens { access, operator: operator.reveal().to_owned(), viewer: viewer.reveal().to_owned() }
    }

    fn of(access: &Access, from: &str, login: Option<(&str, &str)>) -> Result<Identity, Unknown> {
        let credentials = connect::Credentials {
            name: login.map(|(name, _)| name.to_owned()),
            password: login.map(|(_, password)| password.to_owned().into()),
            version: Version::Three,
        };
        let origin = Origin { from: from.parse().unwrap(), caller: None, access: access.clone() };
        Identity::of(&credentials, &origin)
    }

    /// Safety A4.
    #[test]
    fn a_name_and_its_token_let_somebody_in_with_the_role_of_the_key() {
        let keys = keys();
        let try_in = |login| of(&keys.access, "192.0.2.7", login);
        let who = |login| try_in(Some(login)).map(|identity| identity.tier());
        assert_eq!(who(("operator", &keys.operator)), Ok(rights::tier(Role::Operator)));
        assert_eq!(who(("screen", &keys.viewer)), Ok(rights::tier(Role::Viewer)));
        assert_eq!(who(("operator", &keys.viewer)), Err(Unknown::Wrong), "somebody else's token");
        assert_eq!(who(("nobody", "secret")), Err(Unknown::Wrong));
        assert_eq!(try_in(None), Err(Unknown::Nothing));
        assert_eq!(of(&keys.access, "127.0.0.1", None), Err(Unknown::Nothing), "this machine is asked too");
    }

    /// Safety A1.
    #[test]
    fn an_open_door_is_open_to_this_machine_alone() {
        let here = of(&Access::Open, "127.0.0.1", Some(("anybody", "at all")));
        assert_eq!(here, Ok(Identity(Caller::Here)));
        assert_eq!(of(&Access::Open, "192.0.2.7", None), Err(Unknown::Nothing));
    }
}
