//! Start of the program: refused settings, an occupied port, and the health check.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, TcpListener, TcpStream, UdpSocket};

use serde_json::Value;

use crate::program::{PATIENCE, Program, hallsweep, run};

fn refused(arguments: &[&str], code: i32) -> String {
    let output = run(arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(output.stdout.is_empty(), "nothing was started");
    said
}

#[test]
fn a_wrong_setting_stops_the_start_with_key_value_origin_and_what_to_do() {
    let said = refused(&["serve", "--speed", "fast"], 2);
    assert_eq!(
        said,
        "hallsweep: setting robot.speed = \"fast\" (from flag --speed): this word is not a speed; \
         write a factor from 0.1 to 1000 (1 is normal speed), or max for no waiting\n"
    );
    let output = hallsweep(&[]).env("HALLSWEEP__ROBOT__SPED", "1").output().expect("the program starts");
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("`robot.sped` (from environment variable HALLSWEEP__ROBOT__SPED)"), "{said}");
    assert!(refused(&["--config", "no-such-file.toml"], 2).contains("no-such-file.toml"));
}

#[test]
fn a_mistyped_flag_is_refused_with_the_same_code() {
    assert!(refused(&["serve", "--sped", "1"], 2).contains("--speed"));
}

#[test]
fn a_hall_that_is_not_there_is_refused_with_those_that_are() {
    let said = refused(&["serve", "--http", "127.0.0.1:0", "--hall", "no-such-hall"], 2);
    let named = "hallsweep: setting hall.file = \"no-such-hall\" (from flag --hall): no-such-hall: cannot read this file (";
    assert!(said.starts_with(named) && said.contains("airport"), "{said}");
    let output = hallsweep(&["explore"]).env("HALLSWEEP__HALL__FILE", "no-such-hall").output().expect("the program starts");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("(from environment variable HALLSWEEP__HALL__FILE)"), "{said}");
}

#[test]
fn with_a_robot_that_does_not_answer_it_starts_and_says_what_does_nothing() {
    let arguments = ["serve", "--robot", "virtual-tcp=127.0.0.1:1", "--speed", "2", "--http", "127.0.0.1:0"];
    let program = Program::with(&arguments);
    let idle = std::iter::repeat_with(|| program.says()).take(3).last();
    assert_eq!(idle.as_deref(), Some("These settings have no effect on the configured robots: flag --speed"));
    let robots = program.json("robots");
    assert_eq!((&robots[0]["kind"], &robots[0]["parts"], &robots[1]), (&"virtual-tcp".into(), &Value::Null, &Value::Null));
}

#[test]
fn another_robot_is_refused_with_what_is_wrong_and_what_to_do() {
    let said = refused(&["serve", "--robot", "mbot"], 2);
    let begins =
        "hallsweep: setting robot.kind = \"mbot\" (from flag --robot): there is no such kind of robot; write one of: sim, ";
    assert!(said.starts_with(begins), "{said}");
    assert!(refused(&["serve", "--robot", "line"], 2).contains("/dev/ttyUSB0"));
    assert!(refused(&["explore", "--robot", "sim"], 2).contains("--robot"));
}

#[test]
fn a_mission_without_doors_has_the_simulated_robot_whatever_the_settings_say() {
    let explore = |kind: &str| {
        let mut command = hallsweep(&["explore", "--hall", "empty-8x8", "--seed", "3", "--json"]);
        let output = command.env("HALLSWEEP__ROBOT__KIND", kind).output().expect("the program starts");
        assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
        serde_json::from_slice::<Value>(&output.stdout).expect("JSON")
    };
    assert_eq!(explore("virtual-ws"), explore("sim"));
}

#[test]
fn a_variable_that_only_looks_like_a_setting_is_reported() {
    let run = |name: &str| hallsweep(&["explore", "--hall", "empty-8x8"]).env(name, "1").output().expect("the program starts");
    let output = run("HALLSWEEP_ROBOT_SPEED");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("the variable for robot.speed is HALLSWEEP__ROBOT__SPEED"), "{said}");
    let zoned = hallsweep(&["explore", "--hall", "empty-8x8"]).env("TZ", "XYZ-4:30").env("HALLSWEEP_ELSE", "1").output();
    let said = String::from_utf8_lossy(&zoned.expect("the program starts").stderr).into_owned();
    assert!(said.contains("+04:30") && said.contains("HALLSWEEP_ELSE"), "the log has the time of the zone: {said}");
    let output = run("HALLSWEEP_SERVICE_HOST");
    assert!(output.status.success() && String::from_utf8_lossy(&output.stderr).contains("HALLSWEEP_SERVICE_HOST"), "{output:?}");
    let output = run("HALLSWEEP_REQUIRE_CLIENTS");
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
}

/// File of the system's time zone database. Rome has two offsets in a year, and neither is that of UTC.
const ROME: &str = "/usr/share/zoneinfo/Europe/Rome";

#[test]
fn the_time_zone_is_the_one_that_is_asked_for() {
    let offset = |zone: &str| {
        let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "max"];
        let program = Program::started(hallsweep(&arguments).env("TZ", zone));
        program.command("start").accepted();
        let state = program.until("a line in the log", |state| state["log"][0]["at"].is_string());
        let at = state["log"][0]["at"].as_str().expect("a moment").to_owned();
        at[at.len() - 6..].to_owned()
    };
    assert_eq!(offset("XYZ-4:30"), "+04:30", "a rule without a file");
    if !std::path::Path::new(ROME).exists() {
        eprintln!("{ROME} is absent: not tested");
        return;
    }
    let rome = offset("Europe/Rome");
    assert!(["+01:00", "+02:00"].contains(&rome.as_str()), "{rome}");
}

#[test]
fn a_port_that_is_taken_is_named_with_what_to_do() {
    let taken = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = taken.local_addr().expect("a bound port").to_string();
    let said = refused(&["serve", "--http", &address], 1);
    assert!(said.contains(&address) && said.contains("--http localhost:0"), "{said}");
}

/// A user who already runs a web server and a broker still gets a console at the first start.
#[test]
fn a_usual_port_that_is_taken_gives_way_and_that_is_said() {
    let ports = [("HTTP", 8080), ("MQTT", 1883)];
    // If another process already uses the port, the effect is the same.
    let _taken: Vec<_> = ports.iter().map(|(_, port)| TcpListener::bind(("127.0.0.1", *port))).collect();
    let _taken_too = UdpSocket::bind("127.0.0.1:5683");
    let mut command = hallsweep(&["serve", "--hall", "empty-8x8"]);
    command.env_remove("HALLSWEEP__COAP__BIND").env_remove("HALLSWEEP__MQTT__BIND");
    let program = Program::started(&mut command);
    assert_ne!(program.address().port(), 8080);
    assert_eq!(program.read("/healthz", &[]).status, 200);
    let [coap, mqtt, broker] = [program.says(), program.says(), program.says()];
    assert!(coap.contains("another program uses port 5683; choose a port with --coap localhost:PORT"), "{coap}");
    assert!(mqtt.contains("another program uses port 1883; choose a port with --mqtt localhost:PORT"), "{mqtt}");
    assert!(broker.contains("HALLSWEEP__MQTT__BROKER=mqtt://localhost:1883"), "{broker}");
}

/// Old clients use `localhost`, which may resolve to either address.
#[test]
fn localhost_is_both_of_its_addresses_at_every_door() {
    let mut command = hallsweep(&["serve", "--http", "localhost:0", "--hall", "empty-8x8"]);
    command.env("HALLSWEEP__COAP__BIND", "localhost:0").env("HALLSWEEP__MQTT__BIND", "localhost:0");
    let program = Program::started(&mut command);
    for address in [program.address(), program.mqtt()] {
        for ip in loopbacks() {
            assert!(TcpStream::connect((ip, address.port())).is_ok(), "{ip} {address}");
        }
    }
    for ip in loopbacks() {
        let socket = UdpSocket::bind((ip, 0)).expect("a free port");
        socket.connect((ip, program.coap().port())).expect("it is this machine's");
        socket.set_read_timeout(Some(PATIENCE)).expect("it is no zero");
        // A CoAP ping (RFC 7252, section 4.3) is answered with a reset.
        socket.send(&[0x40, 0, 0x12, 0x34]).expect("it is sent");
        let mut answer = [0; 16];
        assert_eq!(
            socket.recv(&mut answer).map(|length| answer[..length].to_vec()).expect("an answer"),
            [0x70, 0, 0x12, 0x34],
            "{ip}"
        );
    }
}

/// Loopback addresses that this machine has.
fn loopbacks() -> Vec<IpAddr> {
    let both: [IpAddr; 2] = [Ipv4Addr::LOCALHOST.into(), Ipv6Addr::LOCALHOST.into()];
    both.into_iter().filter(|ip| UdpSocket::bind((*ip, 0)).is_ok()).collect()
}

#[test]
fn the_health_check_knows_whether_somebody_is_there() {
    let program = Program::serve("empty-8x8", "max");
    let check = |address: &str| run(&["healthcheck", "--http", address]).status.code();
    assert_eq!(program.read("/healthz", &[]).status, 200);
    assert_eq!(check(&program.address().to_string()), Some(0));
    assert_eq!(check("127.0.0.1:1"), Some(1), "nobody listens at port 1");
    let every = format!("0.0.0.0:{}", program.address().port());
    let as_started = run(&["healthcheck", "--http", &every, "--data", "none"]);
    assert_eq!(as_started.status.code(), Some(0), "{as_started:?}");
}

#[test]
fn the_mission_table_of_the_documents_is_the_one_in_the_program() {
    let printed = run(&["table"]);
    assert!(printed.status.success());
    let document = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/mission-table.md");
    let document = std::fs::read_to_string(document).expect("the table is in the documents");
    assert_eq!(String::from_utf8_lossy(&printed.stdout).trim_end(), document.trim_end());
}

#[test]
fn version_and_help_are_there() {
    let version = run(&["--version"]);
    assert_eq!(String::from_utf8_lossy(&version.stdout), format!("hallsweep {}\n", env!("CARGO_PKG_VERSION")));
    let help = String::from_utf8_lossy(&run(&["--help"]).stdout).into_owned();
    for word in ["serve", "explore", "healthcheck", "--hall", "--speed", "config/default.toml"] {
        assert!(help.contains(word), "{word} is not in\n{help}");
    }
}
