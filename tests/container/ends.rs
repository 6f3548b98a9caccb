//! The end of a container and its next start: a mission continues where it was, and nothing moves by itself.

use serde_json::Value;

use crate::client::{Client, kept, phase};
use crate::engine::{Container, ON_LOOPBACK, engine};

/// Runs a mission until one piece is judged and another waits.
fn until_in_a_mission(container: &Container<'_>) -> Value {
    let client = Client::of(container);
    client.post("commands/start", "");
    let first = client.until_asked();
    client.post(&format!("luggage/{first}/verdict"), r#"{"verdict":"safe"}"#);
    client.until_asked();
    client.state()
}

fn held_as_it_was(container: &Container<'_>, before: &Value) {
    let client = Client::of(container);
    let state = client.state();
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

    // An event stream is open, and the time limit is shorter than the engine's default of ten seconds.
    let mut events = Client::of(&container).events();
    assert_eq!(container.end(&["stop", "--time=8"]), "0");
    // The stream has ended; the kind of its end does not matter.
    let _ = std::io::copy(&mut events, &mut std::io::sink());
    assert!(container.logs().contains("SIGTERM"), "{}", container.logs());
    container.start_again();
    held_as_it_was(&container, &before);

    assert_eq!(container.end(&["kill", "--signal=KILL"]), "137");
    container.start_again();
    held_as_it_was(&container, &before);
    let client = Client::of(&container);
    client.post(&format!("luggage/{}/verdict", client.until_asked()), r#"{"verdict":"danger"}"#);
    client.post("commands/start", "");
    client.until("the robot is home", |state| phase(state) == "bombLocated");
}

#[test]
fn a_second_container_on_one_volume_is_refused_with_the_reason() {
    let Some(engine) = engine() else { return };
    let volume = engine.volume();
    let first = engine.serve(&[ON_LOOPBACK, &volume.at_data()], &[]);
    first.until_healthy();
    let (code, said) = engine.once(&engine.image, &[&volume.at_data()], &[]);
    assert!(code == "1" && said.contains("another hallsweep"), "{code}: {said}");
    first.until_healthy();
}
