//! How the door is opened: to everybody on this machine, or to whoever has a key. What is said of it is the command line's part.

use crate::access::{Access, AccessError, Keyring, Token};
use crate::config::{HttpSettings, Settings};
use crate::inbound::http::{Front, Tls, TlsError};

/// How one gets in.
#[derive(Debug)]
pub enum Entry {
    /// Everybody on this machine is let in.
    Open,
    /// By a key that was made before.
    Key,
    /// By an operator's key that was just made and is kept.
    NewKey(Token),
    /// By an operator's key that was just made and is good until the program ends.
    BriefKey(Token),
}

/// Who is let in, by these settings; a first key is made where there is none.
pub(super) fn access(settings: &Settings) -> Result<(Access, Entry), AccessError> {
    if !settings.http.asks_for_keys {
        return Ok((Access::Open, Entry::Open));
    }
    let (keyring, entry) = match &settings.store {
        None => {
            let keyring = Keyring::in_memory()?;
            let token = first(&keyring)?;
            (keyring, Entry::BriefKey(token))
        }
        Some(folder) => {
            let opened = Keyring::open(folder)?;
            let entry = if opened.is_new { Entry::NewKey(first(&opened.keyring)?) } else { Entry::Key };
            (opened.keyring, entry)
        }
    };
    Ok((Access::Keys(keyring), entry))
}

/// What stands before the door, by these settings.
pub(super) fn front(http: &HttpSettings) -> Result<Front, TlsError> {
    let tls = http.tls.as_ref().map(|files| Tls::load(&files.certificate, &files.key)).transpose()?;
    Ok(Front { hosts: http.hosts.clone(), tls })
}

/// The token of the key that is made at first start.
fn first(keyring: &Keyring) -> Result<Token, AccessError> {
    keyring.keys().named(crate::access::OPERATOR).map(|key| key.token.clone())
}
