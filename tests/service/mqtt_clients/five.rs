//! Features of MQTT 5 only, with clients by other authors.

use super::client::{Client, mosquitto_rr};
use crate::program::Program;
use crate::third_party::{folder, patiently, python};

/// Number of scenarios in `five.py`, each of which prints a line.
const SCENARIOS: usize = 10;

#[test]
fn what_only_mqtt_5_can_is_as_paho_expects_it() {
    if !Client::PahoFive.is_here() {
        return;
    }
    let program = Program::serve("empty-8x8", "max");
    let broker = program.mqtt();
    let mut command = python();
    command.arg(folder().join("five.py")).args([broker.ip().to_string(), broker.port().to_string()]);
    let output = patiently(&command).output().expect("python is there");
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{said}");
    assert_eq!(said.lines().filter(|line| line.starts_with("ok ")).count(), SCENARIOS, "{said}");
}

/// The sender asks and waits for the answer, as at any other broker.
#[test]
fn a_command_is_a_question_with_an_answer() {
    if !Client::MosquittoFive.is_here() {
        return;
    }
    let program = Program::serve("empty-8x8", "max");
    let answer = mosquitto_rr(program.mqtt().port(), "hallsweep/discovery/command/stop", "site/answer");
    assert_eq!(
        (answer["topic"].as_str(), answer["properties"]["user-properties"]["by"].as_str()),
        (Some("site/answer"), Some("operator"))
    );
    assert!(answer["payload"].as_str().is_some_and(|said| said.contains("\"accepted\":true")), "{answer}");
}
