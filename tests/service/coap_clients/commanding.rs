//! Commands sent by three clients: each is accepted, or refused with a reason in the place where a user of that
//! client reads it.

use serde_json::json;

use super::ask::Ask;
use super::client::Client;
use super::{IF_MATCH, IF_NONE_MATCH, JSON, TEXT, door, serve, with_each};
use crate::program::{Program, hallsweep};

#[test]
fn every_client_starts_stops_and_is_told_why_not() {
    with_each(|client| {
        let program = serve("empty-8x8", "4");
        let door = door(&program);
        let post = |path: &str| client.ask(&door, &Ask::post(path, "{}").labelled(JSON));
        post("/commands/retrieve").refused("4.09", "idle");
        post("/commands/start").accepted();
        program.until("it moves", |state| state["robot"]["state"] != "stopped");
        post("/commands/stop").accepted();
        program.until("it stands", |state| state["robot"]["state"] == "stopped");
        let epoch = program.json("state")["mission"]["epoch"].as_u64().expect("an epoch");
        let outdated = format!("{{\"epoch\":{}}}", epoch - 1);
        client.ask(&door, &Ask::post("/commands/start", &outdated).labelled(JSON)).refused("4.09", "outdated");
        client.ask(&door, &Ask::put("/temperature", "{\"celsius\":31.5}").labelled(JSON)).accepted();
        post("/commands/start").refused("4.09", "above the threshold");
        client.ask(&door, &Ask::put("/temperature", "{\"celsius\":20}").labelled(JSON)).accepted();
        post("/commands/backHome").accepted();
        program.until_phase("atHome");
        post("/commands/dance").refused("4.04", "dance");
        let command = program.json("missions/1/events?limit=1000");
        let ours = command["events"].as_array().expect("a list").iter().find(|event| event["command"] == "START");
        assert_eq!(ours.map(|event| &event["door"]), Some(&json!("coap")), "{command}");
    });
}

/// Safety S1.
#[test]
fn stop_is_taken_without_confirmation() {
    with_each(|client| {
        let program = serve("empty-8x8", "4");
        program.command("start").accepted();
        program.until("it moves", |state| state["robot"]["state"] != "stopped");
        client.ask(&door(&program), &Ask::post("/commands/stop", "{}").labelled(JSON).non()).accepted();
        program.until("it stands", |state| state["robot"]["state"] == "stopped");
    });
}

#[test]
fn a_verdict_is_final_and_both_are_told() {
    with_each(|client| {
        let program = serve("seed", "max");
        let door = door(&program);
        program.command("start").accepted();
        let piece = program.until_asked();
        let path = format!("/luggage/{piece}/verdict");
        let say = |verdict: &str| client.ask(&door, &Ask::put(&path, &format!("{{\"verdict\":\"{verdict}\"}}")).labelled(JSON));
        say("perhaps").refused("4.22", "perhaps");
        say("safe").accepted();
        say("safe").accepted();
        say("danger").refused("4.09", "final");
        assert_eq!(program.json(&format!("luggage/{piece}"))["verdict"], "safe");
        client.ask(&door, &Ask::post("/luggage/77/verdict", "{\"verdict\":\"safe\"}").labelled(JSON)).refused("4.04", "77");
    });
}

/// The old console's words are accepted under every Content-Format that its clients send, and without one.
#[test]
fn the_old_words_are_taken_under_any_label() {
    with_each(|client| {
        let program = serve("seed", "max");
        let door = door(&program);
        program.command("start").accepted();
        for (word, label) in [("safe", Some(TEXT)), ("safe", Some(JSON)), ("danger", None)] {
            let piece = program.until_asked();
            client.ask(&door, &Ask { format: label, ..Ask::put("/resourcemodel", word) }).accepted();
            assert_eq!(program.json(&format!("luggage/{piece}"))["verdict"], word, "{client:?}, labelled {label:?}");
        }
        program.until_phase("bombLocated");
        client.ask(&door, &Ask::put("/resourcemodel", "safe")).refused("4.09", "no luggage");
    });
}

/// The old console sends a stray `w` when it starts, and an idle robot must not move. `h` is always STOP.
#[test]
fn the_old_moves_are_refused_unless_they_are_switched_on_and_h_always_halts() {
    with_each(|client| {
        let program = serve("empty-8x8", "4");
        let door = door(&program);
        let put = |word: &str, label| client.ask(&door, &Ask { format: label, ..Ask::put("/resourcemodel", word) });
        for label in [Some(TEXT), Some(JSON), None] {
            put("w", label).refused("4.03", "manual");
        }
        assert_eq!(program.json("state")["robot"]["position"], json!({"x": 0, "y": 0}));
        program.command("start").accepted();
        program.until("it moves", |state| state["robot"]["state"] != "stopped");
        put("h", Some(TEXT)).accepted();
        program.until("it stands", |state| state["robot"]["state"] == "stopped");
        put("jump", Some(TEXT)).refused("4.22", "jump");
    });
}

#[test]
fn the_old_moves_drive_the_robot_when_they_are_switched_on() {
    with_each(|client| {
        let arguments = ["serve", "--http", "127.0.0.1:0", "--coap", "127.0.0.1:0", "--hall", "empty-8x8", "--speed", "max"];
        let program = Program::started(hallsweep(&arguments).env("HALLSWEEP__OLD_CLIENTS__MANUAL_DRIVING", "true"));
        let door = door(&program);
        for (word, heading, y) in [("w", "south", 1), ("s", "south", 0), ("a", "east", 0), ("r", "south", 0)] {
            client.ask(&door, &Ask::put("/resourcemodel", word).labelled(TEXT)).accepted();
            program.until("it has moved", |state| {
                let robot = &state["robot"];
                robot["heading"] == heading && robot["position"]["y"] == y && state["mission"]["phase"] == "idle"
            });
        }
        client.ask(&door, &Ask::put("/resourcemodel", "z").labelled(TEXT)).refused("4.09", "");
    });
}

/// A body in blocks of 16 bytes is reassembled. Only libcoap and aiocoap split a body. Safety S4, S8: START and STOP
/// in blocks work too.
#[test]
fn a_command_in_pieces_is_carried_out_whole() {
    for client in [Client::Libcoap, Client::Aiocoap].into_iter().filter(|client| client.is_here()) {
        let program = serve("empty-8x8", "1");
        let in_pieces = |ask: Ask| {
            let ask = ask.labelled(JSON);
            let ask = if client == Client::Libcoap { ask.in_blocks_of(16) } else { Ask { upload_block: Some(16), ..ask } };
            client.ask(&door(&program), &ask)
        };
        let mission = || program.json("state")["mission"].clone();
        let start = "{                    \"epoch\":                    0}";
        in_pieces(Ask::post("/commands/start", start)).accepted();
        assert_eq!(mission()["phase"], "exploring", "{client:?}");
        in_pieces(Ask::post("/commands/move", "{                    \"move\":                    \"h\"}")).accepted();
        assert_eq!((&mission()["epoch"], &mission()["holds"][0]), (&json!(1), &json!("operator")), "{client:?}");
        in_pieces(Ask::post("/commands/start", start)).refused("4.09", "outdated");
        in_pieces(Ask::put("/temperature", "{                    \"celsius\":                    31.5}")).accepted();
        assert_eq!(program.json("state")["temperature"]["status"], "tooHigh", "{client:?}");
    }
}

#[test]
fn a_command_on_a_condition_is_held_against_what_stands() {
    with_each(|client| {
        let program = serve("empty-8x8", "max");
        let door = door(&program);
        let tag = super::reading::tag(&door, "/temperature");
        let put = |celsius: &str, option, value: &[u8]| {
            let body = format!("{{\"celsius\":{celsius}}}");
            client.ask(&door, &Ask::put("/temperature", &body).with(12, &[50]).with(option, value))
        };
        put("20.5", IF_NONE_MATCH, b"").refused("4.12", "");
        put("20.5", IF_MATCH, b"another").refused("4.12", "");
        put("20.5", IF_MATCH, &tag).accepted();
        put("19.5", IF_MATCH, &tag).refused("4.12", "");
        assert_eq!(program.json("state")["temperature"]["celsius"], 20.5);
    });
}
