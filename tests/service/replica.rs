//! The event stream is complete: a client that applies every change has the same state as `GET state`, through a
//! whole mission.

use std::collections::BTreeMap;
use std::time::Duration;

use serde_json::{Value, json};

use crate::program::{Deadline, Program};
use crate::stream::Events;

/// Longest wait until the stream and the state have the same revision.
const PATIENCE: Duration = Duration::from_secs(30);

/// Number of the latest log lines in the state.
const LOG_LINES: usize = 256;

/// State of a reader of the stream: the first event with every change applied.
struct Replica {
    events: Events,
    state: Value,
}

impl Replica {
    fn follow(program: &Program) -> Replica {
        let mut events = Events::open(program, None);
        let state = events.next().data;
        Replica { events, state }
    }

    fn revision(&self) -> u64 {
        self.state["revision"].as_u64().expect("a revision")
    }

    /// Reads the stream up to the revision of the state, and compares both.
    fn compare(&mut self, program: &Program, when: &str) {
        let deadline = Deadline::within(PATIENCE);
        loop {
            let state = program.json("state");
            let revision = state["revision"].as_u64().expect("a revision");
            while self.revision() < revision {
                let change = self.events.next();
                assert_eq!(change.name, "changes", "{when}");
                self.apply(&change.data);
            }
            if self.revision() == revision {
                for (resource, truth) in state.as_object().expect("an object") {
                    assert_eq!(&self.state[resource], truth, "{when}: {resource} at revision {revision}");
                }
                return;
            }
            assert!(!deadline.has_passed(), "{when}: stream and state never stood at one revision");
        }
    }

    fn apply(&mut self, change: &Value) {
        for (resource, newer) in change.as_object().expect("an object") {
            match resource.as_str() {
                "map" => self.state["map"] = patched(&self.state["map"], newer),
                "log" => {
                    let lines = self.state["log"].as_array_mut().expect("lines");
                    lines.extend(newer.as_array().expect("lines").iter().cloned());
                }
                _ => self.state[resource] = newer.clone(),
            }
        }
        let lines = self.state["log"].as_array_mut().expect("lines");
        lines.drain(..lines.len().saturating_sub(LOG_LINES));
    }
}

/// The older map with the changed cells applied.
pub(crate) fn patched(older: &Value, newer: &Value) -> Value {
    if newer["rows"].is_array() {
        return newer.clone();
    }
    let mut marks: BTreeMap<(i64, i64), char> = BTreeMap::new();
    let (x0, y0) = (older["origin"]["x"].as_i64().expect("x"), older["origin"]["y"].as_i64().expect("y"));
    for (y, row) in (y0..).zip(older["rows"].as_array().expect("rows")) {
        for (x, mark) in (x0..).zip(row.as_str().expect("a row").chars()) {
            marks.insert((x, y), mark);
        }
    }
    for cell in newer["cells"].as_array().expect("cells") {
        let mark = cell["mark"].as_str().and_then(|mark| mark.chars().next()).expect("a mark");
        if mark == 'r' {
            marks.values_mut().filter(|mark| **mark == 'r').for_each(|mark| *mark = '1');
        }
        marks.insert((cell["x"].as_i64().expect("x"), cell["y"].as_i64().expect("y")), mark);
    }
    let number = |value: &Value| value.as_i64().expect("a number");
    let (left, top) = (number(&newer["origin"]["x"]), number(&newer["origin"]["y"]));
    let row = |y: i64| -> String {
        (left..left + number(&newer["width"])).map(|x| marks.get(&(x, y)).copied().unwrap_or('0')).collect()
    };
    let rows: Vec<String> = (top..top + number(&newer["height"])).map(row).collect();
    json!({"revision": newer["revision"], "origin": newer["origin"], "width": newer["width"], "height": newer["height"], "rows": rows})
}

#[test]
fn the_streams_replica_is_the_state_through_a_whole_mission() {
    let program = Program::serve("airport", "max");
    let mut replica = Replica::follow(&program);
    replica.compare(&program, "before anything");
    program.command("start").accepted();
    replica.compare(&program, "after START");
    let first = program.until_asked();
    program.command("stop").accepted();
    replica.compare(&program, "after STOP");
    program.put("/api/v1/temperature", "{\"celsius\":31.5}").accepted();
    replica.compare(&program, "too hot");
    program.command("start").problem(409);
    program.put("/api/v1/temperature", "{\"celsius\":20}").accepted();
    replica.compare(&program, "cool again");
    program.command("backHome").accepted();
    replica.compare(&program, "on the way home");
    program.until_phase("atHome");
    replica.compare(&program, "at home");
    program.verdict(first, "safe").accepted();
    replica.compare(&program, "a verdict at home");
    program.command("start").accepted();
    let second = program.until("another piece", |state| {
        state["luggage"].as_array().is_some_and(|all| all.iter().any(|piece| piece["verdict"] == "pending"))
    });
    let second =
        second["luggage"].as_array().and_then(|all| all.last()).and_then(|piece| piece["id"].as_u64()).expect("a number");
    replica.compare(&program, "another piece");
    program.verdict(second, "danger").accepted();
    let state = program.until_phase("bombLocated");
    replica.compare(&program, "the bomb is located");
    let alarm = state["alarms"].as_array().and_then(|all| all.last()).and_then(|alarm| alarm["id"].as_u64()).expect("an alarm");
    program.press(&format!("/api/v1/alarms/{alarm}/acknowledge")).accepted();
    replica.compare(&program, "acknowledged");
    program.command("reset").accepted();
    replica.compare(&program, "put away");
    assert_eq!(replica.state["mission"]["phase"], "idle");
}
