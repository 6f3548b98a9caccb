//! Availability and retained state: a new client receives the current state at once, and the program announces its
//! end in advance.

use std::time::Duration;

use super::running::RunningClient;
use super::told::Hello;
use super::{AVAILABILITY, OURS, with_each};
use crate::program::Program;

/// Longest time for the end of the program.
const PATIENCE: Duration = Duration::from_secs(30);

#[test]
fn everybody_is_told_that_the_program_is_there_and_that_it_ends() {
    with_each(|client| {
        let mut program = Program::serve("empty-8x8", "max");
        let process = RunningClient::begin(client, &program, Hello::following(&[AVAILABILITY], 1));
        process.until_newest(AVAILABILITY, "online", |message| message.payload == "online");
        program.signal("TERM");
        process.until_newest(AVAILABILITY, "offline", |message| message.payload == "offline" && !message.kept);
        assert!(program.ended_within(PATIENCE).is_some_and(|status| status.success()));
        let said: Vec<String> = process.heard().into_iter().map(|message| message.payload).collect();
        assert_eq!(said.last().map(String::as_str), Some("offline"), "{said:?}");
        assert_eq!(said.iter().filter(|word| *word == "offline").count(), 1, "once: {said:?}");
    });
}

#[test]
fn a_newcomer_is_told_what_stands() {
    with_each(|client| {
        let program = Program::serve("empty-8x8", "max");
        program.command("start").accepted();
        program.until_phase("explored");
        let state = program.json("state");
        // Retained messages follow the state after a moment. Only when they match is no further message to be
        // expected.
        let early = RunningClient::begin(client, &program, Hello::following(&[OURS], 0));
        let shown = |name: &str| format!("hallsweep/discovery/state/{name}");
        let resources = ["mission", "robot", "map", "luggage", "temperature", "alarms", "retrieval", "log"];
        for name in resources {
            early.until_newest(&shown(name), "as it stands", |message| message.json() == state[name]);
        }
        early.leave();
        let late = RunningClient::begin(client, &program, Hello::following(&[OURS], 1));
        let topics = || resources.iter().map(|name| shown(name)).chain([AVAILABILITY.to_owned()]);
        late.until("all that is kept", |heard| {
            topics().all(|topic| heard.iter().any(|message| message.topic == topic)).then_some(())
        });
        let heard = late.heard();
        assert!(heard.iter().all(|message| message.kept && message.qos == 1), "{heard:#?}");
        for name in resources {
            let message = heard.iter().find(|message| message.topic == shown(name)).expect("it is kept");
            assert_eq!(message.json(), state[name], "{name}");
        }
        assert!(heard.iter().any(|message| message.topic == AVAILABILITY && message.payload == "online"));
        late.leave();
    });
}
