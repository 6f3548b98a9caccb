//! A configured temperature sensor must send readings: before the first reading, and after the sensor falls silent,
//! nothing moves.

use serde_json::Value;

use crate::program::{Answer, Program, hallsweep};
use crate::stream::Events;

/// A program whose sensor `roof` may be silent for one second.
fn watched() -> Program {
    let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0", "--seed", "1", "--hall", "airport", "--speed", "1"]);
    command.env("HALLSWEEP__TEMPERATURE__SENSOR", "roof").env("HALLSWEEP__TEMPERATURE__SENSOR_SILENCE_S", "1");
    Program::started(&mut command)
}

fn reads(program: &Program, sensor: &str, celsius: &str) -> Answer {
    program.put("/api/v1/temperature", &format!("{{\"celsius\":{celsius},\"sensor\":\"{sensor}\"}}"))
}

fn holds(mission: &Value, hold: &str) -> bool {
    mission["holds"].as_array().is_some_and(|holds| holds.iter().any(|held| held == hold))
}

/// Starts the robot right after a reading. On a busy machine the second may pass before START arrives, so there are
/// several attempts.
fn start_while_heard(program: &Program) {
    let started = (0..100).any(|_| {
        reads(program, "roof", "21.5").accepted();
        program.command("start").status == 200
    });
    assert!(started, "a sensor that was just heard lets the robot start");
}

/// Safety S3, for the sensor.
#[test]
fn a_sensor_must_be_heard_before_the_robot_starts_and_when_it_falls_silent_a_start_is_needed_again() {
    let program = watched();
    assert!(holds(&program.json("state")["mission"], "temperatureStale"), "it was never heard");
    assert!(program.command("start").problem(409).contains("silent"));
    start_while_heard(&program);

    let mut events = Events::open(&program, None);
    let stale = std::iter::from_fn(|| Some(events.next().data)).find(|data| holds(&data["mission"], "temperatureStale"));
    let mission = &stale.expect("the stream goes on")["mission"];
    assert!(holds(mission, "awaitingStart"), "{mission}");
    assert_eq!(program.json("state")["temperature"]["status"], "stale");

    let heard = std::iter::from_fn(|| {
        reads(&program, "roof", "21.5").accepted();
        Some(events.next().data["mission"].take())
    });
    let heard = heard.into_iter().find(|mission| mission["holds"].is_array() && !holds(mission, "temperatureStale"));
    assert!(holds(&heard.expect("the stream goes on"), "awaitingStart"), "the end of the cause alone sets nothing moving");
    start_while_heard(&program);
}

#[test]
fn readings_that_cannot_be_and_readings_of_others_do_not_keep_a_sensor_alive() {
    let program = watched();
    start_while_heard(&program);
    let mut events = Events::open(&program, None);
    let stale = std::iter::from_fn(|| {
        assert!(reads(&program, "roof", "-300").problem(422).contains("celsius must be"));
        assert!(reads(&program, "cellar", "21.5").problem(404).contains("cellar"));
        program.put("/api/v1/temperature", "{\"celsius\":21.5}").accepted();
        Some(events.next().data)
    });
    assert!(stale.take(1000).any(|data| holds(&data["mission"], "temperatureStale")), "nothing of this is the sensor's word");
}

#[test]
fn a_sensor_that_is_not_configured_is_refused_by_name() {
    let program = Program::serve("empty-8x8", "max");
    let refused = reads(&program, "roof", "21.5");
    assert!(refused.problem(404).contains("temperature.sensor"));
    assert_eq!(refused.json()["code"], "unknownSensor");
    assert!(reads(&program, "", "21.5").problem(422).contains("1 to 64 visible characters"));
    assert_eq!(program.json("state")["mission"]["holds"], serde_json::json!([]), "no sensor, no silence");
}
