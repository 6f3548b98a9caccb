//! The core of a mission: the robot finds luggage, the operator decides, and the robot acts on the verdict.

use crate::program::Program;

#[test]
fn one_bag_is_safe_the_next_is_dangerous_and_the_robot_comes_home() {
    let program = Program::serve("airport", "max");
    program.command("start").accepted();
    let first = program.until_asked();
    assert!(program.command("start").problem(409).contains(&format!("#{first}")), "it waits for the verdict");
    program.verdict(first, "safe").accepted();
    let second = program.until_asked();
    assert!(second > first);
    program.verdict(second, "danger").accepted();

    let state = program.until_phase("bombLocated");
    assert_eq!(state["robot"]["position"], serde_json::json!({"x": 0, "y": 0}));
    assert_eq!((&state["robot"]["led"], &state["robot"]["state"]), (&"off".into(), &"stopped".into()));
    let verdicts: Vec<&str> = state["luggage"].as_array().expect("a list").iter().filter_map(|l| l["verdict"].as_str()).collect();
    assert_eq!(verdicts, ["safe", "danger"], "the cells still unknown were not visited");
    let alarm = state["alarms"].as_array().expect("a list").iter().find(|alarm| alarm["luggage"] == second);
    let alarm = alarm.expect("the operator is alerted")["id"].as_u64().expect("a number");

    assert!(program.command("start").problem(409).contains("bomb"));
    assert!(program.command("reset").problem(409).contains("acknowledge"));
    program.press(&format!("/api/v1/alarms/{alarm}/acknowledge")).accepted();
    program.command("reset").accepted();
    assert_eq!(program.json("state")["mission"]["phase"], "idle");
}

#[test]
fn a_verdict_is_final_an_equal_repeat_is_harmless_and_the_record_comes_with_both() {
    let program = Program::serve("airport", "max");
    program.command("start").accepted();
    let id = program.until_asked();
    assert!(program.verdict(id + 1, "safe").problem(404).contains(&format!("#{}", id + 1)));
    program.verdict(id, "safe").accepted();
    let repeat = program.verdict(id, "safe");
    repeat.accepted();
    assert_eq!((&repeat.json()["luggage"]["id"], &repeat.json()["luggage"]["verdict"]), (&id.into(), &"safe".into()));
    let other = program.verdict(id, "danger");
    assert!(other.problem(409).contains("final"));
    assert_eq!(other.json()["luggage"]["verdict"], "safe");
    let record = program.json(&format!("luggage/{id}"));
    assert!(record["decided"]["at"].is_string() && record["decided"]["by"].is_string(), "who decided and when: {record}");
}

#[test]
fn a_photo_is_taken_again_and_is_then_another() {
    let program = Program::serve("airport", "max");
    program.command("start").accepted();
    let id = program.until_asked();
    let before = program.read(&format!("/api/v1/luggage/{id}/photo"), &[]);
    program.press(&format!("/api/v1/luggage/{id}/photo")).accepted();
    let taken = |state: &serde_json::Value| state["luggage"][0]["photo"]["take"] == 2;
    program.until("the second photo is there", taken);
    let after = program.read(&format!("/api/v1/luggage/{id}/photo"), &[("if-none-match", before.header("etag"))]);
    assert_eq!((after.status, after.header("content-type")), (200, "image/png"), "the old tag does not name the new photo");
    let take = |number: u32| program.read(&format!("/api/v1/luggage/{id}/photo?take={number}"), &[]);
    assert!(take(1).body == before.body && take(2).body == after.body, "the first can still be looked at");
    assert_ne!(take(1).header("etag"), take(2).header("etag"));
    assert!(take(3).problem(404).contains("the numbers 1 to 2"));
    program.verdict(id, "safe").accepted();
}

#[test]
fn every_bag_safe_means_the_hall_is_explored() {
    let program = Program::serve("seed", "max");
    program.command("start").accepted();
    loop {
        let state = program.until("a verdict is asked for, or all is explored", |state| {
            state["mission"]["phase"] == "explored"
                || state["luggage"].as_array().is_some_and(|all| all.iter().any(|piece| piece["verdict"] == "pending"))
        });
        if state["mission"]["phase"] == "explored" {
            break;
        }
        program.verdict(program.until_asked(), "safe").accepted();
    }
    let state = program.json("state");
    assert_eq!(state["luggage"].as_array().expect("a list").len(), 3, "one in the middle, one at a wall, one in a corner");
    assert_eq!(state["robot"]["position"], serde_json::json!({"x": 0, "y": 0}));
    assert_eq!(state["robot"]["led"], "off");
}

#[test]
fn a_verdict_under_a_hold_is_recorded_and_moves_nothing() {
    let program = Program::serve("airport", "max");
    program.command("start").accepted();
    let id = program.until_asked();
    program.command("stop").accepted();
    program.verdict(id, "safe").accepted();
    let state = program.json("state");
    assert_eq!((&state["robot"]["state"], &state["luggage"][0]["verdict"]), (&"stopped".into(), &"safe".into()));
    assert_ne!(state["mission"]["holds"], serde_json::json!([]));
    program.command("start").accepted();
    assert!(program.until_asked() > id, "the search goes on");
}
