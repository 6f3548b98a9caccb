//! Who may use the doors: everybody on this machine, or everybody who has a key. The command line tells users how to
//! sign in.

use super::AppError;
use crate::access::{Access, AccessError, KeyFile, Keyring, Role, Token};
use crate::config::{Broker, HttpSettings, Settings};
use crate::doors::http::{Front, Tls, TlsError};
use hallsweep_core::hall::HallId;
use hallsweep_core::settings::SafeBy;

#[derive(Debug)]
pub enum FirstAccess {
    Open,
    /// A key from an earlier start exists.
    Key,
    /// Nobody can sign in: the existing keys cannot be read, for this reason.
    Unusable(String),
    /// An operator's key that was just created and stored.
    NewKey(Token),
    /// An operator's key that was just created and is valid until the program ends.
    BriefKey(Token),
}

pub(super) struct Opened {
    pub(super) http: Access,
    /// Access to our own MQTT broker over TCP. Web clients of the broker are admitted by `http`.
    pub(super) mqtt: Access,
    pub(super) entry: FirstAccess,
}

/// Decides who is admitted by these settings. Creates a first key when keys are required and no key exists.
pub(super) fn access(settings: &Settings) -> Result<Opened, AccessError> {
    let mqtt_asks = mqtt_asks(settings);
    if !settings.http.asks_for_keys && !mqtt_asks {
        return Ok(Opened { http: Access::Open, mqtt: Access::Open, entry: FirstAccess::Open });
    }
    let (keys, entry) = keys(settings)?;
    let access = |asks| if asks { keys.clone() } else { Access::Open };
    Ok(Opened { http: access(settings.http.asks_for_keys), mqtt: access(mqtt_asks), entry })
}

/// Checks that two judges of this hall can be told apart if a *safe* needs two: HTTP and MQTT require keys, and two
/// operators who see the hall have one. Over CoAP, which has no keys, nobody can say *safe*. Without a readable file of
/// keys nobody can judge anyway, and the start says so.
pub(super) fn check_judges(settings: &Settings, hall: &HallId, safe_by: SafeBy, opened: &Opened) -> Result<(), AppError> {
    if safe_by == SafeBy::One {
        return Ok(());
    }
    let Access::Keys(keys) = &opened.http else {
        return Err(AppError::NoKeysForJudges("HTTP", "http.require_token = true"));
    };
    if settings.mqtt.broker.is_some() && !mqtt_asks(settings) {
        return Err(AppError::NoKeysForJudges("MQTT", "mqtt.require_password = true, or use --mqtt none"));
    }
    let current = keys.keys();
    let operators = || current.iter().filter(|key| key.role == Role::Operator);
    match (operators().count(), operators().filter(|key| key.sees(hall)).count()) {
        _ if keys.is_unusable() => Ok(()),
        (all @ ..2, _) => Err(AppError::TooFewJudges(all)),
        (_, judges @ ..2) => Err(AppError::TooFewJudgesOfHall(judges, hall.clone())),
        _ => Ok(()),
    }
}

fn mqtt_asks(settings: &Settings) -> bool {
    matches!(settings.mqtt.broker, Some(Broker::Own { asks_for_keys: true, .. }))
}

/// Why the existing keys cannot be read, if keys are required. Without readable keys nobody could press STOP, so
/// nothing may move (safety R5).
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

fn first(keyring: &Keyring) -> Result<Token, AccessError> {
    keyring.keys().named(crate::access::OPERATOR).map(|key| key.token.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::{Keys, halls};
    use crate::config::{Flag, Sources, load};

    /// Safety V4: who does not see a piece cannot judge it.
    #[test]
    fn only_operators_who_see_the_hall_count_as_its_judges() {
        let flags = vec![Flag { flag: "", key: "mqtt.bind", value: "none".to_owned() }];
        let settings = load(&Sources { flags, ..Sources::default() }).unwrap();
        let [main, south] = ["main", "south"].map(|name| HallId::new(name).unwrap());
        let mut keys = Keys::first().unwrap();
        let said = |keys: &Keys, hall: &HallId, safe_by| {
            let http = Access::Keys(Keyring::of(keys.clone()).unwrap());
            let opened = Opened { http, mqtt: Access::Open, entry: FirstAccess::Key };
            check_judges(&settings, hall, safe_by, &opened).err().map(|error| error.to_string()).unwrap_or_default()
        };
        keys.add("watcher", Role::Viewer, None).unwrap();
        assert!(said(&keys, &main, SafeBy::Two).starts_with("mission.safe_by is 2, but the number of operators' keys is 1:"));
        keys.add("south-desk", Role::Operator, Some(halls(["south"]).unwrap())).unwrap();
        assert_eq!(said(&keys, &south, SafeBy::Two), "");
        let words = "mission.safe_by of the hall `main` is 2, but the number of operators' keys that see this hall is 1:";
        assert!(said(&keys, &main, SafeBy::Two).starts_with(words));
        assert_eq!(said(&keys, &main, SafeBy::One), "");
        keys.add("night-shift", Role::Operator, Some(halls(["east", "main"]).unwrap())).unwrap();
        assert_eq!(said(&keys, &main, SafeBy::Two), "");
    }
}
