//! Retrieval, from the verdict *danger* to the bag in the container, with the default settings: each interface can
//! send the pair out, after STOP and `kill -9` the pair stays where it is, and only an operator's START moves it
//! again.

use serde_json::Value;

use crate::coap::client::Coap;
use crate::kill::Folder;
use crate::program::{Program, hallsweep};

/// Starts the program in the hall of the seed with this data folder.
fn serve(folder: &Folder, speed: &str, settings: &[(&str, &str)]) -> Program {
    let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0", "--hall", "seed", "--speed", speed, "--data", folder.text()]);
    Program::started(command.envs(settings.iter().copied()))
}

/// Calls the first piece dangerous and waits until the searching robot is home. Returns the number of the piece.
fn locate(program: &Program) -> u64 {
    program.until("all are linked", |state| holds(state).is_empty());
    program.command("start").accepted();
    let piece = program.until_asked();
    program.verdict(piece, "danger").accepted();
    program.until_phase("bombLocated");
    piece
}

/// Starts the program and sends the pair to the dangerous piece. Returns the program and the number of the piece.
fn fetching(folder: &Folder, speed: &str, settings: &[(&str, &str)]) -> (Program, u64) {
    let program = serve(folder, speed, settings);
    let piece = locate(&program);
    program.command("retrieve").accepted();
    (program, piece)
}

fn holds(state: &Value) -> &[Value] {
    state["mission"]["holds"].as_array().expect("a mission says what holds it")
}

fn is_held(state: &Value, hold: &str) -> bool {
    holds(state).iter().any(|it| it == hold)
}

fn alarms(state: &Value) -> &[Value] {
    state["alarms"].as_array().expect("the state lists the alarms")
}

/// The robots of the pair, in order.
fn pair(state: &Value) -> Vec<&Value> {
    let robots = state["robots"].as_array().expect("the state lists the robots");
    ["srm1", "srm2"].iter().map(|name| robots.iter().find(|robot| robot["name"] == *name).expect("it is there")).collect()
}

/// Positions of the pair and the state of its grippers. The quality of the grip is left out, because the controllers
/// keep adjusting it during a halt.
fn places(state: &Value) -> Vec<Value> {
    let told = ["/position", "/outside", "/heading", "/arm/gripper", "/arm/holds", "/arm/lifted"];
    pair(state).iter().map(|robot| told.iter().map(|key| robot.pointer(key).cloned()).collect()).collect()
}

fn carries(state: &Value) -> bool {
    pair(state).iter().all(|robot| robot["arm"]["lifted"] == true)
}

fn secured(program: &Program, piece: u64) {
    program.until_phase("bagSecured");
    let record = program.json(&format!("luggage/{piece}"));
    assert!(record["secured"].is_string(), "when it was put into the container: {record}");
    assert!(pair(&program.json("state")).iter().all(|robot| robot["outside"] == true));
}

#[test]
fn the_pair_brings_the_dangerous_bag_and_the_old_console_goes_on_to_a_new_search() {
    let program = Program::serve("seed", "max");
    let piece = locate(&program);
    program.command("retrieve").accepted();
    secured(&program, piece);
    assert!(program.command("retrieve").problem(409).contains("not possible while"));
    program.press("/startappl").accepted();
    program.until("a new mission", |state| state["mission"]["id"] == 2);
}

#[test]
fn coap_sends_the_pair_too() {
    let program = Program::serve("seed", "max");
    let piece = locate(&program);
    let reply = Coap::at(program.coap()).ask("POST", "commands/retrieve", "").expect("the door answers");
    assert_eq!(reply.code, "2.04", "{reply:?}");
    secured(&program, piece);
}

#[test]
fn discovery_fetches_the_bag_itself_where_the_settings_say_so() {
    let folder = Folder::new("discovery");
    let (program, piece) = fetching(&folder, "max", &[("HALLSWEEP__MISSION__RETRIEVAL", "discovery")]);
    let state = program.until_phase("bagSecured");
    assert_eq!(state["robots"].as_array().map(Vec::len), Some(1), "nobody else is there");
    assert!(program.json(&format!("luggage/{piece}"))["secured"].is_string());
    assert_eq!((&state["robot"]["position"]["x"], &state["robot"]["outside"]), (&0.into(), &false.into()), "it is home again");
}

#[test]
fn where_nobody_fetches_a_person_does_and_retrieve_says_so() {
    let folder = Folder::new("nobody");
    let program = serve(&folder, "max", &[("HALLSWEEP__MISSION__RETRIEVAL", "none")]);
    locate(&program);
    assert!(program.command("retrieve").problem(409).contains("no retrieval robot"));
    assert_eq!(program.json("state")["mission"]["phase"], "bombLocated");
}

#[test]
fn stop_and_kill_leave_pair_and_parcel_where_they_are_until_start() {
    let folder = Folder::new("carried");
    let (program, piece) = fetching(&folder, "20", &[]);
    program.until("the bag is lifted", carries);
    program.command("stop").accepted();
    let stands = |state: &Value| pair(state).iter().all(|robot| robot["state"] == "stopped" && robot["halting"] == false);
    let stopped = program.until("the pair stands", stands);
    assert!(is_held(&stopped, "operator") && carries(&stopped), "{stopped:#}");
    program.command("start").accepted();
    program.until("it goes on", |state| !stands(state));
    program.killer()();
    drop(program);

    let program = serve(&folder, "max", &[]);
    let found = program.until("all are linked", |state| !is_held(state, "robotLink"));
    assert!(is_held(&found, "restart") && carries(&found), "the parcel is in the grip: {found:#}");
    std::thread::sleep(std::time::Duration::from_secs(1));
    assert_eq!(places(&program.json("state")), places(&found), "nothing moves before START");
    program.command("start").accepted();
    secured(&program, piece);
}

#[test]
fn a_lost_parcel_calls_the_operator_who_acknowledges_and_starts() {
    let folder = Folder::new("lost");
    let (program, piece) = fetching(&folder, "max", &[("HALLSWEEP__PAIR__SLIPS", "1")]);
    let is_call = |alarm: &&Value| alarm["id"].is_u64() && alarm["text"].as_str().is_some_and(|text| text.contains("lost"));
    let state = program.until("the pair's call, on record", |state| alarms(state).iter().any(|alarm| is_call(&alarm)));
    assert!(is_held(&state, "alarm"), "{state:#}");
    let words = program.command("start").problem(409);
    assert!(words.contains("acknowledge"), "{words}");
    let call = alarms(&state).iter().find(is_call).expect("the pair's call");
    program.press(&format!("/api/v1/alarms/{}/acknowledge", call["id"])).accepted();
    let held = program.until("it waits for START", |state| !is_held(state, "alarm"));
    assert!(!holds(&held).is_empty(), "acknowledging alone moves nothing: {held:#}");
    program.command("start").accepted();
    secured(&program, piece);
}

#[test]
fn a_bag_in_the_container_stays_there_though_the_settings_name_nobody_who_fetches_any_more() {
    let folder = Folder::new("kept");
    let (program, bomb) = fetching(&folder, "max", &[]);
    secured(&program, bomb);
    drop(program);

    let program = serve(&folder, "max", &[("HALLSWEEP__MISSION__RETRIEVAL", "none")]);
    program.until("it is linked", |state| !is_held(state, "robotLink"));
    program.command("start").accepted();
    program.until("a new mission", |state| state["mission"]["id"] == 2);
    for _ in 0..2 {
        program.verdict(program.until_asked(), "safe").accepted();
    }
    let state = program.until_phase("explored");
    assert_eq!(state["luggage"].as_array().map(Vec::len), Some(2), "the third is in the container: {state:#}");
}
