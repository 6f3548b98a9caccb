//! Tests of good and bad settings in all layers. They are in a separate file because there are many.

use std::path::PathBuf;

use super::*;
use crate::config::{BindAddress, Broker, Flag, KEYS, MqttRouter, Sources, load};
use hallsweep_core::speed::Speed;

fn environment(name: &str, value: &str) -> Sources {
    Sources { environment: vec![(name.to_owned(), value.to_owned())], ..Sources::default() }
}

fn flag(flag: &'static str, key: &'static str, value: &str) -> Sources {
    Sources { flags: vec![Flag { flag, key, value: value.to_owned() }], ..Sources::default() }
}

fn message(sources: &Sources) -> String {
    load(sources).expect_err("this setting is wrong").to_string()
}

struct File(PathBuf);

impl File {
    fn new(name: &str, text: &str) -> File {
        let path = std::env::temp_dir().join(format!("hallsweep-{}-{name}.toml", std::process::id()));
        std::fs::write(&path, text).expect("the temporary directory can be written");
        File(path)
    }

    fn sources(&self) -> Sources {
        Sources { file: Some(self.0.clone()), ..Sources::default() }
    }
}

impl Drop for File {
    fn drop(&mut self) {
        // It does no harm if the file stays.
        let _ = std::fs::remove_file(&self.0);
    }
}

#[test]
fn the_defaults_are_complete_and_are_what_the_core_would_choose() {
    let settings = load(&Sources::default()).expect("the defaults are good");
    assert_eq!(settings.hall.core, CoreSettings::default());
    assert_eq!(settings.hall.strategy, Strategy::default());
    assert_eq!(settings.http.bind, Bind { at: BindAddress::Localhost(8080), is_chosen: false });
    assert_eq!(settings.hall.robot.speed, Speed::Times(1.0));
}

#[test]
fn the_list_of_settings_and_the_default_file_name_the_same_keys_in_the_same_order() {
    let mut section = String::new();
    let mut names = Vec::new();
    for line in crate::config::DEFAULTS.lines().filter(|line| !line.starts_with('#')) {
        if let Some(name) = line.strip_prefix('[') {
            name.trim_end_matches(']').clone_into(&mut section);
        } else if let Some((key, _)) = line.split_once(" = ") {
            names.push(format!("{section}.{key}"));
        }
    }
    assert_eq!(names, KEYS.map(|key| key.name.to_owned()));
}

#[test]
fn every_default_has_a_comment_above_it() {
    let lines: Vec<&str> = crate::config::DEFAULTS.lines().collect();
    for pair in lines.windows(2).filter(|pair| pair[1].contains(" = ") && !pair[1].starts_with('#')) {
        assert!(pair[0].starts_with('#'), "`{}` has no comment", pair[1]);
    }
}

#[test]
fn a_flag_wins_over_the_environment_and_that_over_a_file() {
    let file = File::new("order", "[robot]\nseed = 2\nspeed = 3\n[mission]\nwall_lines = false\n");
    let mut sources = file.sources();
    sources.environment = vec![("HALLSWEEP__ROBOT__SEED".into(), "4".into()), ("HALLSWEEP__ROBOT__SPEED".into(), "max".into())];
    sources.flags = vec![Flag { flag: "--seed", key: "robot.seed", value: "5".into() }];
    let settings = load(&sources).expect("all of these are good");
    assert_eq!((settings.hall.robot.seed, settings.hall.robot.speed), (5, Speed::Max));
    assert!(!settings.hall.core.wall_lines, "what only the file says stands");
}

#[test]
fn the_pair_fetches_beside_the_simulated_robot_alone() {
    let fetcher = |robot: &str, retrieval: Option<&str>| {
        let retrieval = retrieval.map(|value| ("HALLSWEEP__MISSION__RETRIEVAL".to_owned(), value.to_owned()));
        let sources = Sources { flags: Flag::robot(robot).into(), environment: retrieval.into_iter().collect(), file: None };
        load(&sources).map(|settings| settings.hall.core.fetcher).map_err(|error| error.to_string())
    };
    assert_eq!(fetcher("sim", None), Ok(Fetcher::Pair));
    for robot in ["virtual-tcp", "virtual-ws", "line=COM3"] {
        assert_eq!(fetcher(robot, None), Ok(Fetcher::None), "{robot}");
        assert_eq!(fetcher(robot, Some("discovery")), Ok(Fetcher::Discovery), "{robot}");
        let said = fetcher(robot, Some("pair")).expect_err(robot);
        let begins = "setting mission.retrieval = \"pair\" (from environment variable HALLSWEEP__MISSION__RETRIEVAL): the pair is simulated";
        assert!(said.starts_with(begins) && said.contains("; write none, or discovery"), "{said}");
    }
}

#[test]
fn sensors_are_named_in_one_line_each_once() {
    let named = |names: &str| load(&environment("HALLSWEEP__TEMPERATURE__SENSOR", names)).map(|settings| settings.hall.sensors);
    assert!(named("").expect("none is the default").is_empty());
    assert_eq!(named("roof, gate-3").expect("two names"), ["roof".into(), "gate-3".into()]);
    let many: Vec<String> = (0..61).map(|number| format!("s{number}")).collect();
    for (names, problem) in [
        ("roof,", "\"\" is not a sensor name"),
        ("roof,operator", "\"operator\" is not a sensor name"),
        ("the roof", "\"the roof\" is not a sensor name"),
        ("roof,gate,roof", "\"roof\" is named twice"),
        (&many.join(","), "there are 61 names"),
    ] {
        let said = message(&environment("HALLSWEEP__TEMPERATURE__SENSOR", names));
        assert!(said.contains(problem) && said.contains("such as roof,gate-3"), "{said}");
    }
}

#[test]
fn the_silence_of_a_sensor_is_borne_from_a_second_to_an_hour() {
    let silence =
        |seconds: &str| load(&environment("HALLSWEEP__TEMPERATURE__SENSOR_SILENCE_S", seconds)).map(|s| s.hall.sensor_silence);
    assert_eq!(silence("1").ok(), Some(std::time::Duration::from_secs(1)));
    assert_eq!(silence("3600").ok(), Some(std::time::Duration::from_secs(3600)));
    for wrong in ["0", "0.9", "3601", "nan", "inf", "long"] {
        assert!(message(&environment("HALLSWEEP__TEMPERATURE__SENSOR_SILENCE_S", wrong)).contains("from 1 to 3600"), "{wrong}");
    }
}

#[test]
fn other_environment_variables_are_none_of_our_business() {
    assert!(load(&environment("HALLSWEEP_REQUIRE_CLIENTS", "1")).is_ok());
    assert!(load(&environment("PATH", "/bin")).is_ok());
    assert!(load(&environment("HALLSWEEP_SERVICE_HOST", "10.0.0.1")).is_ok(), "a cluster sets it");
}

#[test]
fn a_variable_with_too_few_underscores_is_refused_with_its_right_name() {
    assert_eq!(
        message(&environment("HALLSWEEP_ROBOT_SPEED", "max")),
        "there is no setting `HALLSWEEP_ROBOT_SPEED` (from environment variable HALLSWEEP_ROBOT_SPEED): the variable for \
         robot.speed is HALLSWEEP__ROBOT__SPEED, with two underscores before each part"
    );
}

#[test]
fn the_range_said_for_the_seed_is_the_one_that_is_accepted() {
    let most = u64::MAX.to_string();
    assert!(crate::config::Key::named("robot.seed").expect("a setting").advice.ends_with(&format!("from 0 to {most}")));
    let file = |seed: &str| File::new(&format!("seed{seed}"), &format!("[robot]\nseed = {seed}\n"));
    for good in ["0", "9223372036854775808", &most] {
        assert_eq!(load(&flag("--seed", "robot.seed", good)).expect("within the range").hall.robot.seed.to_string(), good);
        assert_eq!(load(&file(good).sources()).expect("within the range").hall.robot.seed.to_string(), good);
    }
    for wrong in ["-1", "18446744073709551616"] {
        let expect = format!("setting robot.seed = {wrong} (from flag --seed): it is out of range; write a whole number from 0");
        let said = message(&flag("--seed", "robot.seed", wrong));
        assert!(said.starts_with(&expect), "{said}");
        assert!(message(&file(wrong).sources()).contains(wrong), "{wrong}");
    }
}

#[test]
fn a_wrong_value_is_shown_as_it_was_given_and_told_in_words_for_people() {
    let begins = [
        ("--speed", "robot.speed", "nan", "nan (from flag --speed): it is not a number; write a factor"),
        ("--speed", "robot.speed", "inf", "inf (from flag --speed): it is out of range; write a factor"),
        ("--speed", "robot.speed", "-inf", "-inf (from flag --speed): it is out of range; write a factor"),
        ("--speed", "robot.speed", "99999999999999999999", "99999999999999999999 (from flag --speed): it is out of range; write"),
        ("--speed", "robot.speed", "[1]", "[1] (from flag --speed): it is a list; write a factor"),
        ("--speed", "robot.speed", "true", "true (from flag --speed): it is true or false; write a factor"),
        ("--seed", "robot.seed", "1.5", "1.5 (from flag --seed): it is not a whole number; write a whole number"),
        ("--seed", "robot.seed", "many", "\"many\" (from flag --seed): it is a text; write a whole number"),
        ("-", "http.require_token", "1", "1 (from flag -): it is a number; write true or false"),
        ("-", "http.hosts", "1", "1 (from flag -): it is a number; write names without a port"),
    ];
    for (name, key, value, expect) in begins {
        let said = message(&flag(name, key, value));
        assert!(said.starts_with(&format!("setting {key} = {expect}")), "{said}");
    }
    let file = File::new("number", "[http]\nbind = 8080\n");
    assert!(message(&file.sources()).contains("): it is a number; write localhost:PORT"), "{}", message(&file.sources()));
}

#[test]
fn a_mistyped_key_is_refused_with_the_names_there_are() {
    let said = message(&environment("HALLSWEEP__HTTP__BNID", "127.0.0.1:1"));
    assert_eq!(
        said,
        "there is no setting `http.bnid` (from environment variable HALLSWEEP__HTTP__BNID): [http] has the settings http.bind, \
         http.require_token, http.hosts, http.tls_certificate, http.tls_key"
    );
    let file = File::new("mistyped", "[robott]\nseed = 2\n");
    assert!(message(&file.sources()).starts_with("there is no setting `robott` (from file "));
}

#[test]
fn a_wrong_value_is_named_with_its_origin_and_what_to_do() {
    let said = message(&flag("--http", "http.bind", "8080"));
    assert_eq!(
        said,
        "setting http.bind = \"8080\" (from flag --http): it is not an address with a port; write localhost:PORT, or \
         ADDRESS:PORT with a number for an address, such as 127.0.0.1:8080 or [::1]:8080"
    );
}

#[test]
fn every_kind_of_wrong_value_is_refused() {
    let wrong = [
        ("HALL__FILE", " "),
        ("HTTP__BIND", "localhost"),
        ("HTTP__REQUIRE_TOKEN", "perhaps"),
        ("COAP__BIND", "5683"),
        ("COAP__BIND", ""),
        ("COAP__OPEN_TO_OTHERS", "perhaps"),
        ("OLD_CLIENTS__MANUAL_DRIVING", "1"),
        ("HTTP__HOSTS", "hall.example:8080"),
        ("HTTP__HOSTS", "[\"\"]"),
        ("HTTP__HOSTS", "[1]"),
        ("ROBOT__SPEED", "0"),
        ("ROBOT__SPEED", "-1"),
        ("ROBOT__SPEED", "fast"),
        ("ROBOT__SPEED", "[1]"),
        ("ROBOT__SEED", "-1"),
        ("ROBOT__SEED", "1.5"),
        ("ROBOT__BAUD", "299"),
        ("ROBOT__STEP_MS", "49"),
        ("ROBOT__STEP_MS", "330.5"),
        ("ROBOT__UNKNOWN_RATE", "1.1"),
        ("ROBOT__PHOTO_FAILURE_RATE", "-0.1"),
        ("ROBOT__PHOTO_FAILURE_RATE", "often"),
        ("ROBOT__SONAR_NOISE_CM", "1000"),
        ("MISSION__STRATEGY", "zigzag"),
        ("MISSION__WALL_LINES", "7"),
        ("TEMPERATURE__THRESHOLD_CELSIUS", "-300"),
        ("TEMPERATURE__HYSTERESIS_CELSIUS", "-1"),
        ("LOG__FILTER", "hallsweep=loud"),
    ];
    for (name, value) in wrong {
        let variable = format!("HALLSWEEP__{name}");
        let said = message(&environment(&variable, value));
        let key = name.to_lowercase().replace("__", ".");
        assert!(said.starts_with(&format!("setting {key} = ")), "{said}");
        assert!(said.contains(&format!("(from environment variable {variable})")), "{said}");
        assert!(said.ends_with(crate::config::Key::named(&key).expect("a setting").advice), "{said}");
    }
}

fn chosen(address: &str) -> Option<Bind> {
    Some(Bind { at: BindAddress::read(address)?, is_chosen: true })
}

/// Safety A1.
#[test]
fn keys_are_asked_for_beyond_loopback_and_on_it_when_that_is_wanted() {
    let asks = |sources: &Sources| load(sources).expect("a good address").http.asks_for_keys;
    for (address, expect) in [
        ("localhost:0", false),
        ("127.0.0.1:0", false),
        ("[::1]:0", false),
        ("0.0.0.0:0", true),
        ("192.0.2.1:80", true),
        ("[::]:0", true),
    ] {
        assert_eq!(asks(&flag("--http", "http.bind", address)), expect, "{address}");
    }
    assert!(asks(&environment("HALLSWEEP__HTTP__REQUIRE_TOKEN", "true")));
    let mut insecure = flag("--http", "http.bind", "0.0.0.0:0");
    insecure.environment = vec![("HALLSWEEP__HTTP__REQUIRE_TOKEN".into(), "false".into())];
    assert!(asks(&insecure), "nothing takes it back");
}

/// Safety A1, A4.
#[test]
fn coap_is_for_this_machine_unless_somebody_means_otherwise() {
    let coap = |address: &str| load(&flag("--coap", "coap.bind", address));
    assert_eq!(load(&Sources::default()).expect("good").coap, Some(Bind { at: BindAddress::Localhost(5683), is_chosen: false }));
    assert_eq!(coap("none").expect("no door").coap, None);
    for address in ["127.0.0.1:0", "127.9.9.9:5683", "[::1]:5683", "[::ffff:127.0.0.1]:5683"] {
        assert_eq!(coap(address).expect(address).coap, chosen(address));
    }
    for address in ["0.0.0.0:5683", "192.0.2.7:5683", "[::]:5683"] {
        let said = coap(address).expect_err(address).to_string();
        assert!(said.starts_with(&format!("setting coap.bind = {address:?} (from flag --coap): everybody")), "{said}");
        assert!(said.contains("coap.open_to_others = true") && said.contains("localhost:5683"), "{said}");
        let mut meant = flag("--coap", "coap.bind", address);
        meant.environment = vec![("HALLSWEEP__COAP__OPEN_TO_OTHERS".into(), "true".into())];
        assert_eq!(load(&meant).expect("it is meant").coap, chosen(address));
    }
}

/// Safety A1, A4.
#[test]
fn our_own_broker_asks_for_passwords_beyond_loopback_and_on_it_when_that_is_wanted() {
    let broker = |sources: &Sources| load(sources).expect("good").mqtt.broker;
    let router = MqttRouter::Own;
    let own = |bind: &str, asks_for_keys| Some(Broker::Own { bind: chosen(bind).expect("an address"), asks_for_keys, router });
    let usual = |asks_for_keys| {
        Some(Broker::Own { bind: Bind { at: BindAddress::Localhost(1883), is_chosen: false }, asks_for_keys, router })
    };
    assert_eq!(broker(&Sources::default()), usual(false));
    assert_eq!(broker(&flag("--mqtt", "mqtt.bind", "none")), None);
    for (bind, asks) in [("[::1]:1883", false), ("0.0.0.0:1883", true), ("192.0.2.7:0", true), ("[::]:1883", true)] {
        assert_eq!(broker(&flag("--mqtt", "mqtt.bind", bind)), own(bind, asks));
    }
    assert_eq!(broker(&environment("HALLSWEEP__MQTT__REQUIRE_PASSWORD", "true")), usual(true));
}

#[test]
fn another_version_is_spoken_with_another_broker_alone() {
    let version = |broker: &str, version: &str| {
        let variables = [("HALLSWEEP__MQTT__BROKER", broker), ("HALLSWEEP__MQTT__VERSION", version)];
        load(&Sources {
            environment: variables.map(|(name, value)| (name.to_owned(), value.to_owned())).into(),
            ..Sources::default()
        })
        .map(|settings| settings.mqtt.broker)
    };
    for (written, is_five) in [("5", true), ("3.1.1", false)] {
        let Ok(Some(Broker::Other(other))) = version("mqtt://broker.example", written) else { panic!("it is another broker") };
        assert_eq!(other.is_five, is_five);
    }
    for (broker, written) in [("mqtt://broker.example", "4"), ("", "5"), ("", "x")] {
        let problem = version(broker, written).unwrap_err().to_string();
        assert!(problem.contains("mqtt.version"), "{problem}");
    }
}

#[test]
fn another_router_is_chosen_by_its_name() {
    let router = |name: &str| load(&environment("HALLSWEEP__MQTT__ROUTER", name)).map(|settings| settings.mqtt.broker);
    assert!(matches!(router("rumqttd"), Ok(Some(Broker::Own { router: MqttRouter::Rumqttd, .. }))));
    assert!(message(&environment("HALLSWEEP__MQTT__ROUTER", "mosquitto")).contains("write own or rumqttd"));
}

#[test]
fn another_broker_is_named_by_its_url() {
    let broker = |url: &str| match load(&environment("HALLSWEEP__MQTT__BROKER", url)).map(|settings| settings.mqtt.broker) {
        Ok(Some(Broker::Other(other))) => (other.host, other.port, other.is_encrypted),
        other => panic!("{url}: {other:?}"),
    };
    assert_eq!(broker("mqtt://broker.example"), ("broker.example".into(), 1883, false));
    assert_eq!(broker("mqtts://192.0.2.7/"), ("192.0.2.7".into(), 8883, true));
    assert_eq!(broker("mqtt://[::1]:1884"), ("::1".into(), 1884, false));
    for wrong in
        ["broker.example", "http://a", "mqtt://", "mqtt://a:0", "mqtt://a:99999", "mqtt://a b", "mqtt://[::1", "mqtt://a/b"]
    {
        let said = message(&environment("HALLSWEEP__MQTT__BROKER", wrong));
        assert!(said.starts_with("setting mqtt.broker") && said.contains("mqtt://HOST:PORT"), "{said}");
    }
}

#[test]
fn a_password_is_never_repeated() {
    for (name, value) in [("HALLSWEEP__MQTT__BROKER", "mqtt://me:secret@a"), ("HALLSWEEP__MQTT__PASSWORD", "secret")] {
        assert!(!message(&environment(name, value)).contains("secret"), "{name}");
    }
    let mut sources = environment("HALLSWEEP__MQTT__BROKER", "mqtt://a");
    sources.environment.push(("HALLSWEEP__MQTT__NAME".into(), "me".into()));
    sources.environment.push(("HALLSWEEP__MQTT__PASSWORD".into(), "secret".into()));
    assert!(!format!("{:?}", load(&sources).expect("good")).contains("secret"));
}

#[test]
fn topics_are_called_by_plain_words_and_old_ones_do_not_lie_among_new_ones() {
    for (name, wrong) in [("PREFIX", "a//b"), ("PREFIX", "a/#"), ("PREFIX", ""), ("ID", "a/b"), ("ID", "ü"), ("OLD_PREFIX", "/a")]
    {
        let said = message(&environment(&format!("HALLSWEEP__MQTT__{name}"), wrong));
        assert!(said.contains("it is not a valid part of a topic"), "{said}");
    }
    let said = message(&environment("HALLSWEEP__MQTT__ID", "halls"));
    assert!(said.contains("mixed with the topics of further halls"), "{said}");
    for among in ["hallsweep", "hallsweep/old"] {
        assert!(
            message(&environment("HALLSWEEP__MQTT__OLD_PREFIX", among)).contains("mixed with the topics of mqtt.prefix"),
            "{among}"
        );
    }
}

#[test]
fn old_clients_do_not_drive_unless_they_are_let() {
    assert!(!load(&Sources::default()).expect("good").old_clients.manual_driving);
    let let_drive = environment("HALLSWEEP__OLD_CLIENTS__MANUAL_DRIVING", "true");
    assert!(load(&let_drive).expect("good").old_clients.manual_driving);
}

#[test]
fn names_of_hosts_come_in_a_list_or_alone() {
    let hosts = |value: &str| load(&environment("HALLSWEEP__HTTP__HOSTS", value)).expect("names").http.hosts;
    assert_eq!(hosts("[\"hall.example\", \"engine\"]"), ["hall.example", "engine"]);
    assert_eq!(hosts("hall.example"), ["hall.example"]);
    assert_eq!(load(&Sources::default()).expect("the defaults are good").http.hosts, Vec::<String>::new());
}

#[test]
fn a_certificate_needs_its_key_and_a_key_its_certificate() {
    let said = message(&environment("HALLSWEEP__HTTP__TLS_CERTIFICATE", "hall.pem"));
    assert!(said.starts_with("setting http.tls_key = \"\"") && said.contains("http.tls_certificate"), "{said}");
    assert!(message(&environment("HALLSWEEP__HTTP__TLS_KEY", "key.pem")).starts_with("setting http.tls_certificate"));
    let mut both = environment("HALLSWEEP__HTTP__TLS_CERTIFICATE", "hall.pem");
    both.environment.push(("HALLSWEEP__HTTP__TLS_KEY".into(), "key.pem".into()));
    let tls = load(&both).expect("both").http.tls.expect("files");
    assert_eq!((tls.certificate, tls.key), (PathBuf::from("hall.pem"), PathBuf::from("key.pem")));
}

#[test]
fn the_data_folder_is_the_usual_one_or_a_named_one_or_none() {
    let store = |value: &str| load(&flag("--data", "store.folder", value)).expect("a folder").store;
    assert_eq!(store("none"), None);
    assert_eq!(store("some/where"), Some(PathBuf::from("some/where")));
    assert_eq!(store(""), folder::usual(|name| std::env::var_os(name)));
}

#[test]
fn a_file_that_is_missing_or_no_toml_is_named() {
    let missing = Sources { file: Some(PathBuf::from("no-such-settings.toml")), ..Sources::default() };
    assert!(message(&missing).starts_with("settings file no-such-settings.toml (from --config): "));
    let file = File::new("broken", "[http\nbind = 1\n");
    assert!(message(&file.sources()).contains("line 1"), "{}", message(&file.sources()));
}
