//! Commands of the API: accepted with a revision or refused with a reason, and STOP in the middle of other commands.

use crate::program::Program;

#[test]
fn stop_halts_a_moving_robot_and_start_goes_on_with_its_goal() {
    let program = Program::serve("empty-8x8", "4");
    program.command("start").accepted();
    program.until("it moves", |state| state["robot"]["state"] != "stopped" && state["mission"]["goal"].is_object());
    let epoch = program.json("state")["mission"]["epoch"].as_u64().expect("an epoch");
    let revision = program.command("stop").accepted();
    let held = program.until("it stands", |state| state["robot"]["state"] == "stopped");
    assert!(held["revision"].as_u64().expect("a revision") >= revision);
    assert_eq!(held["mission"]["phase"], "exploring", "the phase keeps what there is to resume");
    let holds: Vec<&str> = held["mission"]["holds"].as_array().expect("holds").iter().filter_map(|hold| hold.as_str()).collect();
    assert!(holds.contains(&"operator") && holds.contains(&"awaitingStart"), "{holds:?}");
    assert_eq!(held["robot"]["led"], "blinking", "it keeps blinking through suspensions");

    let outdated = program.post("/api/v1/commands/start", &format!("{{\"epoch\":{epoch}}}")).problem(409);
    assert!(outdated.contains("outdated"), "{outdated}");
    program.command("start").accepted();
    let resumed = program.until("it moves again", |state| state["robot"]["state"] != "stopped");
    assert_eq!(resumed["mission"]["holds"], serde_json::json!([]));
    assert_eq!(resumed["mission"]["goal"], held["mission"]["goal"], "it pursues the goal it had");
}

#[test]
fn the_answer_names_a_revision_whose_state_contains_the_effect() {
    let program = Program::serve("empty-8x8", "1");
    for (command, phase) in [("start", "exploring"), ("backHome", "returningHome")] {
        let revision = program.command(command).accepted();
        let state = program.json("state");
        assert!(state["revision"].as_u64().expect("a revision") >= revision);
        let now = state["mission"]["phase"].as_str().expect("a phase");
        assert!(now == phase || (command == "backHome" && now == "atHome"), "after {command} it is {now}");
    }
}

#[test]
fn too_hot_stops_everything_and_a_start_before_the_ok_is_not_remembered() {
    let program = Program::serve("empty-8x8", "4");
    program.command("start").accepted();
    program.put("/api/v1/temperature", "{\"status\":\"tooHigh\"}").accepted();
    let held = program.until("it stands", |state| state["robot"]["state"] == "stopped");
    assert_eq!(held["temperature"]["status"], "tooHigh");
    assert!(program.command("start").problem(409).contains("temperature"));
    program.put("/api/v1/temperature", "{\"status\":\"ok\"}").accepted();
    let state = program.json("state");
    assert_eq!(state["mission"]["holds"], serde_json::json!(["awaitingStart"]), "the end of the cause sets nothing moving");
    program.command("start").accepted();
    program.until("it moves", |state| state["robot"]["state"] != "stopped");
}

#[test]
fn a_reading_above_the_threshold_holds_until_it_is_a_degree_below() {
    let program = Program::serve("empty-8x8", "1");
    let read = |celsius: f64| program.put("/api/v1/temperature", &format!("{{\"celsius\":{celsius}}}")).accepted();
    let status = || program.json("state")["temperature"]["status"].clone();
    read(25.0);
    assert_eq!(status(), "ok");
    read(25.1);
    assert_eq!(status(), "tooHigh");
    assert!(program.command("start").problem(409).contains("threshold"));
    read(24.5);
    assert_eq!(status(), "tooHigh");
    read(24.0);
    assert_eq!(status(), "ok");
    program.command("start").accepted();
}

#[test]
fn the_robot_is_driven_by_hand_and_goes_to_a_cell() {
    let program = Program::serve("empty-8x8", "max");
    program.post("/api/v1/commands/move", "{\"move\":\"a\"}").accepted();
    program.until("it has turned", |state| state["robot"]["heading"] == "east" && state["mission"]["phase"] == "idle");
    program.post("/api/v1/commands/move", "{\"move\":\"w\"}").accepted();
    program.until("it has moved", |state| state["robot"]["position"]["x"] == 1 && state["mission"]["phase"] == "idle");
    program.post("/api/v1/commands/goto", "{\"x\":3,\"y\":5}").accepted();
    program.until("it is there", |state| {
        state["robot"]["position"] == serde_json::json!({"x": 3, "y": 5}) && state["mission"]["phase"] == "idle"
    });
    let log = program.json("state")["log"].as_array().expect("a log").len();
    assert!(log > 0, "what happened is in the log");
}

#[test]
fn what_the_phase_has_no_use_for_is_refused_in_words() {
    let program = Program::serve("empty-8x8", "max");
    assert!(program.command("backHome").problem(409).contains("idle"));
    program.command("retrieve").problem(409);
    program.post("/api/v1/alarms/7/acknowledge", "").problem(404);
    assert!(program.verdict(99, "safe").problem(404).contains("#99"));
    let retake = program.press("/api/v1/luggage/99/photo");
    assert!([404, 409].contains(&retake.status), "{}", retake.text());
    retake.problem(retake.status);
    program.put("/api/v1/strategy", "{\"name\":\"snail\"}").accepted();
    program.command("stop").accepted();
    program.command("reset").accepted();
}

#[test]
fn after_reset_the_hall_is_searched_anew() {
    let program = Program::serve("empty-8x8", "max");
    program.command("start").accepted();
    let first = program.until_phase("explored")["mission"]["id"].as_u64().expect("a mission");
    program.command("reset").accepted();
    let state = program.json("state");
    assert_eq!((&state["mission"]["phase"], &state["mission"]["progress"]["visited"]), (&"idle".into(), &1.into()));
    program.command("start").accepted();
    assert!(program.until_phase("explored")["mission"]["id"].as_u64().expect("a mission") > first);
}
