//! STOP over MQTT during a flood halts the robot. The latency is measured in `benches`.

use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

use super::client::Client;
use super::crowds::{framed, web_client};
use super::packets::{connect, publish};
use super::siege::Siege;
use crate::journal::holds;

/// Number of clients that publish as fast as they can.
const SHOUTING: usize = 4;

/// Number of times that the robot is started and stopped during the flood.
const STOPS: usize = 20;

/// Publishes until `is_enough` is set.
fn shout(mut client: Client, n: usize, is_enough: &AtomicBool) {
    let burst = publish(&format!("shouts/{n}"), &[b'x'; 100], 0, 0, 0).repeat(100);
    let mut mouth = client.mouth();
    while !is_enough.load(Ordering::SeqCst) {
        mouth.write_all(&burst).expect("the broker takes it");
    }
    client.settle();
}

/// Safety S4: a client library sends an unacknowledged message again, however old it is. A START with the current
/// epoch still works.
#[test]
fn a_start_that_a_client_delivers_again_after_a_stop_moves_nothing() {
    const DUP: u8 = 8;
    const RESULT: &str = "hallsweep/discovery/command/start/result";
    let siege = Siege::begin();
    let started = |name: &str, flags: u8, payload: &[u8]| {
        let mut client = siege.client(name);
        client.subscribe(RESULT, 0);
        client.say(&publish("hallsweep/discovery/command/start", payload, 1, flags, 7));
        serde_json::from_slice::<serde_json::Value>(&client.message().payload).expect("a result is JSON")
    };
    assert_eq!(started("operator", 0, b"")["accepted"], true);
    siege.program.command("stop").accepted();
    let again = started("operator", DUP, b"");
    assert_eq!((&again["accepted"], &again["code"]), (&false.into(), &"sentBefore".into()), "{again}");
    let state = siege.program.json("state");
    assert!(holds(&state, "operator"), "{state:#}");
    let epoch = &state["mission"]["epoch"];
    assert_eq!(started("operator", DUP, format!("{{\"epoch\":{epoch}}}").as_bytes())["accepted"], true);
}

/// Safety S1.
#[test]
fn a_stop_halts_while_others_flood_the_broker_and_one_reads_nothing() {
    let mut siege = Siege::begin();
    let mut stalled = siege.client("stalled");
    assert_eq!(stalled.subscribe("#", 1), 1);
    let (mut operator, is_enough) = (siege.client("operator"), AtomicBool::new(false));
    std::thread::scope(|scope| {
        for n in 0..SHOUTING {
            let (client, is_enough) = (siege.client(&format!("shouting-{n}")), &is_enough);
            scope.spawn(move || shout(client, n, is_enough));
        }
        for n in 0..STOPS {
            siege.program.command("start").accepted();
            let old = "msg(stopCmd,event,webconsole,none,stopCmd(x),1)";
            match n % 3 {
                0 => operator.publish("hallsweep/discovery/command/stop", b""),
                1 => operator.publish("hallsweep/discovery/command", b"stop"),
                _ => operator.publish("unibo/qak/robotmind", old.as_bytes()),
            }
            siege.program.until("the operator's stop holds the robot", |state| holds(state, "operator"));
        }
        is_enough.store(true, Ordering::SeqCst);
    });
    siege.stands();
}

/// Safety S8: the WebSocket message has no end yet, and may never have one.
#[test]
fn a_stop_over_websocket_halts_when_its_frame_has_come_whole() {
    let siege = Siege::begin();
    let mut web = web_client(siege.program.address());
    web.write_all(&framed(&connect("web", 0))).expect("it is heard");
    let stop = publish("hallsweep/discovery/command/stop", b"", 0, 0, 0);
    let frame = |first: u8, bytes: &[u8]| {
        let mut frame = framed(bytes);
        frame[0] = first;
        frame
    };
    let (half, rest) = stop.split_at(stop.len() / 2);
    let ping = frame(0x89, b"ping");
    let ways = [
        ("the first of its message", frame(0x02, &stop)),
        ("one in between", [ping.clone(), frame(0x00, &stop)].concat()),
        ("the last", frame(0x80, &stop)),
        ("two frames of one", [frame(0x02, half), ping, frame(0x00, rest)].concat()),
        ("two of an ended one", [frame(0x80, half), frame(0x82, rest)].concat()),
    ];
    for (name, bytes) in ways {
        siege.program.command("start").accepted();
        for piece in bytes.chunks(11) {
            web.write_all(piece).expect("it is heard");
        }
        siege.program.until(name, |state| holds(state, "operator"));
    }
}
