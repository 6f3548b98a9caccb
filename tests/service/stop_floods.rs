//! Floods of STOPs by a viewer or from this machine: every STOP halts and is answered, no command of another client
//! is refused, and the journal counts the STOPs of each sender. The latency is measured in `benches`.

use std::io::{Read, Write};
use std::net::{TcpStream, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::Value;

use crate::access::Site;
use crate::journal::holds;
use crate::mqtt_attacks::client::Client;
use crate::mqtt_attacks::packets::{connect_as, publish};
use crate::program::{PATIENCE, Program};

/// Number of STOPs in a flood, many times more than the queue of the journal holds.
const FLOOD: usize = 12_000;

/// Number of STOPs by an operator during the flood.
const PRESSED: usize = 10;

const STOP: &str = "hallsweep/discovery/command/stop";

/// Settings that make HTTP and MQTT ask for keys.
const ASKS: [&str; 2] = ["HTTP__REQUIRE_TOKEN", "MQTT__REQUIRE_PASSWORD"];

impl Site {
    /// Works as an operator until the flood is over. Fails unless every command is accepted and the store never holds
    /// the robot.
    fn work(&self, is_over: &AtomicBool) {
        let bearer = format!("Bearer {}", self.operator);
        let key = ("authorization", &bearer[..]);
        let mut pressed = 0;
        while pressed < PRESSED || !is_over.load(Ordering::SeqCst) {
            if pressed < PRESSED {
                self.program.post_with("/api/v1/commands/stop", &[key], "").accepted();
                pressed += 1;
            }
            self.program.post_with("/temperatureOk", &[key], "").accepted();
            let state = self.program.read("/api/v1/state", &[key]).json();
            assert!(!holds(&state, "store"), "{state:#}");
        }
    }

    /// Runs the flood with an operator at work beside it. Returns the journal.
    fn flooded(self, flood: impl FnOnce(&Site) + Send) -> Vec<Value> {
        let is_over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let _over = Over(&is_over);
                flood(&self);
            });
            self.work(&is_over);
        });
        let Site { mut program, folder, .. } = self;
        program.signal("TERM");
        assert!(program.ended_within(PATIENCE).is_some_and(|status| status.success()));
        let journal = |word: &str| {
            let output = folder.command(&["journal", word]).output().expect("the program starts");
            assert!(output.status.success(), "{output:?}");
            String::from_utf8(output.stdout).expect("it speaks UTF-8")
        };
        let said = journal("check");
        assert!(!said.contains("lost") && !said.contains("missing"), "{said}");
        journal("export").lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
    }
}

/// Marks the flood as over when it is dropped, even if the flood fails.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::SeqCst);
    }
}

/// Number of STOP entries of this sender, and number of STOPs that they count.
fn stops(journal: &[Value], who: &str, door: &str) -> (usize, usize) {
    let by = journal.iter().filter(|line| line["kind"] == "command" && line["who"] == who && line["door"] == door);
    let words: Vec<&str> = by.filter_map(|line| line["command"].as_str()).filter(|words| words.starts_with("STOP")).collect();
    let count = |words: &&str| words.split(' ').nth(1).map_or(1, |count| count.parse().expect("a number"));
    (words.len(), words.iter().map(count).sum())
}

/// Sends `count` requests on one connection, a hundred at a time.
pub(crate) fn pipelined(program: &Program, request: &str, count: usize) {
    const AT_ONCE: usize = 100;
    const ACCEPTED: &str = "\"accepted\":true";
    let mut stream = TcpStream::connect(program.address()).expect("the program listens");
    stream.set_read_timeout(Some(PATIENCE)).expect("a wait is more than nothing");
    let mut answers = String::new();
    for sent in (AT_ONCE..=count).step_by(AT_ONCE) {
        stream.write_all(request.repeat(AT_ONCE).as_bytes()).expect("it is heard");
        let mut bytes = [0; 64 * 1024];
        while answers.matches(ACCEPTED).count() < AT_ONCE {
            let read = stream.read(&mut bytes).expect("it answers");
            assert!(read > 0, "it is closed after {sent} stops: {answers}");
            answers.push_str(&String::from_utf8_lossy(&bytes[..read]));
        }
        assert_eq!(answers.matches(ACCEPTED).count(), AT_ONCE, "every one is answered, once");
        answers.clear();
    }
}

/// Safety S1, A6.
#[test]
fn a_flood_of_stops_over_http_costs_nobody_a_command_and_is_counted() {
    let journal = Site::new("stop-flood-http", &ASKS).flooded(|site| {
        let request = format!("POST /h HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {}\r\n\r\n", site.viewer);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| pipelined(&site.program, &request, FLOOD / 4));
            }
        });
    });
    assert_eq!(stops(&journal, "operator", "http"), (PRESSED, PRESSED), "each on record by itself");
    let (entries, counted) = stops(&journal, "lobby", "http");
    assert_eq!(counted, FLOOD);
    assert!(entries < FLOOD / 10, "{entries} entries");
}

/// Safety S1, A6.
#[test]
fn a_flood_of_stops_over_mqtt_costs_nobody_a_command_and_is_counted() {
    let journal = Site::new("stop-flood-mqtt", &ASKS).flooded(|site| {
        let broker = site.program.mqtt();
        let mut client = Client::try_connect(broker, &connect_as("flood", ("lobby", &site.viewer))).expect("it is let in");
        let stops = publish(STOP, b"", 0, 0, 0).repeat(100);
        (0..FLOOD / 100).for_each(|_| client.say(&stops));
        client.hang_up();
    });
    assert_eq!(stops(&journal, "operator", "http"), (PRESSED, PRESSED), "each on record by itself");
    let (entries, counted) = stops(&journal, "lobby", "mqtt");
    assert_eq!(counted, FLOOD);
    assert!(entries < FLOOD / 10, "{entries} entries");
}

/// Safety S1, A6: some datagrams may be lost.
#[test]
fn a_flood_of_stops_over_coap_costs_nobody_a_command() {
    let journal = Site::new("stop-flood-coap", &ASKS).flooded(|site| {
        let socket = UdpSocket::bind("127.0.0.7:0").expect("an address of this machine");
        for number in 0..FLOOD {
            let [high, low] = u16::try_from(number).expect("fewer than there are").to_be_bytes();
            // A non-confirmable POST to /commands/stop.
            let stop = [&[0x50, 2, high, low, 0xb8][..], b"commands", &[4], b"stop"].concat();
            socket.send_to(&stop, site.program.coap()).expect("it is sent");
        }
    });
    assert_eq!(stops(&journal, "operator", "http"), (PRESSED, PRESSED), "each on record by itself");
    let (entries, counted) = stops(&journal, "operator", "coap");
    assert!(counted > 100 && entries < counted / 2, "{entries} entries for {counted}");
}

/// Safety S7: drawing a past moment of a mission costs more than most requests, and a viewer may request it.
#[test]
fn whoever_has_the_past_drawn_without_end_keeps_nobody_from_a_command() {
    const MOMENTS: usize = 400;
    let site = Site::new("moment-flood", &ASKS);
    let operator = format!("Bearer {}", site.operator);
    site.program.post_with("/api/v1/commands/start", &[("authorization", &operator)], "").accepted();
    let journal = site.flooded(|site| {
        let viewer = format!("Bearer {}", site.viewer);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for place in 0..MOMENTS / 4 {
                        let path = format!("/console/missions/1/moment?at=99999&from={}", 3 + place % 20);
                        // If the journal has no such entry yet, the answer is 404.
                        let status = site.program.read(&path, &[("authorization", &viewer)]).status;
                        assert!([200, 404].contains(&status), "{path}: {status}");
                    }
                });
            }
        });
    });
    assert_eq!(stops(&journal, "operator", "http"), (PRESSED, PRESSED));
}
