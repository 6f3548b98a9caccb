//! Robots of the line protocol: the program and the emulator as two processes, over TCP and over a pair of
//! pseudo-terminals that lose and garble bytes. The effects of a bad wire on the driver and the robot are tested
//! beside them, with many seeds.

mod cable;
mod floods;
mod paced;
mod terminals;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::Duration;

use hallsweep_drivers::line::{LineReader, framed};
use serde_json::Value;

use crate::program::{PATIENCE, Program, hallsweep};
use cable::Cable;
use paced::{PHOTO, PacedRobot, Seen};
use terminals::Terminals;

/// A robot that the emulator plays in its own process.
pub(crate) struct Emulator {
    pub(crate) child: Child,
    /// Address that the emulator has printed.
    pub(crate) place: String,
    // Stays open until the process ends, so that the emulator's writes never fail.
    _said: BufReader<ChildStdout>,
}

impl Emulator {
    fn with(arguments: &[&str]) -> Emulator {
        Emulator::started(&mut hallsweep(&[&["robot-emulator"], arguments].concat()))
    }

    /// Starts this command and waits until it prints its address.
    pub(crate) fn started(command: &mut Command) -> Emulator {
        let mut child = command.stdout(Stdio::piped()).spawn().expect("the emulator starts");
        let mut said = BufReader::new(child.stdout.take().expect("standard output is a pipe"));
        let mut line = String::new();
        said.read_line(&mut line).expect("the emulator says where it is");
        let place = line.trim_end().rsplit("line=").next().expect("it says how it is reached").to_owned();
        Emulator { child, place, _said: said }
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // The process may have ended already, which is fine.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn serve(place: &str) -> Program {
    let program = Program::with(&["serve", "--http", "127.0.0.1:0", "--robot", &format!("line={place}")]);
    program.until("the robot is linked", |state| !has(state, "robotLink") && !state["robots"][0]["parts"].is_null());
    program
}

fn has(state: &Value, hold: &str) -> bool {
    state["mission"]["holds"].as_array().expect("the state says what holds the robot").iter().any(|name| name == hold)
}

/// Sends START whenever the mission waits for START, and calls every piece safe, until the hall is explored.
fn explore(program: &Program) -> Value {
    program.command("start").accepted();
    loop {
        let state = program.until("the mission has ended, or waits for somebody", |state| {
            state["mission"]["phase"] == "explored" || has(state, "awaitingStart") || undecided(state).is_some()
        });
        if state["mission"]["phase"] == "explored" {
            return state;
        }
        if has(&state, "awaitingStart") {
            // The program refuses START until the robot is linked again.
            program.command("start");
        }
        if let Some(piece) = undecided(&state) {
            program.verdict(piece, "safe").accepted();
        }
    }
}

/// Number of a piece without a verdict.
fn undecided(state: &Value) -> Option<u64> {
    let mut pieces = state["luggage"].as_array().expect("a list").iter();
    pieces.find(|piece| piece["verdict"] == "pending")?["id"].as_u64()
}

fn visited(state: &Value) -> u64 {
    state["mission"]["progress"]["visited"].as_u64().expect("a number")
}

#[test]
fn two_processes_run_a_whole_mission_with_its_photos_over_tcp() {
    let emulator = Emulator::with(&["--listen", "127.0.0.1:0", "--hall", "airport", "--speed", "100", "--photo-bytes", "100000"]);
    let program = serve(&emulator.place);
    let state = explore(&program);
    let own = Program::serve("airport", "max");
    assert_eq!(visited(&state), visited(&explore(&own)), "as many cells as the simulated robot itself");
    let photo = program.read("/api/v1/luggage/1/photo", &[]);
    assert_eq!((photo.status, photo.header("content-type"), photo.body.len()), (200, "image/png", 100_000));
}

#[test]
fn over_pseudo_terminals_that_lose_and_garble_bytes_a_whole_mission_is_run() {
    let terminals = Terminals::joined(7, 0.03);
    let _emulator = Emulator::with(&["--serial", &terminals.robot, "--hall", "empty-8x8", "--speed", "20"]);
    let program = serve(&terminals.program);
    let state = explore(&program);
    assert_eq!((visited(&state), &state["robot"]["offCentre"]), (64, &false.into()));
}

#[test]
fn while_nothing_moves_another_robot_takes_the_place_of_one_and_the_mission_goes_on_with_its_map() {
    let first = Emulator::with(&["--listen", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "20", "--name", "ada"]);
    let place = first.place.clone();
    let program = serve(&place);
    program.command("start").accepted();
    program.until("some of the hall is known", |state| visited(state) > 10);
    program.command("stop").accepted();
    drop(first);
    let gone = program.until("the robot is gone", |state| has(state, "robotLink"));
    let why = gone["robots"][0]["unreached"].as_str().expect("why it cannot be reached").to_owned();
    assert!(why.contains(&place), "{why}");
    assert!(program.read("/", &[]).text().contains("<dt>No link</dt>"), "the console says it as well");
    let before = visited(&gone);
    let _second = Emulator::with(&["--listen", &place, "--hall", "empty-8x8", "--speed", "20", "--name", "bob"]);
    let state = program.until("the other is there", |state| !has(state, "robotLink"));
    assert_eq!(state["robots"][0]["unreached"], Value::Null);
    assert_eq!(
        (visited(&state), &state["robot"]["position"]["x"], &state["robot"]["position"]["y"]),
        (before, &0.into(), &0.into())
    );
    assert_eq!(state["robot"]["state"], "stopped", "nothing moves before a START");
    assert_eq!(visited(&explore(&program)), 64);
}

/// Safety S1. The photo would take 100 s. The rest of the photo must arrive after the robot was told to halt.
#[test]
fn a_stop_reaches_the_robot_in_the_middle_of_a_photo_and_the_photo_is_kept() {
    let robot = PacedRobot::listening(1_000, true);
    let seen = || robot.seen.recv_timeout(PATIENCE).expect("more comes over the wire").0;
    let program = serve(&robot.place);
    program.command("start").accepted();
    while seen() != Seen::PhotoBegins {}
    program.command("stop").accepted();
    assert_eq!(seen(), Seen::Halt, "the photo is not over");
    robot.pace(100_000_000);
    while seen() != Seen::PhotoOver {}
    let piece = program.until_asked();
    let photo = program.read(&format!("/api/v1/luggage/{piece}/photo"), &[]);
    assert_eq!((photo.status, photo.body.len()), (200, PHOTO));
}

/// Safety S5.
#[test]
fn a_robot_that_is_not_told_that_its_program_was_killed_halts_by_itself() {
    let emulator = Emulator::with(&["--listen", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "0.1"]);
    let cable = Cable::to(&emulator.place);
    let program = moving(&cable);
    program.killer()();
    halts_by_itself(&cable, &emulator);
}

/// Safety S5.
#[test]
fn a_robot_whose_cable_is_pulled_halts_by_itself_and_the_mission_is_held() {
    let emulator = Emulator::with(&["--listen", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "0.1"]);
    let cable = Cable::to(&emulator.place);
    let program = moving(&cable);
    cable.pull();
    halts_by_itself(&cable, &emulator);
    program.until("the mission is held", |state| has(state, "robotLink") && has(state, "awaitingStart"));
}

/// Starts a program and waits until its robot has been told to move.
fn moving(cable: &Cable) -> Program {
    let program = serve(&cable.place);
    program.command("start").accepted();
    cable.until(&["w", "a", "d"]);
    program
}

/// Fails unless the robot halts before another client connects to its port, and then reports the cell in which it
/// was.
fn halts_by_itself(cable: &Cable, emulator: &Emulator) {
    let halted = cable.until(&["done", "halted", "failed"]);
    assert!(halted.starts_with("halted ") && halted.ends_with(" off"), "{halted}");
    let mut wire = TcpStream::connect(&emulator.place).expect("the robot listens");
    wire.set_read_timeout(Some(PATIENCE)).expect("it is a socket");
    wire.write_all(&framed("hello")).expect("the robot hears");
    let hello = line(&mut wire, "hello ");
    assert!(hello.contains("at=0,0,south off last="), "{hello}");
}

/// Safety S5.
#[test]
fn a_robot_whose_program_is_killed_halts_by_itself() {
    let emulator = Emulator::with(&["--listen", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "0.1"]);
    let program = serve(&emulator.place);
    program.command("start").accepted();
    program.until("it moves", |state| state["robot"]["state"] != "stopped");
    program.killer()();
    // In this time an undisturbed step would have ended. The test must wait, because a new connection halts the robot
    // as well.
    std::thread::sleep(Duration::from_secs(5));
    let mut wire = TcpStream::connect(&emulator.place).expect("the robot listens");
    wire.set_read_timeout(Some(PATIENCE)).expect("it is a socket");
    wire.write_all(&framed("hello")).expect("the robot hears");
    let hello = line(&mut wire, "hello ");
    assert!(hello.contains("at=0,0,south off last="), "{hello}");
}

/// Next line that starts with this text.
fn line(wire: &mut TcpStream, begins: &str) -> String {
    let mut reader = LineReader::default();
    BufReader::new(wire)
        .bytes()
        .find_map(|byte| reader.take(byte.expect("the robot answers")).filter(|text| text.starts_with(begins)))
        .expect("the robot answers")
}
