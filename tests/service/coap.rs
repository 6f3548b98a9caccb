//! The CoAP interface of the real program beside the other interfaces: a change made at one is visible at the
//! others, and the settings decide how the port is opened. Real clients are tested in `coap_clients`, and the
//! protocol is tested beside the endpoint.

use std::net::UdpSocket;
use std::time::Duration;

use serde_json::Value;

#[path = "../../benches/common/coap.rs"]
pub(crate) mod client;

use client::{Coap, Reply};

use crate::program::{Deadline, Program, hallsweep, run};

/// Longest wait for a state.
const PATIENCE: Duration = Duration::from_secs(60);

/// Observes a resource, and reads notifications until one matches.
struct Observer {
    client: Coap,
    latest: Reply,
}

impl Observer {
    fn of(program: &Program, path: &str) -> Observer {
        let mut client = Coap::at(program.coap());
        let latest = client.observe(path).expect("the door answers");
        Observer { client, latest }
    }

    fn until(&mut self, wanted: &str, is_so: impl Fn(&str) -> bool) {
        let deadline = Deadline::within(PATIENCE);
        while !is_so(&self.latest.text) {
            assert!(!deadline.has_passed(), "never seen: {wanted}; the latest is {:?}", self.latest);
            if let Ok(news) = self.client.next() {
                self.latest = news;
            }
        }
        assert_eq!(self.latest.code, "2.05");
    }
}

fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap_or_default()
}

fn holds(mission: &str) -> bool {
    json(mission)["holds"].as_array().is_some_and(|holds| holds.iter().any(|hold| hold == "operator"))
}

/// The console page as a browser receives it.
fn page(program: &Program) -> String {
    program.read("/", &[]).text()
}

/// Sprint 3 of the original system: START and STOP on the page change the resource.
#[test]
fn what_is_pressed_on_the_page_is_seen_over_coap() {
    let program = Program::serve("empty-8x8", "1");
    let mut mission = Observer::of(&program, "mission");
    let mut model = Observer::of(&program, "resourcemodel");
    assert_eq!(json(&mission.latest.text)["phase"], "idle", "{:?}", mission.latest);
    program.press("/startappl").accepted();
    mission.until("the search", |mission| json(mission)["phase"] == "exploring");
    model.until("a robot that moves", |item| item.starts_with("robot( state(moving"));
    program.press("/stopappl").accepted();
    mission.until("the hold", holds);
    model.until("a robot that stands", |item| item.starts_with("robot( state(stopped)"));
}

#[test]
fn what_is_commanded_over_coap_is_seen_on_the_page() {
    let program = Program::serve("empty-8x8", "1");
    let mut client = Coap::at(program.coap());
    let mut command = |name: &str| {
        let reply = client.ask("POST", &format!("commands/{name}"), "").expect("the door answers");
        assert_eq!((reply.code.as_str(), &json(&reply.text)["accepted"]), ("2.04", &Value::Bool(true)), "{reply:?}");
        json(&reply.text)["revision"].as_u64().expect("an acceptance names its revision")
    };
    let revision = command("start");
    let state = program.json("state");
    assert!(state["revision"].as_u64() >= Some(revision));
    assert_eq!(state["mission"]["phase"], "exploring");
    let before = page(&program);
    command("stop");
    let state = program.json("state");
    assert!(holds(&state["mission"].to_string()), "{state:#}");
    assert_ne!(page(&program), before, "the page shows it");
    let refused = Coap::at(program.coap()).ask("POST", "commands/retrieve", "").expect("the door answers");
    assert!(refused.code == "4.09" && refused.text.starts_with("refused: not possible while"), "{refused:?}");
}

/// Safety A6.
#[test]
fn who_commanded_over_coap_is_on_record() {
    let program = Program::serve("empty-8x8", "1");
    let reply = Coap::at(program.coap()).ask("POST", "commands/start", "").expect("the door answers");
    assert_eq!(reply.code, "2.04", "{reply:?}");
    let events = program.json("missions/1/events").to_string();
    assert!(events.contains("\"coap\"") && events.contains("127.0.0.1"), "{events}");
}

fn refused(arguments: &[&str], code: i32) -> String {
    let output = run(&[&["serve", "--http", "127.0.0.1:0"], arguments].concat());
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{said}");
    assert!(output.stdout.is_empty(), "nothing was started");
    said
}

#[test]
fn a_port_that_is_taken_is_named_with_what_to_do() {
    let taken = UdpSocket::bind("127.0.0.1:0").expect("a free port");
    let address = taken.local_addr().expect("a bound port").to_string();
    let said = refused(&["--coap", &address], 1);
    assert!(said.contains(&format!("cannot listen on {address} for CoAP")) && said.contains("--coap localhost:0"), "{said}");
    assert!(said.contains("--coap none"), "{said}");
}

/// Safety A1, A4.
#[test]
fn an_address_for_others_is_refused_unless_it_is_meant() {
    let said = refused(&["--coap", "0.0.0.0:0"], 2);
    assert!(said.contains("coap.bind = \"0.0.0.0:0\" (from flag --coap)") && said.contains("coap.open_to_others"), "{said}");
    let arguments = ["serve", "--http", "127.0.0.1:0", "--coap", "0.0.0.0:0", "--hall", "empty-8x8"];
    let program = Program::started(hallsweep(&arguments).env("HALLSWEEP__COAP__OPEN_TO_OTHERS", "true"));
    let reply = Coap::at(program.coap()).ask("GET", "mission", "").expect("the door answers");
    assert_eq!(reply.code, "2.05");
}

#[test]
fn without_coap_the_other_doors_are_there() {
    let mut program = Program::with(&["serve", "--http", "127.0.0.1:0", "--coap", "none", "--hall", "empty-8x8"]);
    program.command("start").accepted();
    program.signal("TERM");
    assert!(program.ended_within(PATIENCE).is_some_and(|status| status.success()));
    assert!(program.last_words().iter().all(|line| !line.contains("coap://")), "it has no such door");
}
