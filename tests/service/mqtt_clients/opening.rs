//! Opening and closing the MQTT interface: an occupied port is reported with a remedy, and without MQTT everything
//! else works.

use std::net::TcpListener;

use super::AVAILABILITY;
use super::running::RunningClient;
use super::told::Hello;
use super::with_each;
use crate::program::{Program, run};

#[test]
fn a_port_that_is_taken_is_named_with_what_to_do() {
    let taken = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let address = taken.local_addr().expect("a bound port").to_string();
    let output = run(&["serve", "--http", "127.0.0.1:0", "--mqtt", &address]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(output.stdout.is_empty(), "nothing was started");
    assert!(said.contains(&format!("cannot listen on {address} for MQTT")) && said.contains("--mqtt localhost:0"), "{said}");
    assert!(said.contains("--mqtt none"), "{said}");
}

#[test]
fn without_mqtt_the_other_doors_are_there() {
    let mut program = Program::with(&["serve", "--http", "127.0.0.1:0", "--mqtt", "none", "--hall", "empty-8x8"]);
    program.command("start").accepted();
    assert!(program.read("/mqtt", &[]).problem(404).contains("mqtt.bind"), "it says why");
    assert!(program.coap().port() > 0);
    program.signal("TERM");
    assert!(program.ended_within(std::time::Duration::from_secs(30)).is_some_and(|status| status.success()));
    assert!(program.last_words().iter().all(|line| !line.contains("mqtt://")), "it has no such door");
}

/// Two robots at separate brokers, or at one broker, are distinguished by their topics.
#[test]
fn the_names_of_the_topics_are_settings() {
    with_each(|client| {
        let mut command = crate::program::hallsweep(&["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8"]);
        command.env("HALLSWEEP__MQTT__PREFIX", "airport/robots").env("HALLSWEEP__MQTT__ID", "r2");
        let program = Program::started(command.env("HALLSWEEP__MQTT__OLD_PREFIX", "r2/qak"));
        let process = RunningClient::begin(client, &program, Hello::following(&["#"], 0));
        process.until_newest("airport/robots/r2/availability", "online", |message| message.payload == "online");
        program.command("start").accepted();
        process.until_newest("r2/qak/events", "the old words", |message| message.payload.contains("content(robot("));
        let heard = process.heard();
        assert!(heard.iter().all(|message| message.topic != AVAILABILITY && !message.topic.starts_with("unibo")), "{heard:#?}");
        process.leave();
    });
}
