//! `hallsweep serve`: starts the program, and prints its addresses and how to sign in.

use super::{Failure, Serve, link};
use crate::app::{self, BoundPort, Doors, FirstAccess};
use crate::config::{Broker, HttpSettings, Settings, from_here};
use crate::telemetry;

pub fn run(flags: &Serve) -> Result<(), Failure> {
    telemetry::queue_lines();
    let settings = super::settings(&flags.sources())?;
    if let Some(archive) = settings.store.as_ref().filter(|store| store.is_file()) {
        let words = "is a file, and `serve` needs a folder: make a data folder from an archive with `hallsweep journal unpack`";
        return Err(Failure::Usage(format!("{} {words}", archive.display())));
    }
    if let Some(idle) = without_effect(&settings) {
        telemetry::warn_of_idle(&idle);
    }
    app::serve(&settings, |doors, entry| super::announce(announcement(&settings, doors, entry)))?;
    Ok(())
}

fn announcement(settings: &Settings, doors: Doors, entry: &FirstAccess) -> String {
    let coap = doors.coap.map(|coap| format!("\nThe CoAP resources are at coap://{}", found(coap, "--coap")));
    let mqtt = mqtt(settings, doors, entry).map(|mqtt| format!("\nThe MQTT topics are at {mqtt}"));
    let console_entry = if settings.http.asks_for_keys { entry } else { &FirstAccess::Open };
    let idle = without_effect(settings).map(|idle| format!("\nThese settings have no effect on the configured robots: {idle}"));
    [Some(console(&settings.http, doors.http, console_entry)), coap, mqtt, idle].into_iter().flatten().collect()
}

fn without_effect(settings: &Settings) -> Option<String> {
    Some(settings.without_effect().join(", ")).filter(|idle| !idle.is_empty())
}

fn mqtt(settings: &Settings, doors: Doors, entry: &FirstAccess) -> Option<String> {
    let asks = match settings.mqtt.broker.as_ref()? {
        Broker::Own { asks_for_keys, .. } => *asks_for_keys,
        Broker::Other(other) => return Some(other.to_string()),
    };
    let place = doors.mqtt?;
    let other = place.instead_of.map(|port| {
        format!(
            "\nTo use the broker at port {port} instead, set HALLSWEEP__MQTT__BROKER=mqtt://localhost:{port} (see docs/mqtt.md)"
        )
    });
    let at = format!("mqtt://{}{}", found(place, "--mqtt"), other.unwrap_or_default());
    Some(match entry {
        FirstAccess::NewKey(token) | FirstAccess::BriefKey(token) if asks && !settings.http.asks_for_keys => {
            format!("{at}\nFor MQTT the user name is operator, and the password is {}", token.reveal())
        }
        FirstAccess::Key | FirstAccess::NewKey(_) | FirstAccess::BriefKey(_) if asks => {
            format!(
                "{at}\nFor MQTT the user name is the name of a key, and the password is its token: `hallsweep token` shows both."
            )
        }
        FirstAccess::Open | FirstAccess::Key | FirstAccess::NewKey(_) | FirstAccess::BriefKey(_) | FirstAccess::Unusable(_) => at,
    })
}

/// The address of a door on this machine, as text. The text also says whether the door can be reached at other
/// addresses. If the default port was in use, it says how to choose the port.
fn found(place: BoundPort, flag: &str) -> String {
    let here = from_here(place.at);
    match place.instead_of {
        Some(port) => format!("{here} (another program uses port {port}; choose a port with {flag} localhost:PORT)"),
        None if here != place.at => format!("{here} (and at the other addresses of this machine)"),
        None => here.to_string(),
    }
}

/// The address of the console, and how to sign in. A token is shown only when it was just made, and it is never
/// written to the log.
fn console(http: &HttpSettings, place: BoundPort, entry: &FirstAccess) -> String {
    let at = format!("hallsweep is at {}://{}", link::scheme(http), found(place, "--http"));
    match entry {
        FirstAccess::Open => at,
        FirstAccess::Unusable(why) => format!("{at}\nhallsweep requires a key, and nobody can sign in: {why}"),
        FirstAccess::Key => format!("{at}\nhallsweep requires a key: `hallsweep token` shows links for signing in."),
        FirstAccess::NewKey(token) => {
            format!("{at}\nhallsweep made its first key. Sign in as operator: {}", link::sign_in(http, place.at, token))
        }
        FirstAccess::BriefKey(token) => format!(
            "{at}\nNothing is stored (store.folder = \"none\"), so this key is valid until hallsweep ends. Sign in as operator: \
             {}",
            link::sign_in(http, place.at, token)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::access::Token;
    use crate::config::{Flag, Sources, load};

    fn at(address: &str) -> BoundPort {
        BoundPort { at: address.parse().unwrap(), instead_of: None }
    }

    fn set(settings: &[(&'static str, &str)]) -> Settings {
        let flags = settings.iter().map(|(key, value)| Flag { flag: "", key, value: (*value).to_owned() }).collect();
        load(&Sources { flags, ..Sources::default() }).unwrap()
    }

    #[test]
    fn a_token_is_shown_only_when_it_was_just_made() {
        let settings = set(&[("http.bind", "0.0.0.0:8080")]);
        let doors = Doors { http: at("0.0.0.0:8080"), coap: None, mqtt: None };
        let token = Token::draw().unwrap();
        let said = |entry: &FirstAccess| announcement(&settings, doors, entry);
        assert_eq!(
            said(&FirstAccess::Open),
            "hallsweep is at http://127.0.0.1:8080 (and at the other addresses of this machine)"
        );
        assert!(said(&FirstAccess::Key).contains("`hallsweep token`"));
        for entry in [FirstAccess::NewKey(token.clone()), FirstAccess::BriefKey(token.clone())] {
            let link = format!("http://127.0.0.1:8080/sign-in?token={}", token.reveal());
            assert!(said(&entry).ends_with(&link), "{}", said(&entry));
        }
    }

    #[test]
    fn where_a_password_is_asked_for_over_mqtt_alone_it_is_told_which() {
        let settings = set(&[("mqtt.require_password", "true")]);
        let doors = Doors { http: at("127.0.0.1:8080"), coap: None, mqtt: Some(at("127.0.0.1:1883")) };
        let token = Token::draw().unwrap();
        let new = announcement(&settings, doors, &FirstAccess::NewKey(token.clone()));
        assert!(new.starts_with("hallsweep is at http://127.0.0.1:8080\n") && !new.contains("sign-in"), "{new}");
        assert!(new.ends_with(&format!("the user name is operator, and the password is {}", token.reveal())), "{new}");
        let later = announcement(&settings, doors, &FirstAccess::Key);
        assert!(
            later.ends_with("the user name is the name of a key, and the password is its token: `hallsweep token` shows both.")
        );
    }

    #[test]
    fn the_last_lines_say_where_the_other_doors_are() {
        let settings = load(&Sources::default()).unwrap();
        let (coap, mqtt) = (Some(at("127.0.0.1:40123")), Some(at("127.0.0.1:40124")));
        let doors = Doors { http: at("127.0.0.1:8080"), coap, mqtt };
        let expect = "hallsweep is at http://127.0.0.1:8080\nThe CoAP resources are at coap://127.0.0.1:40123\n\
                      The MQTT topics are at mqtt://127.0.0.1:40124";
        assert_eq!(announcement(&settings, doors, &FirstAccess::Open), expect);
    }

    #[test]
    fn somebody_elses_broker_is_named_without_its_password() {
        let set = |key: &str, value: &str| (format!("HALLSWEEP__MQTT__{key}"), value.to_owned());
        let environment = vec![set("BROKER", "mqtts://[::1]"), set("NAME", "me"), set("PASSWORD", "secret")];
        let settings = load(&Sources { environment, ..Sources::default() }).unwrap();
        let doors = Doors { http: at("127.0.0.1:8080"), coap: None, mqtt: None };
        assert!(announcement(&settings, doors, &FirstAccess::Open).ends_with("The MQTT topics are at mqtts://[::1]:8883"));
    }

    #[test]
    fn what_was_set_for_nothing_is_said_in_the_last_line() {
        let speed = Flag::given("--speed", "max".to_owned());
        let flags = Flag::robot("virtual-tcp").into_iter().chain([speed]).collect();
        let settings = load(&Sources { flags, ..Sources::default() }).unwrap();
        let doors = Doors { http: at("127.0.0.1:8080"), coap: None, mqtt: None };
        let said = announcement(&settings, doors, &FirstAccess::Open);
        assert!(said.ends_with("\nThese settings have no effect on the configured robots: flag --speed"), "{said}");
    }

    #[test]
    fn a_door_that_gave_way_says_so_and_how_the_broker_that_is_there_is_used() {
        let settings = load(&Sources::default()).unwrap();
        let instead = |address: &str, port| BoundPort { instead_of: Some(port), ..at(address) };
        let doors = Doors {
            http: instead("127.0.0.1:40001", 8080),
            coap: Some(instead("127.0.0.1:40002", 5683)),
            mqtt: Some(instead("127.0.0.1:40003", 1883)),
        };
        assert_eq!(
            announcement(&settings, doors, &FirstAccess::Open),
            "hallsweep is at http://127.0.0.1:40001 (another program uses port 8080; choose a port with --http localhost:PORT)\n\
             The CoAP resources are at coap://127.0.0.1:40002 (another program uses port 5683; choose a port with --coap \
             localhost:PORT)\n\
             The MQTT topics are at mqtt://127.0.0.1:40003 (another program uses port 1883; choose a port with --mqtt \
             localhost:PORT)\n\
             To use the broker at port 1883 instead, set HALLSWEEP__MQTT__BROKER=mqtt://localhost:1883 (see docs/mqtt.md)"
        );
    }
}
