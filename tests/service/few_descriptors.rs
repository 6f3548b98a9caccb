//! A program with a low limit of open files and connections: during a crowd at any interface a STOP still works at
//! every interface, the program survives, and it works normally after the crowd has gone.

use std::io::Write;
use std::net::{SocketAddr, TcpStream};
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use hallsweep::app::raise_descriptors;
use serde_json::Value;

use crate::coap::client::Coap;
use crate::http_attacks::{connected, status, stop};
use crate::mqtt_attacks::client::Client;
use crate::mqtt_attacks::packets::{PUBACK, connect, publish};
use crate::program::{Deadline, PATIENCE, Program, hallsweep};

/// Limit of descriptors of the program. HTTP or MQTT alone normally accepts at least this many connections.
const DESCRIPTORS: &str = "256";

/// Connections in each crowd.
const CROWD: usize = 400;

/// Number of rounds in which each interface gets one STOP, from a new client, during the crowd.
const STOPS: u64 = 10;

/// Interval between two checks whether a STOP has halted.
const GLANCE: Duration = Duration::from_millis(5);

fn program() -> Program {
    let whole = hallsweep(&["serve", "--http", "127.0.0.1:0", "--seed", "1", "--hall", "empty-8x8", "--speed", "1"]);
    let mut limited = Command::new("sh");
    limited.args(["-c", &format!("ulimit -n {DESCRIPTORS} && exec \"$0\" \"$@\"")]);
    limited.arg(whole.get_program()).args(whole.get_args());
    for (name, value) in whole.get_envs() {
        match value {
            Some(value) => limited.env(name, value),
            None => limited.env_remove(name),
        };
    }
    Program::started(&mut limited)
}

/// Opens `CROWD` connections, each of which sends these bytes and stays open.
fn crowd(at: SocketAddr, says: &[u8]) -> Vec<TcpStream> {
    let come = |_| {
        let mut stream = TcpStream::connect(at).expect("the system takes it");
        // The program may already have closed this connection in favour of another.
        let _ = stream.write_all(says);
        stream
    };
    (0..CROWD).map(come).collect()
}

fn streams(program: &Program) -> Vec<TcpStream> {
    crowd(program.address(), b"GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n")
}

fn halves(program: &Program) -> Vec<TcpStream> {
    crowd(program.address(), b"POST /api/v1/commands/goto HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n{")
}

fn silent(program: &Program) -> Vec<TcpStream> {
    crowd(program.address(), b"")
}

fn guests(program: &Program) -> Vec<TcpStream> {
    crowd(program.mqtt(), &connect("", 60))
}

fn strangers(program: &Program) -> Vec<TcpStream> {
    crowd(program.mqtt(), b"")
}

/// Epoch read over CoAP, which needs no descriptor per client.
fn epoch(program: &Program) -> u64 {
    let reply = Coap::at(program.coap()).ask("GET", "mission", "").expect("the door answers");
    let mission: Value = serde_json::from_str(&reply.text).expect("JSON");
    mission["epoch"].as_u64().expect("an epoch")
}

fn until_epoch(program: &Program, wanted: u64, which: &str) {
    let deadline = Deadline::within(PATIENCE);
    while epoch(program) < wanted {
        assert!(!deadline.has_passed(), "a STOP over {which} never halted");
        sleep(GLANCE);
    }
}

fn stop_over_http(program: &Program) {
    assert_eq!(status(&mut connected(program, &stop("/h", ""))), "200", "a newcomer is let in");
}

fn stop_over_mqtt(program: &Program) {
    let mut client = Client::try_connect(program.mqtt(), &connect("", 60)).expect("a newcomer is let in");
    client.say(&publish("hallsweep/discovery/command/stop", b"", 1, 0, 7));
    client.until(PUBACK);
}

/// Safety S1, S9, A5.
fn check(comes: impl Fn(&Program) -> Vec<TcpStream>) {
    let _ = raise_descriptors(4096);
    let program = program();
    let mut expected = epoch(&program);
    let crowd = comes(&program);
    for _ in 0..STOPS {
        let mut over_coap = Coap::at(program.coap());
        over_coap.ask("POST", "commands/stop", "").expect("the door answers");
        expected += 1;
        until_epoch(&program, expected, "CoAP");
        stop_over_http(&program);
        expected += 1;
        until_epoch(&program, expected, "HTTP");
        stop_over_mqtt(&program);
        expected += 1;
        until_epoch(&program, expected, "MQTT");
    }
    drop(crowd);
    program.command("start").accepted();
    stop_over_mqtt(&program);
    until_epoch(&program, expected + 1, "MQTT");
    assert_eq!(program.json("state")["mission"]["epoch"], expected + 1, "one press is one stop");
}

#[test]
fn with_few_descriptors_a_crowd_that_watches_keeps_no_stop_out() {
    check(streams);
}

#[test]
fn with_few_descriptors_a_crowd_at_the_broker_keeps_no_stop_out() {
    check(guests);
}

#[test]
fn with_few_descriptors_a_crowd_that_does_not_go_on_keeps_no_stop_out() {
    check(|program| [halves(program), silent(program), strangers(program)].into_iter().flatten().collect());
}

#[test]
fn with_few_descriptors_crowds_at_every_door_keep_no_stop_out() {
    check(|program| [streams(program), guests(program), halves(program)].into_iter().flatten().collect());
}
