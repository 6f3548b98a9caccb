//! The one list of settings: their names and what an operator is told to write. `config/default.toml` holds the defaults.

/// One setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    /// Its section and name, as `http.bind`.
    pub name: &'static str,
    /// Whether a value from the environment or a flag is taken letter by letter; otherwise `true` and `1` mean what they say.
    pub text: bool,
    /// What to write.
    pub advice: &'static str,
}

/// What to write for the address of the CoAP door.
const COAP_BIND: &str = "write localhost:PORT, or ADDRESS:PORT with a number for an address, as 127.0.0.1:5683 or [::1]:5683, or none for no such door";

/// What to write for the address of the MQTT door.
const MQTT_BIND: &str = "write localhost:PORT, or ADDRESS:PORT with a number for an address, as 127.0.0.1:1883 or [::1]:1883, or none for no such door";

/// Every setting, in the order of `config/default.toml`.
pub const KEYS: [Key; 33] = [
    text("hall.file", "name a built-in hall, as airport, or the path of a .toml or .map file"),
    text("http.bind", "write localhost:PORT, or ADDRESS:PORT with a number for an address, as 127.0.0.1:8080 or [::1]:8080"),
    value("http.require_token", "write true or false"),
    value("http.hosts", "write names without a port in a list, as [\"hall.example\"]"),
    text("http.tls_certificate", "name a PEM file with the certificate, and http.tls_key too; or leave both empty"),
    text(
        "http.tls_key",
        "name the PEM file with the certificate's private key, and http.tls_certificate too; or leave both empty",
    ),
    text("coap.bind", COAP_BIND),
    value("coap.open_to_others", "write true or false"),
    text("mqtt.bind", MQTT_BIND),
    value("mqtt.require_password", "write true or false"),
    text(
        "mqtt.broker",
        "write mqtt://HOST:PORT or mqtts://HOST:PORT, and what it knows us by in mqtt.name and mqtt.password; or nothing",
    ),
    text("mqtt.name", "write the name by which the broker of mqtt.broker knows hallsweep, or nothing"),
    text("mqtt.password", "write the password that goes with mqtt.name, or nothing"),
    text(
        "mqtt.certificates",
        "name a PEM file of the certificates that are believed, for mqtts:// alone; or leave it empty for the system's",
    ),
    text("mqtt.prefix", "write 1 to 64 letters, digits, - or _, with single slashes between if need be, as hallsweep"),
    text("mqtt.id", "write 1 to 64 letters, digits, - or _, as discovery"),
    text("mqtt.old_prefix", "write 1 to 64 letters, digits, - or _, with single slashes between if need be, as unibo/qak"),
    value("mqtt.home_assistant", "write true or false"),
    value("old_clients.manual_driving", "write true or false"),
    text("store.folder", "name a folder; or leave it empty for the usual one, or write none so that nothing is kept"),
    value("robot.speed", "write a factor from 0.1 to 1000 (1 = as a person would watch it), or max for no waiting"),
    value("robot.seed", "write a whole number from 0 to 18446744073709551615"),
    value("robot.unknown_rate", "write a rate from 0 (never) to 1 (always)"),
    value("robot.photo_failure_rate", "write a rate from 0 (never) to 1 (always)"),
    value("robot.sonar_noise_cm", "write a number of centimetres from 0 to 100"),
    text("mission.strategy", "write one of: snail"),
    value("mission.inspect_everything", "write true or false"),
    value("mission.wall_lines", "write true or false"),
    value("temperature.threshold_celsius", "write degrees Celsius from -60 to 1000, as 25.0"),
    value("temperature.hysteresis_celsius", "write a number of degrees from 0 to 50, as 1.0"),
    text(
        "temperature.sensor",
        "write at most 60 names set apart by commas, each of 1 to 64 visible characters and not operator, robot or others, as roof,gate-3; or nothing",
    ),
    value("temperature.sensor_silence_s", "write a number of seconds from 1 to 3600, as 10"),
    text("log.filter", "write a level (error, warn, info, debug, trace) or targets with levels, as info,hallsweep::doors=debug"),
];

impl Key {
    /// The setting of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<&'static Key> {
        KEYS.iter().find(|key| key.name == name)
    }

    /// The sections, each once.
    #[must_use]
    pub fn sections() -> Vec<&'static str> {
        let mut sections: Vec<&str> = KEYS.iter().filter_map(|key| key.name.split('.').next()).collect();
        sections.dedup();
        sections
    }

    /// What to do about a name that is no setting: the names that there are in its section, or the sections.
    #[must_use]
    pub fn advice_for_unknown(name: &str) -> String {
        let section = name.split('.').next().unwrap_or_default();
        let siblings: Vec<&str> = KEYS.iter().map(|key| key.name).filter(|key| key.split('.').next() == Some(section)).collect();
        if siblings.is_empty() {
            format!("the sections are {}", Key::sections().join(", "))
        } else {
            format!("in [{section}] there are {}", siblings.join(", "))
        }
    }
}

const fn text(name: &'static str, advice: &'static str) -> Key {
    Key { name, text: true, advice }
}

const fn value(name: &'static str, advice: &'static str) -> Key {
    Key { name, text: false, advice }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::explore::Strategy;

    #[test]
    fn the_advice_lists_every_strategy() {
        let names: Vec<&str> = Strategy::ALL.iter().map(|strategy| strategy.name()).collect();
        let advice = Key::named("mission.strategy").expect("it is a setting").advice;
        assert_eq!(advice, format!("write one of: {}", names.join(", ")));
    }

    #[test]
    fn an_unknown_name_is_answered_with_those_that_are_near() {
        assert_eq!(
            Key::advice_for_unknown("mission.order"),
            "in [mission] there are mission.strategy, mission.inspect_everything, mission.wall_lines"
        );
        assert!(
            Key::advice_for_unknown("htpp.bind")
                .starts_with("the sections are hall, http, coap, mqtt, old_clients, store, robot")
        );
    }
}
