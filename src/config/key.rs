//! The only table of settings. It has the name of each setting, its type, the flag that sets it, and the advice to an
//! operator. The following parts of the program are derived from the table, or a test compares them with the table:
//! parsing (`check`), environment variables, command-line flags, the defaults with their comments
//! (`config/default.toml`), and `docs/settings.md`.

use hallsweep_core::hall::HallId;
use hallsweep_core::robot::RobotId;
use hallsweep_core::settings::Rules;
use hallsweep_core::speed::Speed;
use hallsweep_core::units::Celsius;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// Section and name, such as `http.bind`.
    pub name: &'static str,
    pub kind: SettingKind,
    /// The command-line flag for this setting, such as `--http`.
    pub flag: Option<&'static str>,
    pub advice: &'static str,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SettingKind {
    /// A text. The code that reads the setting checks its format. In the environment or a flag, a text is taken
    /// literally; a value of another type is parsed there as in a settings file.
    Text,
    YesNo,
    /// A list of texts, or a single one.
    Texts,
    /// A number within these bounds, inclusive.
    Number {
        least: f64,
        most: f64,
    },
    /// A number within these bounds, or this word.
    NumberOrWord {
        least: f64,
        most: f64,
    },
    /// A whole number of 64 bits.
    Whole,
}

const RATE: SettingKind = SettingKind::Number { least: 0.0, most: 1.0 };

const MISHAPS: SettingKind = SettingKind::Number { least: 0.0, most: 10.0 };

/// A factor, or the word `max`.
const SPEED: SettingKind = SettingKind::NumberOrWord { least: Speed::SLOWEST, most: Speed::FASTEST };

/// A number of test pieces. A person judges no more than 100 in a day.
const TESTS: SettingKind = SettingKind::Number { least: 0.0, most: 100.0 };

/// A distance in metres. The bounds include a letter bomb and a lorry bomb, with a margin.
const EVACUATION_M: SettingKind = SettingKind::Number { least: 1.0, most: 5000.0 };

/// A distance in metres.
const KEEP_OUT_M: SettingKind = SettingKind::Number { least: 0.0, most: Rules::WIDEST_M };

/// A number of judges.
const SAFE_BY: SettingKind = SettingKind::Number { least: 1.0, most: 2.0 };

/// A number of photos.
const VIEWS: SettingKind = SettingKind::Number { least: 0.0, most: Rules::MOST_VIEWS as f64 };

/// Degrees Celsius, within the bounds that the core accepts.
const CELSIUS: SettingKind = SettingKind::Number { least: Celsius::LEAST, most: Celsius::MOST };

/// Degrees by which a hot hall must cool below the threshold. With a larger number the hall would stay hot even at
/// winter temperatures.
const HYSTERESIS: SettingKind = SettingKind::Number { least: 0.0, most: 50.0 };

/// Error in centimetres. A sonar with an error of more than a metre is useless.
const SONAR_NOISE_CM: SettingKind = SettingKind::Number { least: 0.0, most: 100.0 };

/// Number of cells. A sonar with a range of four metres sees seven cells of half a metre.
const SONAR_CELLS: SettingKind = SettingKind::Number { least: 1.0, most: 7.0 };

/// A number of days, at most a hundred years.
const KEEP_DAYS: SettingKind = SettingKind::Number { least: 0.0, most: 36_500.0 };

/// Speed of serial ports in bits per second.
const BAUD: SettingKind = SettingKind::Number { least: 300.0, most: 4_000_000.0 };

/// Milliseconds for one cell. More than five seconds would be too slow to count as driving.
const STEP_MS: SettingKind = SettingKind::Number { least: 50.0, most: 5000.0 };

/// A number of seconds. A sensor that reports less than once an hour does not tell the present temperature.
const SENSOR_SILENCE_S: SettingKind = SettingKind::Number { least: 1.0, most: 3600.0 };

const COAP_BIND: &str = "write localhost:PORT, or ADDRESS:PORT with a number for an address, such as 127.0.0.1:5683 or \
                         [::1]:5683, or none to turn CoAP off";

const MQTT_BIND: &str = "write localhost:PORT, or ADDRESS:PORT with a number for an address, such as 127.0.0.1:1883 or \
                         [::1]:1883, or none to turn this broker off";

const ROBOT_ADDRESS: &str =
    "write HOST:PORT, or, for a robot of the kind line, the path of a serial device, such as /dev/ttyUSB0 or COM3";

/// The section with a subsection for each further robot, such as `[robots.porter]`.
pub(super) const ROBOTS: &str = "robots";

/// The section of the searching robot. `[robots.NAME]` has the same keys.
pub(super) const ROBOT: &str = "robot";

/// The section that names the default hall, and has a subsection for each further hall, such as `[halls.south]`.
pub(super) const HALLS: &str = "halls";

/// The sections that `[halls.NAME]` can have, because they may differ between the halls.
const OF_A_HALL: [&str; 7] = ["hall", "console", ROBOT, ROBOTS, "pair", "mission", "temperature"];

/// The setting of `[halls.NAME]` that the top level does not have.
pub(super) const GROUP: &str = "group";

static GROUP_KEY: Key =
    text("halls.NAME.group", "write 1 to 32 small letters, digits and hyphens, the first a letter, such as terminal-1");

/// Every setting, in the order of `config/default.toml`.
pub const KEYS: [Key; 58] = [
    text("hall.file", "name a built-in hall, such as airport, or the path of a hall file (.toml, .map, .yaml or .txt)")
        .set_by("--hall"),
    text("hall.start", "write column and row, counted from 0 in the north-west corner, such as 3,0; or leave it empty")
        .set_by("--start"),
    key("hall.exercise", TESTS, "write a whole number of test pieces from 0 to 100; 0 means no exercise").set_by("--exercise"),
    text("http.bind", "write localhost:PORT, or ADDRESS:PORT with a number for an address, such as 127.0.0.1:8080 or [::1]:8080")
        .set_by("--http"),
    yes_no("http.require_token"),
    key("http.hosts", SettingKind::Texts, "write names without a port in a list, such as [\"hall.example\"]"),
    text("http.tls_certificate", "name a PEM file with the certificate, and http.tls_key too; or leave both empty"),
    text(
        "http.tls_key",
        "name the PEM file with the certificate's private key, and http.tls_certificate too; or leave both empty",
    ),
    key("console.evacuation_m", EVACUATION_M, "write a number of metres from 1 to 5000, such as 100"),
    text("coap.bind", COAP_BIND).set_by("--coap"),
    yes_no("coap.open_to_others"),
    text("mqtt.bind", MQTT_BIND).set_by("--mqtt"),
    yes_no("mqtt.require_password"),
    text("mqtt.router", "write own or rumqttd"),
    text(
        "mqtt.broker",
        "write mqtt://HOST:PORT or mqtts://HOST:PORT, and the login of this broker in mqtt.name and mqtt.password; or leave it \
         empty",
    ),
    text("mqtt.version", "write 3.1.1 or 5 (in a file between quotes), for the broker of mqtt.broker"),
    text("mqtt.name", "write the user name for the broker of mqtt.broker, or leave it empty"),
    text("mqtt.password", "write the password for mqtt.name, or leave it empty"),
    text(
        "mqtt.certificates",
        "name a PEM file of trusted certificates, only for mqtts://; or leave it empty to trust the system's certificates",
    ),
    text("mqtt.prefix", "write 1 to 64 letters, digits, - or _, with single slashes between them if needed, such as hallsweep"),
    text("mqtt.id", "write 1 to 64 letters, digits, - or _, such as discovery"),
    text(
        "mqtt.old_prefix",
        "write 1 to 64 letters, digits, - or _, with single slashes between them if needed, such as unibo/qak",
    ),
    yes_no("mqtt.home_assistant"),
    yes_no("old_clients.manual_driving"),
    text("store.folder", "name a folder; or leave it empty for the default folder, or write none to store nothing")
        .set_by("--data"),
    key("store.keep_days", KEEP_DAYS, "write a whole number of days from 0 to 36500; 0 means for ever"),
    text("robot.kind", "write one of: sim, virtual-tcp, virtual-ws, line").set_by("--robot"),
    text("robot.address", ROBOT_ADDRESS).set_by("--robot"),
    key("robot.baud", BAUD, "write a whole number of bits per second from 300 to 4000000"),
    key("robot.step_ms", STEP_MS, "write a whole number of milliseconds from 50 to 5000"),
    text("robot.scene", "name the scene file of the virtual robot's page; or leave it empty"),
    key("robot.speed", SPEED, "write a factor from 0.1 to 1000 (1 is normal speed), or max for no waiting").set_by("--speed"),
    key("robot.seed", SettingKind::Whole, "write a whole number from 0 to 18446744073709551615").set_by("--seed"),
    key("robot.unknown_rate", RATE, "write a rate from 0 (never) to 1 (always)"),
    yes_no("robot.camera_misses"),
    key("robot.photo_failure_rate", RATE, "write a rate from 0 (never) to 1 (always)"),
    key("robot.sonar_noise_cm", SONAR_NOISE_CM, "write a number of centimetres from 0 to 100"),
    key("robot.sonar_cells", SONAR_CELLS, "write a whole number of cells from 1 to 7"),
    key("pair.slips", MISHAPS, "write a whole number from 0 to 10"),
    key("pair.unrecognised", MISHAPS, "write a whole number from 0 to 10"),
    text("mission.strategy", "write one of: auto, scored, frontier, columns, spiral, snail").set_by("--strategy"),
    text("mission.goal", "write one of: find, cover").set_by("--goal"),
    text("mission.sensing", "write one of: bump, sonar").set_by("--sensing"),
    text("mission.costs", "write robot, or what a step, a turn and a bump cost, such as 1,1,1").set_by("--costs"),
    text("mission.retrieval", "write one of: pair, discovery, none"),
    text("mission.after_danger", "write return or go_on"),
    key("mission.keep_out_m", KEEP_OUT_M, "write a number of metres from 0 to 50, such as 2; 0 means no ring"),
    key("mission.safe_by", SAFE_BY, "write the number of judges that a verdict of safe needs, from 1 to 2"),
    text("mission.hot", "write optional or required"),
    key("mission.unsure_views", VIEWS, "write the most further photos when a judge is unsure, from 0 to 2"),
    yes_no("mission.inspect_everything"),
    yes_no("mission.wall_lines"),
    key("temperature.threshold_celsius", CELSIUS, "write degrees Celsius from -60 to 1000, such as 25.0"),
    key("temperature.hysteresis_celsius", HYSTERESIS, "write a number of degrees from 0 to 50, such as 1.0"),
    text(
        "temperature.sensor",
        "write at most 60 names separated by commas, each of 1 to 64 visible characters and not operator, robot or others, such \
         as roof,gate-3; or leave it empty",
    ),
    key("temperature.sensor_silence_s", SENSOR_SILENCE_S, "write a number of seconds from 1 to 3600, such as 10"),
    text(
        "log.filter",
        "write a level (error, warn, info, debug, trace) or targets with levels, such as info,hallsweep::doors=debug",
    ),
    text(
        "halls.default",
        "name the hall of the settings outside of [halls.NAME]: 1 to 32 small letters, digits and hyphens, the first a letter, and \
         not default, such as north; only with a single hall it may be empty",
    ),
];

impl Key {
    const fn set_by(self, flag: &'static str) -> Key {
        Key { flag: Some(flag), ..self }
    }

    /// The setting of this name. A setting of a further robot is described by the setting of `[robot]`:
    /// `robots.porter.seed` by `robot.seed`, for example. A setting of a hall is described by the setting of the top
    /// level: `halls.south.hall.file` by `hall.file`.
    pub fn named(name: &str) -> Option<&'static Key> {
        if let Some((_, own)) = of_a_hall(name) {
            return if own == GROUP { Some(&GROUP_KEY) } else { may_differ(own).then(|| Key::named(own)).flatten() };
        }
        let of_a_robot = || {
            let (robot, own) = name.strip_prefix(ROBOTS)?.strip_prefix('.')?.split_once('.')?;
            RobotId::new(robot).map(|_| format!("{ROBOT}.{own}"))
        };
        let meant = of_a_robot();
        KEYS.iter().find(|key| key.name == meant.as_deref().unwrap_or(name))
    }

    pub fn of_flag(flag: &str) -> Option<&'static Key> {
        KEYS.iter().find(|key| key.flag == Some(flag))
    }

    pub fn is_beyond(&self, number: f64) -> bool {
        match self.kind {
            SettingKind::Number { least, most } | SettingKind::NumberOrWord { least, most } => !(least..=most).contains(&number),
            SettingKind::Text | SettingKind::YesNo | SettingKind::Texts | SettingKind::Whole => false,
        }
    }

    /// Every section once. The section for further robots is last.
    pub fn sections() -> Vec<&'static str> {
        let mut sections: Vec<&str> = KEYS.iter().filter_map(|key| key.name.split('.').next()).collect();
        sections.dedup();
        sections.push(ROBOTS);
        sections
    }

    /// Whether the names of settings can begin with `name` and a dot.
    pub(super) fn is_section(name: &str) -> bool {
        match (of_a_hall(name), name.split_once('.')) {
            (Some((_, own)), _) => own.is_empty() || may_differ(own) && Key::is_section(own),
            (None, Some((section, robot))) => section == ROBOTS && RobotId::new(robot).is_some(),
            (None, None) => Key::sections().contains(&name),
        }
    }

    /// Whether `name` is in `[halls.NAME]`, but in a section of the whole program: `halls.south.http.bind`, for example.
    pub(super) fn is_misplaced(name: &str) -> bool {
        of_a_hall(name)
            .is_some_and(|(_, own)| section(own) != HALLS && !may_differ(own) && Key::sections().contains(&section(own)))
    }

    pub fn advice_for_unknown(name: &str) -> String {
        let section = section(name);
        if section == HALLS {
            return match of_a_hall(name) {
                Some((hall, own)) if may_differ(own) => format!("in [{HALLS}.{hall}], {}", Key::advice_for_unknown(own)),
                Some((hall, own)) if Key::is_misplaced(name) => {
                    let section = self::section(own);
                    format!("[{section}] is for the whole program and not for a hall: set it outside of [{HALLS}.{hall}]")
                }
                Some(_) | None => format!(
                    "[{HALLS}] has the setting halls.default; [{HALLS}.NAME] has the setting {GROUP} and the sections {}, and NAME \
                     has 1 to {} small letters, digits and hyphens, the first a letter, and is not default",
                    OF_A_HALL.join(", "),
                    HallId::MOST
                ),
            };
        }
        if section == ROBOTS {
            let own: Vec<&str> = KEYS.iter().filter_map(|key| key.name.strip_prefix(ROBOT)?.strip_prefix('.')).collect();
            return format!(
                "[{ROBOTS}.NAME] has the settings {}, and NAME has 1 to {} small letters, digits and hyphens, the first a letter",
                own.join(", "),
                RobotId::MOST
            );
        }
        let siblings: Vec<&str> = KEYS.iter().map(|key| key.name).filter(|key| key.split('.').next() == Some(section)).collect();
        if siblings.is_empty() {
            format!("the sections are {}", Key::sections().join(", "))
        } else {
            format!("[{section}] has the settings {}", siblings.join(", "))
        }
    }
}

/// The name of a hall; `None` if no hall can have this name. `halls.default` is a setting, so it cannot be a hall.
pub(super) fn hall_name(text: &str) -> Option<HallId> {
    HallId::new(text).filter(|hall| hall.name() != "default")
}

/// Splits the name of a setting in `[halls.NAME]` into the hall and the name of the setting within this section.
pub(super) fn of_a_hall(name: &str) -> Option<(HallId, &str)> {
    let within = name.strip_prefix(HALLS)?.strip_prefix('.')?;
    let (hall, own) = within.split_once('.').unwrap_or((within, ""));
    Some((hall_name(hall)?, own))
}

fn may_differ(own: &str) -> bool {
    OF_A_HALL.contains(&section(own))
}

fn section(name: &str) -> &str {
    name.split('.').next().unwrap_or_default()
}

const fn key(name: &'static str, kind: SettingKind, advice: &'static str) -> Key {
    Key { name, kind, flag: None, advice }
}

const fn text(name: &'static str, advice: &'static str) -> Key {
    key(name, SettingKind::Text, advice)
}

const fn yes_no(name: &'static str) -> Key {
    key(name, SettingKind::YesNo, "write true or false")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::RobotKind;
    use hallsweep_core::command::Strategy;
    use hallsweep_core::search::{Objective, Sensing};

    #[test]
    fn the_advice_lists_every_strategy() {
        let names: Vec<&str> = Strategy::ALL.iter().map(|strategy| strategy.name()).collect();
        let advice = Key::named("mission.strategy").expect("it is a setting").advice;
        assert_eq!(advice, format!("write one of: {}", names.join(", ")));
    }

    #[test]
    fn the_advice_lists_every_goal_and_every_sensing() {
        let check = |key: &str, names: &str| {
            assert_eq!(Key::named(key).expect("it is a setting").advice, format!("write one of: {names}"));
        };
        check("mission.goal", &Objective::ALL.map(Objective::name).join(", "));
        check("mission.sensing", &Sensing::ALL.map(Sensing::name).join(", "));
    }

    #[test]
    fn the_advice_lists_every_kind_of_robot() {
        let names = RobotKind::ALL.map(RobotKind::name).join(", ");
        assert_eq!(Key::named("robot.kind").expect("it is a setting").advice, format!("write one of: {names}"));
    }

    #[test]
    fn a_robot_with_a_section_of_its_own_has_the_settings_of_the_one_that_searches() {
        assert_eq!(Key::named("robots.porter-2.seed"), Key::named("robot.seed"));
        for unknown in
            ["robots", "robots.porter", "robots.porter.sed", "robots.Porter.seed", "robots.a.b.seed", "robots.http.bind"]
        {
            assert_eq!(Key::named(unknown), None, "{unknown}");
        }
        let advice = Key::advice_for_unknown("robots.porter.sed");
        assert!(
            advice.starts_with("[robots.NAME] has the settings kind, address, baud, step_ms, scene, speed, seed, "),
            "{advice}"
        );
    }

    #[test]
    fn an_unknown_name_is_answered_with_those_that_are_near() {
        assert_eq!(
            Key::advice_for_unknown("mission.order"),
            "[mission] has the settings mission.strategy, mission.goal, mission.sensing, mission.costs, mission.retrieval, mission.after_danger, mission.keep_out_m, mission.safe_by, mission.hot, mission.unsure_views, mission.inspect_everything, mission.wall_lines"
        );
        assert!(
            Key::advice_for_unknown("htpp.bind")
                .starts_with("the sections are hall, http, console, coap, mqtt, old_clients, store, robot")
        );
    }

    #[test]
    fn the_advice_says_the_bounds() {
        for key in &KEYS {
            if let SettingKind::Number { least, most } | SettingKind::NumberOrWord { least, most } = key.kind {
                let advice = key.advice;
                assert!(advice.contains(&format!("from {least}")) && advice.contains(&format!("to {most}")), "{advice}");
            }
        }
    }

    #[test]
    fn the_page_on_settings_names_every_flag_and_no_setting_that_there_is_not() {
        let page = include_str!("../../docs/settings.md");
        for flag in KEYS.iter().filter_map(|key| key.flag) {
            assert!(page.contains(&format!("`{flag}`")) || page.contains(&format!("`{flag} ")), "{flag}");
        }
        let named = page.split('`').skip(1).step_by(2).filter_map(|code| code.split(' ').next());
        let settings = named.filter(|name| name.split_once('.').is_some_and(|(section, _)| Key::sections().contains(&section)));
        for name in settings {
            assert!(Key::named(name).is_some(), "{name}");
        }
    }
}
