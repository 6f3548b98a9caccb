//! Whole missions over the JSON topics alone, driven and watched by one client, which knows the state from retained
//! messages and the outcome of its commands from their results. The last state that it saw is the state at the HTTP
//! interface.

use serde_json::{Value, json};

use super::client::Client;
use super::running::RunningClient;
use super::told::{Hello, Message, Say};
use super::{AVAILABILITY, OURS, command, results};
use crate::program::Program;

/// Topic of the log lines.
const EVENT: &str = "hallsweep/discovery/event";

/// Resources with a topic.
const RESOURCES: [&str; 7] = ["mission", "robot", "map", "luggage", "temperature", "alarms", "log"];

/// A console that uses JSON.
struct Console<'a> {
    process: RunningClient<'a>,
    given: u32,
}

impl Console<'_> {
    fn of(client: Client, program: &Program) -> Console<'static> {
        let process = RunningClient::begin(client, program, Hello::following(&[OURS], 1));
        process.until_newest(AVAILABILITY, "online", |message| message.payload == "online");
        Console { process, given: 0 }
    }

    /// Sends a command with a new id, and returns the result.
    fn give(&mut self, name: &str, mut body: Value) -> Value {
        self.given += 1;
        let id = format!("command-{}", self.given);
        body["id"] = id.clone().into();
        self.process.say(Say::plain(&command(name), &body.to_string()).at(1));
        self.process.until(&format!("the result of {body}"), |heard| {
            results(heard, name).into_iter().find(|result| result["id"] == id.as_str())
        })
    }

    fn accepted(&mut self, name: &str, body: Value) -> Value {
        let result = self.give(name, body);
        assert_eq!(result["accepted"], true, "{name}: {result:#}");
        assert!(result["revision"].is_u64() && result["epoch"].is_u64(), "{result:#}");
        result
    }

    fn until_state(&self, resource: &str, wanted: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        self.process.until_newest(&state(resource), wanted, |message| is_so(&message.json())).json()
    }

    /// Waits until a piece other than `before` is pending, and returns its number.
    fn until_asked(&self, before: u64) -> u64 {
        let another = |luggage: &Value| pending(luggage).is_some_and(|piece| piece != before);
        let luggage = self.until_state("luggage", "another piece waits for its verdict", another);
        pending(&luggage).expect("it was there just now")
    }

    fn until_phase(&self, phase: &str) {
        self.until_state("mission", phase, |mission| mission["phase"] == phase);
    }

    /// Fails unless the newest message of each resource matches the state and all events arrived in order.
    fn shows_what_stands(self, program: &Program) {
        for resource in RESOURCES {
            self.until_state(resource, "as it stands", |seen| *seen == program.json("state")[resource]);
        }
        let last = program.json("state")["log"].as_array().and_then(|lines| lines.last().cloned()).expect("there are lines");
        self.process.until_newest(EVENT, "the last line", |message| message.json() == last);
        let heard = self.process.heard();
        let events: Vec<&Message> = heard.iter().filter(|message| message.topic == EVENT).collect();
        let numbers: Vec<u64> = events.iter().filter_map(|event| event.json()["number"].as_u64()).collect();
        assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1) && numbers.len() > 5, "{numbers:?}");
        let is_state = |message: &Message| message.topic.contains("/state/") || message.topic == AVAILABILITY;
        assert!(heard.iter().all(|message| !message.kept || is_state(message)), "only what stands is kept");
        self.process.leave();
    }
}

fn state(resource: &str) -> String {
    format!("hallsweep/discovery/state/{resource}")
}

fn pending(luggage: &Value) -> Option<u64> {
    luggage.as_array()?.iter().find(|piece| piece["verdict"] == "pending")?["id"].as_u64()
}

/// One piece is safe, and the next is dangerous. STOP and heat hold the robot in between, and the alarm is
/// acknowledged.
fn a_bomb_is_found(client: Client) {
    if !client.is_here() {
        return;
    }
    let program = Program::serve("seed", "max");
    let mut console = Console::of(client, &program);
    console.accepted("start", json!({}));
    let first = console.until_asked(0);
    console.process.say(Say::plain("hallsweep/discovery/command", "stop").at(1));
    console.process.until("the result of a bare word", |heard| results(heard, "stop").pop().filter(|it| it["accepted"] == true));
    console.until_state("mission", "held", |mission| mission["holds"].to_string().contains("\"operator\""));
    console.accepted("temperature", json!({"celsius": 31.5}));
    console.until_state("temperature", "hot", |temperature| temperature["celsius"] == 31.5);
    let verdict = console.accepted("verdict", json!({"luggage": first, "verdict": "safe"}));
    assert_eq!((&verdict["luggage"]["id"], &verdict["luggage"]["verdict"]), (&first.into(), &"safe".into()));
    let refused = console.give("start", json!({}));
    assert_eq!((&refused["accepted"], &refused["status"], &refused["code"]), (&false.into(), &409.into(), &"held".into()));
    console.accepted("temperature", json!({"celsius": 20}));
    console.accepted("start", json!({}));
    let second = console.until_asked(first);
    console.accepted("verdict", json!({"luggage": second, "verdict": "danger"}));
    console.until_phase("bombLocated");
    let alarms = console.until_state("alarms", "an alarm", |alarms| alarms.as_array().is_some_and(|all| !all.is_empty()));
    console.accepted("acknowledge", json!({"alarm": alarms[0]["id"]}));
    console.accepted("retrieve", json!({}));
    console.until_phase("bagSecured");
    program.until_phase("bagSecured");
    console.shows_what_stands(&program);
}

#[test]
fn mosquitto_finds_a_bomb_over_the_json_topics() {
    a_bomb_is_found(Client::Mosquitto);
}

#[test]
fn mosquitto_finds_a_bomb_over_the_json_topics_in_mqtt_5() {
    a_bomb_is_found(Client::MosquittoFive);
}

#[test]
fn paho_finds_a_bomb_over_the_json_topics() {
    a_bomb_is_found(Client::Paho);
}

#[test]
fn paho_finds_a_bomb_over_the_json_topics_in_mqtt_5() {
    a_bomb_is_found(Client::PahoFive);
}

#[test]
fn mqtt_js_finds_a_bomb_over_the_json_topics() {
    a_bomb_is_found(Client::MqttJs);
}

#[test]
fn mqtt_js_in_a_browser_finds_a_bomb_over_the_json_topics() {
    a_bomb_is_found(Client::MqttJsWeb);
}

#[test]
fn mqtt_js_in_a_browser_finds_a_bomb_over_the_json_topics_in_mqtt_5() {
    a_bomb_is_found(Client::MqttJsWebFive);
}

/// Every piece is safe, and the robot is sent home once during the search.
fn everything_is_safe(client: Client) {
    if !client.is_here() {
        return;
    }
    let program = Program::serve("seed", "max");
    let mut console = Console::of(client, &program);
    console.accepted("strategy", json!({"name": "snail"}));
    console.accepted("start", json!({}));
    let mut asked = console.until_asked(0);
    console.accepted("backHome", json!({}));
    console.until_phase("atHome");
    console.accepted("verdict", json!({"luggage": asked, "verdict": "safe"}));
    console.accepted("start", json!({}));
    for _ in 0..2 {
        asked = console.until_asked(asked);
        console.accepted("verdict", json!({"luggage": asked, "verdict": "safe"}));
    }
    console.until_phase("explored");
    program.until_phase("explored");
    console.shows_what_stands(&program);
}

#[test]
fn mosquitto_explores_a_hall_over_the_json_topics() {
    everything_is_safe(Client::Mosquitto);
}

#[test]
fn paho_explores_a_hall_over_the_json_topics() {
    everything_is_safe(Client::Paho);
}

#[test]
fn mqtt_js_in_a_browser_explores_a_hall_over_the_json_topics() {
    everything_is_safe(Client::MqttJsWeb);
}
