//! Missions that were put away stay readable through the API and on the console's pages, and read the same after a
//! restart.

use serde_json::Value;

use crate::kill::Folder;
use crate::program::{Program, hallsweep};

/// Starts the program with this data folder.
fn serve(folder: &Folder) -> Program {
    let arguments =
        ["serve", "--http", "127.0.0.1:0", "--seed", "1", "--hall", "airport", "--speed", "max", "--data", folder.text()];
    Program::started(hallsweep(&arguments).env_remove("HALLSWEEP__STORE__FOLDER"))
}

/// Finds a bomb, leaves the bomb in place, puts the mission away and starts another one. Returns the state before the
/// mission was put away.
fn a_mission_and_the_next(program: &Program) -> Value {
    program.command("start").accepted();
    let first = program.until_asked();
    program.verdict(first, "safe").accepted();
    let second = program.until_asked();
    program.verdict(second, "danger").accepted();
    let state = program.until_phase("bombLocated");
    assert_eq!(program.command("reset").status, 409, "the alarm must be acknowledged first");
    for alarm in state["alarms"].as_array().expect("a list") {
        program.press(&format!("/api/v1/alarms/{}/acknowledge", alarm["id"])).accepted();
    }
    program.command("reset").accepted();
    program.command("start").accepted();
    program.until_asked();
    state
}

/// Fails unless the API shows the first mission as it was seen.
fn check(program: &Program, seen: &Value) {
    let list = program.json("missions");
    let ids: Vec<u64> =
        list["missions"].as_array().expect("a list").iter().filter_map(|mission| mission["id"].as_u64()).collect();
    assert_eq!((ids, &list["next"]), (vec![2, 1], &Value::Null));
    assert_eq!(list["missions"][0]["archived"], Value::Null, "the second is under way");

    let mission = program.json("missions/1");
    let bomb = &seen["luggage"][1]["id"];
    assert_eq!((&mission["phase"], &mission["pieces"], &mission["dangerous"]), (&"bombLocated".into(), &2.into(), &1.into()));
    assert_eq!(mission["left"], serde_json::json!([bomb]));
    assert_eq!(mission["luggage"], seen["luggage"]);
    assert_eq!(mission["map"]["rows"], seen["map"]["rows"]);
    assert_eq!(program.json("missions/1/map"), mission["map"]);
    let photo = mission["luggage"][0]["photo"]["url"].as_str().expect("it was photographed");
    let photo = program.read(photo, &[]);
    assert_eq!((photo.status, photo.header("content-type")), (200, "image/png"));
    assert!(program.read("/api/v1/missions/3", &[]).problem(404).contains("no mission 3"));
}

/// Commands among the events of a mission, in order, read in small pages.
fn commands(program: &Program, mission: u64) -> Vec<Value> {
    let (mut next, mut commands, mut last) = (Some(format!("/api/v1/missions/{mission}/events?limit=37")), Vec::new(), 0);
    while let Some(path) = next {
        let page = program.read(&path, &[]).json();
        for event in page["events"].as_array().expect("a list") {
            let seq = event["seq"].as_u64().expect("a number");
            assert!(seq > last, "oldest first, each once: {seq} after {last}");
            last = seq;
            if event["kind"] == "command" {
                commands.push(event.clone());
            }
        }
        next = page["next"].as_str().map(str::to_owned);
    }
    commands
}

/// Safety A6.
fn check_audit(program: &Program) {
    let commands = commands(program, 1);
    let words: Vec<(&str, bool)> =
        commands.iter().filter_map(|event| Some((event["command"].as_str()?, event["refused"].is_null()))).collect();
    assert_eq!(words[0], ("START", true));
    assert!(words.contains(&("RESET", false)), "also a refused one: {words:?}");
    for event in &commands {
        assert_eq!((&event["door"], &event["who"], &event["from"]), (&"http".into(), &"operator".into(), &"127.0.0.1".into()));
    }
    let page = program.read("/missions/1?show=commands", &[("accept", "text/html")]).text();
    assert!(page.contains("by operator (http, 127.0.0.1)") && page.contains("refused: "), "{page}");
}

#[test]
fn missions_are_read_back_while_the_program_runs_although_nothing_is_kept() {
    let program = Program::serve("airport", "max");
    let seen = a_mission_and_the_next(&program);
    check(&program, &seen);
    check_audit(&program);
}

#[test]
fn missions_are_read_back_after_a_restart() {
    let folder = Folder::new("missions");
    let program = serve(&folder);
    let seen = a_mission_and_the_next(&program);
    check(&program, &seen);
    program.signal("KILL");
    drop(program);
    let program = serve(&folder);
    check(&program, &seen);
    check_audit(&program);
    for at in ["", "?at=9007199254740991"] {
        let end = program.json(&format!("missions/1/moment{at}"));
        assert_eq!((&end["luggage"], &end["map"]["rows"]), (&seen["luggage"], &seen["map"]["rows"]), "RESET emptied the hall");
    }
    let page = program.read("/missions", &[("accept", "text/html")]).text();
    assert!(page.contains("A bomb was located; luggage #2 was left in place") && page.contains("Under way: "), "{page}");
    let state = program.json("state");
    assert!(state["mission"]["holds"].as_array().is_some_and(|holds| holds.iter().any(|hold| hold == "restart")));
    assert!(program.read("/", &[]).text().contains("everything is as it was"));
}

/// Safety V2: a piece whose photo is lost cannot be called safe.
#[test]
fn a_pending_piece_whose_photo_was_lost_is_photographed_again_before_it_can_be_called_safe() {
    let folder = Folder::new("lost-photo");
    let program = serve(&folder);
    program.command("start").accepted();
    let piece = program.until_asked();
    program.signal("KILL");
    drop(program);
    std::fs::remove_dir_all(folder.path().join("photos")).expect("the photos are there");

    let program = serve(&folder);
    let state = program.json("state");
    assert_eq!(state["luggage"][0]["photo"]["state"], "failed", "{state:#}");
    assert!(program.verdict(piece, "safe").problem(409).contains("no usable photo"));
    program.press(&format!("/api/v1/luggage/{piece}/photo")).accepted();
    program.until("a new photo", |state| state["luggage"][0]["photo"]["state"] == "taken");
    program.verdict(piece, "safe").accepted();
}
