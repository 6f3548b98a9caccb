//! How to reach the image: the link of the first start, addresses, host names, a whole mission, and a broker over
//! TLS.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::client::{Client, phase};
use crate::engine::{ContainerEngine, ON_LOOPBACK, engine, left_out, text, until, unused};

/// Options that remove everything that hallsweep does not need from a container, as in README.md.
pub(crate) const HARDENED: &str = "--read-only --cap-drop all --security-opt no-new-privileges --memory 256m";

pub(crate) fn hardened() -> Vec<&'static str> {
    HARDENED.split(' ').collect()
}

const QUICK: &str = "--env=HALLSWEEP__ROBOT__SPEED=max";

#[test]
fn hardened_as_the_readme_says_it_prints_a_link_is_healthy_and_searches_a_whole_hall() {
    let readme = include_str!("../../README.md");
    assert!(readme.contains(HARDENED), "the command of the README is the one that is tried here");
    let Some(engine) = engine() else { return };
    let volume = engine.volume();
    let at_data = volume.at_data();
    let options = [hardened(), vec![ON_LOOPBACK, QUICK, &at_data]].concat();
    let container = engine.serve(&options, &["--hall", "seed"]);
    let logs = container.until_logged("/sign-in?token=");
    assert!(logs.contains("Sign in as operator: http://127.0.0.1:8080/sign-in?token="), "{logs}");
    container.until_healthy();
    let client = Client::of(&container);
    let link = logs.split("http://127.0.0.1:8080").find(|rest| rest.starts_with("/sign-in?token=")).expect("a link");
    let (status, page) = client.look(link.split_whitespace().next().expect("it begins with a path"), None);
    assert!(status == 200 && page.contains("<form"), "the link leads to where one signs in: {status}");
    let (status, page) = client.look("/", None);
    assert!(status == 200 && page.contains("STOP"), "{status}");
    let state = client.search_the_hall();
    assert!(!state["luggage"].as_array().expect("a list").is_empty(), "{state}");
    let report = container.exec(&["hallsweep", "report", "1", "-o", "-"]);
    assert!(report.status.success() && text(&report.stdout).ends_with("</html>"), "{}", text(&report.stderr));
    let check = container.exec(&["hallsweep", "journal", "check"]);
    assert!(check.status.success(), "{check:?}");
    assert_eq!(container.end(&["stop"]), "0");
}

/// Whether the health check of the image succeeds. docker runs the check by itself; podman leaves that to a timer, so
/// the test runs it.
fn is_healthy(engine: &ContainerEngine, name: &str) -> bool {
    if engine.is_docker() {
        return engine.run(&["inspect", "--format", "{{.State.Health.Status}}", name]) == "healthy";
    }
    engine.ask(&["healthcheck", "run", name]).status.success()
}

#[test]
fn address_and_arguments_are_followed_by_the_health_check() {
    let Some(engine) = engine() else { return };
    let other = ["--publish=127.0.0.1::9000", "--env=HALLSWEEP__HTTP__BIND=0.0.0.0:9000"];
    let container = engine.serve(&other, &["--hall", "seed"]);
    container.until_healthy();
    let client = Client::at(container.published("9000/tcp"), "none");
    assert_eq!(client.look("/healthz", None).0, 200);
    assert_eq!(client.look("/api/v1/state", None).0, 401, "a key is asked for");
    until("the engine finds it healthy", || is_healthy(&engine, &container.name).then_some(()));
    let link = text(&container.exec(&["hallsweep", "token"]).stdout);
    assert!(link.contains("http://127.0.0.1:9000/sign-in?token="), "{link}");
}

#[test]
fn it_is_reached_by_addresses_and_by_the_names_that_it_was_given() {
    let Some(engine) = engine() else { return };
    let container = engine.serve(&[ON_LOOPBACK, r#"--env=HALLSWEEP__HTTP__HOSTS=["hallsweep"]"#], &[]);
    let client = Client::of(&container);
    for (host, expect) in [("hallsweep:8080", 200), ("10.88.0.7:8080", 200), ("localhost", 200), ("hall.example", 421)] {
        assert_eq!(client.look("/healthz", Some(host)).0, expect, "{host}");
    }
}

#[test]
fn the_log_has_the_time_of_the_zone_that_is_asked_for() {
    let Some(engine) = engine() else { return };
    for (zone, expect) in [("Asia/Kathmandu", "+05:45 "), ("XYZ-4:30", "+04:30 ")] {
        let container = engine.serve(&[&format!("--env=TZ={zone}")], &[]);
        container.until_healthy();
        let logs = container.logs();
        let serving = logs.lines().find(|line| line.contains("serving"));
        assert!(serving.is_some_and(|line| line.contains(expect)), "{zone}: {logs}");
    }
}

struct Broker(Child);

impl Drop for Broker {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Only the certificates in the image's file are trusted; a site replaces that file to trust its own.
#[test]
fn a_broker_is_believed_by_the_roots_of_the_system_and_by_no_others() {
    let Some(engine) = engine() else { return };
    let mosquitto = ["/usr/sbin/mosquitto", "/usr/bin/mosquitto"].into_iter().find(|path| Path::new(path).exists());
    let Some(mosquitto) = mosquitto else {
        return left_out("mosquitto");
    };
    let folder = std::env::temp_dir().join(unused("broker"));
    std::fs::create_dir_all(&folder).expect("the folder is ours");
    let of_tests = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/service/tls").join(name);
    let port = std::net::TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).expect("a free port").port();
    let (certificate, key) = (of_tests("test-only-certificate.pem"), of_tests("test-only-key.pem"));
    let log = folder.join("broker.log");
    let settings = format!(
        "listener {port} 127.0.0.1\nallow_anonymous true\nuser root\ncertfile {}\nkeyfile {}\nlog_dest file {}\n",
        certificate.display(),
        key.display(),
        log.display()
    );
    std::fs::write(folder.join("broker.conf"), settings).expect("the folder is ours");
    let mut broker = Command::new(mosquitto);
    broker.arg("-c").arg(folder.join("broker.conf")).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let _broker = Broker(broker.spawn().expect("the broker starts"));
    until("the broker listens", || std::net::TcpStream::connect(("127.0.0.1", port)).ok());

    // The certificates that the image trusts by default, and the test's own certificate.
    let copied = engine.serve(&[], &[]);
    let roots = folder.join("roots.pem");
    engine.run(&["cp", &format!("{}:/etc/ssl/certs/ca-certificates.crt", copied.name), roots.to_str().expect("text")]);
    let believed = std::fs::read_to_string(&roots).expect("text");
    assert!(believed.matches("BEGIN CERTIFICATE").count() > 100, "the roots of Debian");
    std::fs::write(&roots, believed + &std::fs::read_to_string(certificate).expect("text")).expect("text");

    let address = format!("--env=HALLSWEEP__MQTT__BROKER=mqtts://127.0.0.1:{port}");
    // Host network, because the test's broker listens on loopback alone; therefore HTTP uses a free port and CoAP is
    // off.
    let here = ["--network=host", "--env=HALLSWEEP__HTTP__BIND=127.0.0.1:0", "--env=HALLSWEEP__COAP__BIND=none", &address];
    let stranger = engine.serve(&here, &[]);
    stranger.until_logged("UnknownIssuer");
    let own = format!("--volume={}:/etc/ssl/certs/ca-certificates.crt:ro", roots.display());
    let has_come = || std::fs::read_to_string(&log).is_ok_and(|log| log.contains("New client connected"));
    assert!(!has_come(), "nobody who does not believe the broker");
    let _believer = engine.serve(&[&here[..], &[&own]].concat(), &[]);
    until("the broker has a client", || has_come().then_some(()));
    std::fs::remove_dir_all(&folder).expect("the folder is ours");
}

/// Like the containers of a pod, which share one loopback.
#[test]
fn whoever_shares_the_loopback_of_the_container_finds_no_door_without_a_key() {
    let Some(engine) = engine() else { return };
    let container = engine.serve(&[], &[]);
    container.until_healthy();
    let beside = |command: &str| {
        let shared = format!("--network=container:{}", container.name);
        engine.once(&engine.debug, &["--entrypoint=sh", &shared], &["-c", command]).1
    };
    let listening = beside("busybox netstat -tuln");
    assert!(listening.contains(":1883 ") && listening.contains(":8080 ") && !listening.contains(":5683"), "{listening}");
    // CONNECT without a user name; the answer is CONNACK 5, not authorised.
    let connect = r"printf '\020\014\000\004MQTT\004\002\000\074\000\000' | busybox nc 127.0.0.1 1883 | busybox od -An -tx1";
    assert_eq!(beside(connect).trim(), "20 02 00 05");
}

#[test]
fn from_outside_nothing_is_done_without_a_key() {
    let Some(engine) = engine() else { return };
    let container = engine.serve(&[ON_LOOPBACK], &[]);
    container.until_healthy();
    let stranger = Client::at(container.published("8080/tcp"), &"ab".repeat(32));
    for path in ["/api/v1/state", "/metrics", "/api/v1/luggage/1/photo"] {
        assert_eq!(stranger.look(path, None).0, 401, "{path}");
    }
    for command in ["commands/start", "commands/stop", "commands/reset", "luggage/1/verdict"] {
        assert_eq!(stranger.send(command, r#"{"verdict":"safe"}"#).0, 401, "{command}");
    }
    let state = Client::of(&container).state();
    assert_eq!((phase(&state), state["mission"]["epoch"].as_u64()), ("idle", Some(0)));
}
