//! The CoAP interface beyond loopback: strangers can read and cannot change anything. Each test runs in its own
//! network namespace, in which 10.83.0.1 is an address of the namespace itself, so no datagram leaves it. Without
//! such a namespace the test is skipped with a message.

use std::process::{Command, Stdio};

use super::ask::Ask;
use super::client::Client;
use super::observer::Observer;
use super::{JSON, TEXT, shown, with_each};
use crate::program::{Program, hallsweep, run};
use crate::third_party::{left_out, within};

/// Address beyond loopback, inside the namespace.
const ADDRESS: &str = "10.83.0.1";

/// Time limit for a test in the namespace, in seconds. Each wait within the test has its own limit.
const PATIENCE_S: &str = "900";

/// Environment variable that tells a test that it runs inside the namespace.
const INSIDE: &str = "COAP_TESTS_INSIDE";

/// Returns true inside the namespace. Outside, runs the named test again in a new network namespace with one address
/// beyond loopback, and returns false.
fn is_inside(test: &str) -> bool {
    if std::env::var_os(INSIDE).is_some() {
        return true;
    }
    // Without root, `-r` makes the caller root inside the namespace only.
    let made = |program: &str, words: &[&str]| {
        let mut command = Command::new("unshare");
        command.args([
            "-r",
            "-n",
            "sh",
            "-c",
            "ip link set lo up && ip address add $0/32 dev lo && exec \"$@\"",
            ADDRESS,
            program,
        ]);
        command.args(words).env(INSIDE, "1").stdin(Stdio::null());
        command
    };
    let possible = made("true", &[]).stderr(Stdio::null()).status().is_ok_and(|status| status.success());
    if !possible {
        return left_out("CoAP", "a network namespace (as root, or with unprivileged ones allowed; apt-get install iproute2)");
    }
    let this = std::env::current_exe().expect("a test knows its program");
    let name = format!("coap_clients::beyond::{test}");
    let again = made(&this.display().to_string(), &["--exact", &name, "--nocapture"]);
    let output = within(PATIENCE_S, &again).stdin(Stdio::null()).output().expect("it was possible just now");
    let said = [output.stdout, output.stderr].map(|said| String::from_utf8_lossy(&said).into_owned()).concat();
    assert!(output.status.success() && said.contains("1 passed"), "in the namespace:\n{said}");
    false
}

/// Starts the program with a CoAP port that is open to others, inside the namespace.
fn open(hall: &str) -> Program {
    let coap = format!("{ADDRESS}:0");
    let arguments = ["serve", "--http", "127.0.0.1:0", "--coap", &coap, "--seed", "1", "--hall", hall, "--speed", "max"];
    Program::started(hallsweep(&arguments).env("HALLSWEEP__COAP__OPEN_TO_OTHERS", "true"))
}

#[test]
fn a_door_for_others_opens_only_when_the_settings_say_so() {
    let refused = run(&["serve", "--http", "127.0.0.1:0", "--coap", "10.83.0.1:5683"]);
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(!refused.status.success() && said.contains("coap.open_to_others") && said.contains("10.83.0.1"), "{said}");
}

/// A client that proves its address by an Echo option (RFC 9175) can read everything. libcoap's command does this by
/// itself, aiocoap needs one line of code, and coap-cli cannot do it and receives 4.01.
#[test]
fn strangers_read_everything_once_they_have_proved_their_address() {
    if !is_inside("strangers_read_everything_once_they_have_proved_their_address") {
        return;
    }
    let program = open("seed");
    let door = format!("coap://{}", program.coap());
    program.command("start").accepted();
    let piece = program.until_asked();
    let state = shown::state(program.json("state"));
    let photo = program.read(&format!("/api/v1/luggage/{piece}/photo"), &[]).body;
    // This client comes first: the system may give it the port of a client that has proved its address.
    if Client::CoapCli.is_here() {
        assert_eq!(Client::CoapCli.ask(&door, &Ask::get("/state")).code, "4.01");
    }
    for client in [Client::Libcoap, Client::Aiocoap].into_iter().filter(|client| client.is_here()) {
        let get = |path: &str| client.ask(&door, &Ask { block: Some(1024), ..Ask::get(path) });
        assert_eq!(get("/robot").json(), state["robot"], "{client:?}");
        assert!(get("/.well-known/core").text().contains("</resourcemodel>"));
        assert_eq!(get("/state").json(), state, "{client:?}");
        assert!(get(&format!("/luggage/{piece}/photo")).content() == photo, "{client:?}");
    }
}

/// Safety A4.
#[test]
fn strangers_change_nothing() {
    if !is_inside("strangers_change_nothing") {
        return;
    }
    let program = open("empty-8x8");
    let door = format!("coap://{}", program.coap());
    let before = program.until("the robot is there", |state| state["mission"]["holds"] == serde_json::json!([]));
    with_each(|client| {
        let refused = |ask: Ask| client.ask(&door, &ask).refused("4.03", "use HTTP");
        refused(Ask::post("/commands/start", "{}").labelled(JSON));
        refused(Ask::post("/commands/stop", "{}").labelled(JSON));
        refused(Ask::put("/temperature", "{\"celsius\":31.5}").labelled(JSON));
        refused(Ask::put("/strategy", "{\"name\":\"snail\"}").labelled(JSON));
        refused(Ask::put("/resourcemodel", "h").labelled(TEXT));
        refused(Ask::post("/luggage/1/verdict", "{\"verdict\":\"safe\"}").labelled(JSON));
    });
    assert_eq!(program.json("state"), before);
}

#[test]
fn strangers_observe_once_they_have_proved_their_address() {
    if !is_inside("strangers_observe_once_they_have_proved_their_address") {
        return;
    }
    for client in [Client::Libcoap, Client::Aiocoap].into_iter().filter(|client| client.is_here()) {
        let program = open("empty-8x8");
        let door = format!("coap://{}", program.coap());
        let robot = Observer::start(client, &door, Ask::get("/robot").accept(JSON));
        program.command("start").accepted();
        let state = program.until_phase("explored");
        robot.until_json("the robot is where it stands", |seen| *seen == state["robot"]);
        robot.end();
    }
}
