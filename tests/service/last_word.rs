//! Safety S4: of a START and a STOP on one connection the later one counts, even though the program recognises a STOP
//! before its turn and both commands arrive in one segment.

use std::io::{Read, Write};
use std::net::TcpStream;

use crate::journal::holds;
use crate::mqtt_attacks::client::Client;
use crate::mqtt_attacks::packets::{connect, publish};
use crate::program::Program;

const COMMAND: &str = "hallsweep/discovery/command";

/// Number of repetitions, because the order of recognition and execution depends on chance.
const ROUNDS: usize = 10;

fn program() -> Program {
    Program::with(&["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "4"])
}

/// Sends these commands on one HTTP connection in one write, and returns when all are answered.
fn over_http(program: &Program, commands: &[&str]) {
    let mut connection = TcpStream::connect(program.address()).expect("the door is open");
    let one = |(n, name): (usize, &&str)| {
        let end = if n + 1 == commands.len() { "Connection: close\r\n" } else { "" };
        format!("POST /api/v1/commands/{name} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n{end}\r\n")
    };
    let all: String = commands.iter().enumerate().map(one).collect();
    connection.write_all(all.as_bytes()).expect("it is read");
    let mut answers = String::new();
    connection.read_to_string(&mut answers).expect("the answers are text");
    assert_eq!(answers.matches("HTTP/1.1 ").count(), commands.len(), "{answers}");
}

/// Like `over_http`, over MQTT.
fn over_mqtt(program: &Program, commands: &[&str]) {
    let mut client = Client::try_connect(program.mqtt(), &connect("hasty", 60)).expect("the door lets it in");
    assert_eq!(client.subscribe(&format!("{COMMAND}/+/result"), 0), 0);
    let all: Vec<u8> = commands.iter().flat_map(|name| publish(&format!("{COMMAND}/{name}"), b"", 0, 0, 0)).collect();
    client.say(&all);
    for _ in commands {
        client.message();
    }
}

type Way = fn(&Program, &[&str]);
const WAYS: [(&str, Way); 2] = [("HTTP", over_http), ("MQTT", over_mqtt)];

#[test]
fn a_start_in_front_of_a_stop_does_not_come_after_it() {
    let program = program();
    for (door, say) in WAYS {
        for round in 0..ROUNDS {
            program.command("start").accepted();
            say(&program, &["start", "stop"]);
            assert!(holds(&program.json("state"), "operator"), "{door}, moving, round {round}");
            say(&program, &["start", "backHome", "start", "stop"]);
            assert!(holds(&program.json("state"), "operator"), "{door}, standing, round {round}");
        }
    }
}

#[test]
fn a_start_behind_a_stop_is_not_outdated_by_it() {
    let program = program();
    for (door, say) in WAYS {
        for round in 0..ROUNDS {
            say(&program, &["stop", "start"]);
            assert!(!holds(&program.json("state"), "operator"), "{door}, round {round}");
        }
    }
}
