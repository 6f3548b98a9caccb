//! How the door is opened: to everybody on this machine, or to whoever has a key. What is said of it is the command line's part.

use crate::access::{Access, AccessError, KeyFile, Keyring, Token};
use crate::config::{Broker, HttpSettings, Settings};
use crate::doors::http::{Front, Tls, TlsError};

#[derive(Debug)]
pub enum FirstAccess {
    /// Everybody on this machine is let in.
    Open,
    /// By a key that was made before.
    Key,
    /// By none: the keys there are cannot be had, for this reason.
    Unusable(String),
    /// By an operator's key that was just made and is kept.
    NewKey(Token),
    /// By an operator's key that was just made and is good until the program ends.
    BriefKey(Token),
}

pub(super) struct Opened {
    pub(super) http: Access,
    /// At our own MQTT broker, by TCP.
    pub(super) mqtt: Access,
    pub(super) entry: FirstAccess,
}

/// Who is let in, by these settings; a first key is made where there is none and one is asked for.
pub(super) fn access(settings: &Settings) -> Result<Opened, AccessError> {
    let mqtt_asks = mqtt_asks(settings);
    if !settings.http.asks_for_keys && !mqtt_asks {
        return Ok(Opened { http: Access::Open, mqtt: Access::Open, entry: FirstAccess::Open });
    }
    let (keys, entry) = keys(settings)?;
    let access = |asks| if asks { keys.clone() } else { Access::Open };
    Ok(Opened { http: access(settings.http.asks_for_keys), mqtt: access(mqtt_asks), entry })
}

fn mqtt_asks(settings: &Settings) -> bool {
    matches!(settings.mqtt.broker, Some(Broker::Own { asks_for_keys: true, .. }))
}

/// Why the keys cannot be had, where any are asked for and there are some: then nobody can press STOP there, and nothing is to
/// move (safety R5).
pub(super) fn unusable(settings: &Settings) -> Option<String> {
    let folder = settings.store.as_ref().filter(|_| settings.http.asks_for_keys || mqtt_asks(settings))?;
    let error = KeyFile::within(folder).read().err()?;
    Some(format!("nobody can sign in: {error}; then start hallsweep again"))
}

fn keys(settings: &Settings) -> Result<(Access, FirstAccess), AccessError> {
    let (keyring, entry) = match &settings.store {
        None => {
            let keyring = Keyring::in_memory()?;
            let token = first(&keyring)?;
            (keyring, FirstAccess::BriefKey(token))
        }
        Some(folder) => {
            let opened = Keyring::open(folder)?;
            let entry = match opened.unusable {
                Some(error) => FirstAccess::Unusable(error.to_string()),
                None if opened.is_new => FirstAccess::NewKey(first(&opened.keyring)?),
                None => FirstAccess::Key,
            };
            (opened.keyring, entry)
        }
    };
    Ok((Access::Keys(keyring), entry))
}

pub(super) fn front(http: &HttpSettings) -> Result<Front, TlsError> {
    let tls = http.tls.as_ref().map(|files| Tls::load(&files.certificate, &files.key)).transpose()?;
    Ok(Front { hosts: http.hosts.clone(), tls, ..Front::default() })
}

/// The token of the key that is made at first start.
fn first(keyring: &Keyring) -> Result<Token, AccessError> {
    keyring.keys().named(crate::access::OPERATOR).map(|key| key.token.clone())
}
