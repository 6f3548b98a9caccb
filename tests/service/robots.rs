//! Two simulated robots from the settings: both are linked, one STOP holds both, and each restarts where it was.

use std::fs;

use serde_json::{Value, json};

use crate::kill::Folder;
use crate::program::{Program, hallsweep};

/// File in which the second robot stores its state.
const PORTERS: &str = "simulated-robot-porter.txt";

/// Starts the program with a robot `porter` beside the searching robot.
fn serve(folder: &Folder) -> Program {
    let arguments = ["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "20", "--data", folder.text()];
    let mut command = hallsweep(&arguments);
    command.env("HALLSWEEP__ROBOTS__PORTER__KIND", "sim").env("HALLSWEEP__ROBOTS__PORTER__SPEED", "20");
    command.env("HALLSWEEP__MISSION__RETRIEVAL", "none");
    Program::started(&mut command)
}

fn robots(state: &Value) -> &[Value] {
    state["robots"].as_array().expect("the state lists the robots")
}

fn has(robot: &Value, hold: &str) -> bool {
    robot["holds"].as_array().expect("a robot says what holds it").iter().any(|name| name == hold)
}

fn both_linked(state: &Value) -> bool {
    robots(state).iter().all(|robot| !robot["parts"].is_null() && !has(robot, "robotLink"))
}

/// Position and heading of a robot.
fn place(robot: &Value) -> Value {
    json!([robot["position"], robot["heading"], robot["offCentre"]])
}

/// Moves the searching robot to another cell and stops it. Returns the state in which all robots stand.
fn drive_on(program: &Program) -> Value {
    let before = program.json("state")["robot"]["position"].clone();
    program.command("start").accepted();
    program.until("it has driven on", |state| state["robot"]["position"] != before);
    program.command("stop").accepted();
    program.until("all stand", |state| {
        robots(state).iter().all(|robot| has(robot, "operator") && robot["state"] == "stopped" && robot["halting"] == false)
    })
}

fn kill(program: Program) {
    program.killer()();
    drop(program);
}

#[test]
fn two_robots_are_shown_stop_together_and_are_found_where_they_were() {
    let folder = Folder::new("robots");
    let program = serve(&folder);
    let state = program.until("both are linked", both_linked);
    let named: Vec<_> = robots(&state).iter().map(|robot| (&robot["name"], &robot["searches"])).collect();
    assert_eq!(named, [(&"discovery".into(), &true.into()), (&"porter".into(), &false.into())]);
    assert!(robots(&state).iter().all(|robot| robot["parts"][0] == "base" && !has(robot, "operator")), "{state:#}");
    let state = drive_on(&program);
    let at_home = json!([{"x": 0, "y": 0}, "south", false]);
    assert_eq!(place(&robots(&state)[1]), at_home, "nobody has told the other to move");
    let left = place(&state["robot"]);
    assert_ne!(left, at_home);
    kill(program);

    // The porter gets the position of the searching robot, as if somebody had driven it there.
    fs::copy(folder.path().join("simulated-robot.txt"), folder.path().join(PORTERS)).expect("it is remembered");
    let program = serve(&folder);
    let state = program.until("both are linked", both_linked);
    assert_eq!(robots(&state).iter().map(place).collect::<Vec<_>>(), [left.clone(), left.clone()]);
    assert!(robots(&state).iter().all(|robot| has(robot, "operator")), "the STOP outlives the program: {state:#}");
    let state = drive_on(&program);
    let [first, second] = [0, 1].map(|number| place(&robots(&state)[number]));
    assert!(first != left && second == left, "{state:#}");
    kill(program);

    let state = serve(&folder).until("both are linked", both_linked);
    assert_eq!(robots(&state).iter().map(place).collect::<Vec<_>>(), [first, second]);
}

/// Safety R5.
#[test]
fn a_robot_that_may_be_anywhere_is_not_there_and_holds_the_others() {
    let folder = Folder::new("robots-lost");
    fs::write(folder.path().join(PORTERS), "not ours").expect("the folder is ours");
    let program = serve(&folder);
    let state = program.until("the first is linked", |state| !state["robots"][0]["parts"].is_null());
    assert!(state["mission"]["storeFailure"].as_str().is_some_and(|words| words.contains(PORTERS)), "{state:#}");
    let [first, second] = [0, 1].map(|number| &robots(&state)[number]);
    assert!(has(first, "store") && !has(first, "robotLink"), "{state:#}");
    assert!(has(second, "store") && has(second, "robotLink") && second["parts"].is_null(), "{state:#}");
    assert!(program.command("start").problem(409).contains(PORTERS), "START says which file");
}
