//! The event stream: first the whole state, then the changes, and a continuation after a lost connection.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::time::Duration;

use serde_json::Value;

use crate::program::Program;

/// An open event stream.
pub(crate) struct Events(BufReader<TcpStream>);

/// One event of the stream.
#[derive(Debug)]
pub(crate) struct Event {
    pub(crate) id: String,
    pub(crate) name: String,
    pub(crate) data: Value,
}

impl Events {
    /// Opens a stream. `last` is the id of the last event that a returning reader has.
    pub(crate) fn open(program: &Program, last: Option<&str>) -> Events {
        let mut stream = TcpStream::connect(program.address()).expect("the program listens");
        stream.set_read_timeout(Some(Duration::from_secs(30))).expect("a time-out can be set");
        let last = last.map_or(String::new(), |id| format!("Last-Event-ID: {id}\r\n"));
        // HTTP/1.0, so that the events arrive without chunked encoding.
        write!(stream, "GET /api/v1/events HTTP/1.0\r\nHost: {}\r\n{last}\r\n", program.address()).expect("a question");
        let mut events = Events(BufReader::new(stream));
        assert!(events.line().contains(" 200 "));
        let headers: Vec<String> = std::iter::from_fn(|| Some(events.line())).take_while(|line| !line.is_empty()).collect();
        assert!(headers.iter().any(|header| header.to_lowercase().starts_with("content-type: text/event-stream")), "{headers:?}");
        events
    }

    /// Next event. Comments are skipped.
    pub(crate) fn next(&mut self) -> Event {
        let (mut id, mut name, mut data) = (String::new(), String::new(), String::new());
        loop {
            let line = self.line();
            match line.split_once(": ").or_else(|| line.split_once(':')) {
                Some(("id", value)) => value.clone_into(&mut id),
                Some(("event", value)) => value.clone_into(&mut name),
                Some(("data", value)) => data.push_str(value),
                Some(_) => {}
                None if data.is_empty() => {}
                None => return Event { id, name, data: serde_json::from_str(&data).expect("JSON") },
            }
        }
    }

    /// Whether the stream has ended.
    pub(crate) fn has_ended(&mut self) -> bool {
        let mut rest = String::new();
        loop {
            match self.0.read_line(&mut rest) {
                Ok(0) => return true,
                Ok(_) => {}
                Err(error) => return error.kind() == std::io::ErrorKind::ConnectionReset,
            }
        }
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        let read = self.0.read_line(&mut line).expect("a line in time");
        assert_ne!(read, 0, "the stream has ended");
        line.trim_end().to_owned()
    }
}

#[test]
fn the_snapshot_comes_first_and_then_what_changes() {
    let program = Program::serve("empty-8x8", "4");
    let mut events = Events::open(&program, None);
    let first = events.next();
    assert_eq!(first.name, "snapshot");
    assert_eq!(first.data["mission"]["phase"], "idle");
    assert!(first.data["map"]["rows"].is_array());
    assert_eq!(first.id.rsplit('-').next(), Some(first.data["revision"].to_string().as_str()), "the id ends in the revision");

    program.command("start").accepted();
    let mut revision = first.data["revision"].as_u64().expect("a revision");
    let mut cells = false;
    while !cells {
        let change = events.next();
        assert_eq!(change.name, "changes");
        let next = change.data["revision"].as_u64().expect("a revision");
        assert!(next > revision, "revisions grow");
        revision = next;
        cells = change.data["map"]["cells"].is_array();
        assert!(change.data["map"]["rows"].is_null(), "the map comes by changed cells");
    }
}

#[test]
fn a_reader_that_comes_back_gets_what_it_missed() {
    let program = Program::serve("empty-8x8", "max");
    let first = Events::open(&program, None).next();
    program.command("start").accepted();
    program.until_phase("explored");
    let missed = Events::open(&program, Some(&first.id)).next();
    assert_eq!(missed.name, "changes");
    assert_eq!(missed.data["mission"]["phase"], "explored");
    assert!(missed.data["revision"].as_u64() > first.data["revision"].as_u64());
}

#[test]
fn a_reader_from_another_run_gets_everything_anew() {
    let program = Program::serve("empty-8x8", "max");
    for stranger in ["another-run-3", "nonsense", ""] {
        assert_eq!(Events::open(&program, Some(stranger)).next().name, "snapshot", "{stranger}");
    }
}

#[test]
fn another_clients_change_is_seen_by_all() {
    let program = Program::serve("empty-8x8", "max");
    let mut streams: Vec<Events> = (0..5).map(|_| Events::open(&program, None)).collect();
    streams.iter_mut().for_each(|events| assert_eq!(events.next().name, "snapshot"));
    program.put("/api/v1/temperature", "{\"status\":\"tooHigh\"}").accepted();
    for events in &mut streams {
        while events.next().data["temperature"]["status"] != "tooHigh" {}
    }
}
