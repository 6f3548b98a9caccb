//! STOP, START, and the same bytes once more: STOP halts each time, at every interface, whatever that interface uses
//! to recognise repetitions. A message that the network repeats is no second press until a START has released the
//! robot.

use std::io::Write;
use std::net::UdpSocket;

use serde_json::Value;

use crate::journal::holds;
use crate::mqtt_attacks::client::Client;
use crate::mqtt_attacks::packets::{connect, connect_with, publish, text};
use crate::mqtt_attacks::{framed, web_client};
use crate::program::{PATIENCE, Program};

const DUP: u8 = 8;

/// Start of a POST to /commands/stop with message id 0 and no token: confirmable, and non-confirmable.
const CON: &[u8] = b"\x40\x02\0\0\xb8commands\x04stop";
const NON: &[u8] = b"\x50\x02\0\0\xb8commands\x04stop";

fn epoch(state: &Value) -> Option<u64> {
    state["mission"]["epoch"].as_u64()
}

/// Fails unless these bytes halt the robot after each START.
fn halts_each_time(program: &Program, name: &str, mut say: impl FnMut()) {
    for time in 1..=3 {
        program.command("start").accepted();
        let before = program.json("state");
        assert!(!holds(&before, "operator"), "{name}: {before:#}");
        say();
        program.until(&format!("{name} halts, time {time}"), |state| epoch(state) > epoch(&before) && holds(state, "operator"));
    }
}

fn socket(program: &Program) -> UdpSocket {
    let socket = UdpSocket::bind("127.0.0.1:0").expect("this machine has a free port");
    socket.connect(program.coap()).expect("it is reached");
    socket.set_read_timeout(Some(PATIENCE)).expect("a wait is more than nothing");
    socket
}

/// Safety S1.
#[test]
fn the_same_stop_over_http_halts_each_time() {
    let program = Program::serve("empty-8x8", "1");
    let key = [("idempotency-key", "k7")];
    for path in ["/api/v1/commands/stop", "/console/stop", "/h", "/stopappl"] {
        halts_each_time(&program, path, || drop(program.post_with(path, &[], "")));
        halts_each_time(&program, &format!("{path} by its name"), || drop(program.post_with(path, &key, "")));
    }
    let moved = || drop(program.post_with("/api/v1/commands/move", &key, r#"{"move":"h"}"#));
    halts_each_time(&program, "a move by its name", moved);
    let mut kept = std::net::TcpStream::connect(program.address()).expect("the program listens");
    halts_each_time(&program, "on one connection", || {
        kept.write_all(b"POST /h HTTP/1.1\r\nHost: localhost\r\nIdempotency-Key: k7\r\n\r\n").expect("it is heard");
    });
}

/// Safety S1.
#[test]
fn the_same_stop_over_coap_halts_each_time() {
    let program = Program::serve("empty-8x8", "1");
    let socket = socket(&program);
    let block = |id: u8, block: u8, body: &str| {
        let head = [&b"\x40\x02\0"[..], &[id], b"\xb8commands\x04move\xd1\x03", &[block, 0xFF]].concat();
        [&head, body.as_bytes()].concat()
    };
    let with_id = [CON, b"\x44id=7"].concat();
    let ways: [(&str, Vec<Vec<u8>>); 8] = [
        ("con", vec![CON.to_vec()]),
        ("non", vec![NON.to_vec()]),
        ("by its name", vec![with_id]),
        ("with an option that nobody knows", vec![[CON, b"\xe0\x01\x01"].concat()]),
        ("the same, passed over", vec![[NON, b"\xe0\x01\x01"].concat()]),
        ("broken", vec![[CON, b"\xf0"].concat()]),
        ("an old word", vec![b"\x40\x03\0\0\xbd\x00resourcemodel\xFFh".to_vec()]),
        ("in blocks", vec![block(1, 0x08, "{\"zz\":12345,\"mov"), block(2, 0x10, "e\":\"h\"}")]),
    ];
    for (name, datagrams) in ways {
        let say = || datagrams.iter().for_each(|datagram| assert_eq!(socket.send(datagram).ok(), Some(datagram.len())));
        halts_each_time(&program, name, say);
    }
}

/// Safety S1.
#[test]
fn the_same_stop_over_mqtt_halts_each_time() {
    const STOP: &str = "hallsweep/discovery/command/stop";
    const OLD: &str = "unibo/qak/robotmind";
    let program = Program::serve("empty-8x8", "1");
    let ways = [
        ("qos 0", publish(STOP, b"", 0, 0, 0)),
        ("qos 1", publish(STOP, b"", 1, 0, 7)),
        ("qos 1 again", publish(STOP, b"", 1, DUP, 7)),
        ("qos 2", publish(STOP, b"", 2, 0, 8)),
        ("qos 2 again", publish(STOP, b"", 2, DUP, 9)),
        ("by its name", publish(STOP, br#"{"id":"k7"}"#, 1, DUP, 7)),
        ("a bare word", publish("hallsweep/discovery/command", b"stop", 2, DUP, 10)),
        ("an old event", publish(OLD, b"msg(stopCmd,event,js,none,stopCmd(x),1)", 2, DUP, 11)),
        ("an old move", publish(OLD, b"msg(userCmd,dispatch,js,robotmind,userCmd(h),1)", 1, DUP, 7)),
    ];
    for is_five in [false, true] {
        let mut client = Client::try_speaking(program.mqtt(), &connect("again", 0), is_five).expect("the door opens");
        for (name, packet) in &ways {
            halts_each_time(&program, name, || client.say(packet));
        }
        let session = connect_with(4, 0, 0, &text("remembered"));
        halts_each_time(&program, "in a session that is taken up again", || {
            let mut client = Client::speaking(program.mqtt(), is_five);
            client.say(&[&session[..], &ways[4].1].concat());
            client.settle();
        });
    }
    let mut web = web_client(program.address());
    web.write_all(&framed(&connect("web", 0))).expect("it is heard");
    for (name, packet) in &ways {
        halts_each_time(&program, &format!("{name} over WebSocket"), || web.write_all(&framed(packet)).expect("it is heard"));
    }
}

/// JSON payload of a CoAP message, if there is one.
fn json(message: &[u8]) -> Option<Value> {
    // An ETag may contain any byte, even a brace. The payload starts after the marker 0xFF.
    let marker = message.windows(2).position(|two| two == [0xFF, b'{'])?;
    serde_json::from_slice(&message[marker + 1..]).ok()
}

/// Reads JSON payloads up to the first that matches, and returns all of them.
fn hear(socket: &UdpSocket, is_wanted: impl Fn(&Value) -> bool) -> Vec<Value> {
    let mut said = Vec::new();
    while !said.last().is_some_and(&is_wanted) {
        let mut message = [0; 2048];
        let length = socket.recv(&mut message).expect("it is answered");
        if message[0] & 0x30 == 0 {
            socket.send(&[0x60, 0, message[2], message[3]]).expect("it is sent");
        }
        said.extend(json(&message[..length]));
    }
    said
}

/// Safety S1, A6: each STOP after a START has its own answer and its own journal entry.
#[test]
fn what_the_network_repeats_is_one_press_until_a_start_and_then_another() {
    let program = Program::serve("empty-8x8", "1");
    let socket = socket(&program);
    let is_answer = |said: &Value| said["accepted"] == true;
    let mut answers = Vec::new();
    for id in 1..=3 {
        program.command("start").accepted();
        socket.send(CON).expect("it is sent");
        let answer = hear(&socket, is_answer).pop().expect("the last one");
        let look = [&[0x40, 0x01, 0, id][..], b"\xb7mission"].concat();
        for datagram in [CON, CON, &look] {
            socket.send(datagram).expect("it is sent");
        }
        let again = hear(&socket, |said| !said["phase"].is_null());
        assert!(again.iter().filter(|said| is_answer(said)).all(|said| *said == answer), "as before: {answer}, {again:?}");
        answers.push((answer["epoch"].as_u64(), answer["revision"].as_u64()));
    }
    assert_eq!(answers.iter().map(|(epoch, _)| *epoch).collect::<Vec<_>>(), [Some(1), Some(2), Some(3)]);
    assert!(answers.windows(2).all(|two| two[0].1 < two[1].1), "each names a newer state: {answers:?}");
    let events = program.json("missions/1/events?limit=1000")["events"].clone();
    let stops = events.as_array().expect("a list").iter().filter(|event| event.to_string().contains("\"STOP\"")).count();
    assert_eq!(stops, 3, "{events:#}");
}
