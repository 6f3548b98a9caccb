//! How a container ends and what stands when it is started again: a mission goes on where it was, and nothing moves by itself.

use serde_json::Value;

use crate::engine::{Container, engine, text};
use crate::visitor::{Visitor, phase};

const ON_LOOPBACK: &str = "--publish=127.0.0.1::8080";

/// In the middle of a mission: one piece judged, and another waiting.
fn until_in_a_mission(container: &Container<'_>) -> Value {
    let visitor = Visitor::of(container);
    visitor.post("commands/start", "");
    let first = visitor.until_asked();
    visitor.post(&format!("luggage/{first}/verdict"), r#"{"verdict":"safe"}"#);
    visitor.until_asked();
    visitor.state()
}

/// What was found and said, and how far the mission was.
fn kept(state: &Value) -> Value {
    serde_json::json!([state["mission"]["id"], state["mission"]["phase"], state["luggage"], state["map"]["rows"]])
}

fn held_as_it_was(container: &Container<'_>, before: &Value) {
    let visitor = Visitor::of(container);
    let state = visitor.state();
    assert_eq!(kept(&state), kept(before));
    assert!(state["mission"]["holds"].to_string().contains("restart"), "it waits for a START: {}", state["mission"]);
}

#[test]
fn ended_by_sigterm_or_killed_in_mid_mission_it_stands_as_it_was_when_it_is_started_again() {
    let Some(engine) = engine() else { return };
    let volume = engine.volume();
    let options = [ON_LOOPBACK, &volume.at_data(), "--env=HALLSWEEP__ROBOT__SPEED=10"];
    let container = engine.serve(&options, &["--hall", "airport"]);
    let before = until_in_a_mission(&container);

    // Well within the time after which an engine kills.
    assert_eq!(container.end(&["stop", "--time=8"]), "0");
    assert!(container.logs().contains("SIGTERM"), "{}", container.logs());
    container.start_again();
    held_as_it_was(&container, &before);

    assert_eq!(container.end(&["kill", "--signal=KILL"]), "137");
    container.start_again();
    held_as_it_was(&container, &before);
    let visitor = Visitor::of(&container);
    visitor.post(&format!("luggage/{}/verdict", visitor.until_asked()), r#"{"verdict":"danger"}"#);
    visitor.post("commands/start", "");
    visitor.until("the robot is home", |state| phase(state) == "bombLocated");
}

#[test]
fn a_second_container_on_one_volume_is_refused_with_the_reason() {
    let Some(engine) = engine() else { return };
    let volume = engine.volume();
    let first = engine.serve(&[ON_LOOPBACK, &volume.at_data()], &[]);
    first.until_healthy();
    let second = engine.once(&[&volume.at_data()], &[]);
    assert_eq!(second.status.code(), Some(1));
    assert!(text(&second.stderr).contains("another hallsweep"), "{second:?}");
    first.until_healthy();
}
