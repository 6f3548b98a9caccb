//! The whole program at an external broker: a mission driven and watched over messages alone, in JSON and in the old
//! words, and a broker that is away during a mission.

use std::time::Duration;

use serde_json::{Value, json};

use super::broker::{Broker, CERTIFICATE, Kind, LOGIN};
use super::subscriber::TestSubscriber;
use crate::mqtt_clients::client::{Client, mosquitto_rr};
use crate::program::{Program, hallsweep};

/// Filter of all topics of this robot.
const OURS: &str = "hallsweep/discovery/#";

/// Filter of all topics of the original system.
const OLD: &str = "unibo/qak/#";

/// Starts the program with this hall, speed and broker.
fn serve(broker: &Broker, hall: &str, speed: &str) -> Program {
    let arguments = ["serve", "--http", "127.0.0.1:0", "--seed", "1", "--hall", hall, "--speed", speed];
    let mut command = hallsweep(&arguments);
    command.env("HALLSWEEP__MQTT__BROKER", broker.url());
    if broker.kind() == Kind::MosquittoFive {
        command.env("HALLSWEEP__MQTT__VERSION", "5");
    }
    if broker.kind() == Kind::MosquittoWithLogin {
        command.env("HALLSWEEP__MQTT__NAME", LOGIN.0).env("HALLSWEEP__MQTT__PASSWORD", LOGIN.1);
    }
    if broker.kind() == Kind::MosquittoByTls {
        command.env("HALLSWEEP__MQTT__CERTIFICATES", CERTIFICATE);
    }
    Program::started(&mut command)
}

/// Sends a command in JSON and waits for its result.
fn give(subscriber: &TestSubscriber, name: &str, mut payload: Value, id: &str) -> Value {
    payload["id"] = id.into();
    subscriber.say(&format!("hallsweep/discovery/command/{name}"), &payload.to_string());
    subscriber.json(&format!("hallsweep/discovery/command/{name}/result"), |result| result["id"] == id)
}

/// Like `give`, for a command that must be accepted.
fn accepted(subscriber: &TestSubscriber, name: &str, payload: Value, id: &str) {
    let result = give(subscriber, name, payload, id);
    assert_eq!(result["accepted"], true, "{name}: {result}");
}

/// Waits until the program is online. From then on it receives commands.
fn until_online(subscriber: &TestSubscriber) {
    subscriber.until("online", |said| said.topic.ends_with("/availability") && &said.payload[..] == b"online");
}

fn until_phase(subscriber: &TestSubscriber, phase: &str) {
    subscriber.json("hallsweep/discovery/state/mission", |mission| mission["phase"] == phase);
}

/// Waits for a pending piece with a number above `after`, and returns its number.
fn until_asked(subscriber: &TestSubscriber, after: u64) -> u64 {
    let is_next = |piece: &&Value| piece["verdict"] == "pending" && piece["id"].as_u64().is_some_and(|id| id > after);
    let waits = |pieces: &Value| pieces.as_array()?.iter().find(is_next)?["id"].as_u64();
    let pieces = subscriber.json("hallsweep/discovery/state/luggage", |pieces| waits(pieces).is_some());
    waits(&pieces).expect("it was there just now")
}

/// Runs a search with a safe and a dangerous piece, and puts the mission away.
fn over_json(kind: Kind, name: &str) {
    if !kind.is_here() {
        return;
    }
    let broker = Broker::start(kind, name);
    let subscriber = TestSubscriber::at(&broker, OURS);
    let _program = serve(&broker, "airport", "max");
    until_online(&subscriber);
    let refused = give(&subscriber, "retrieve", json!({}), "early");
    assert_eq!((&refused["accepted"], &refused["status"]), (&json!(false), &json!(409)), "{refused}");
    accepted(&subscriber, "start", json!({}), "a");
    let first = until_asked(&subscriber, 0);
    accepted(&subscriber, "verdict", json!({"luggage": first, "verdict": "safe"}), "b");
    let second = until_asked(&subscriber, first);
    accepted(&subscriber, "verdict", json!({"luggage": second, "verdict": "danger"}), "c");
    until_phase(&subscriber, "bombLocated");
    // A later subscriber receives the current state.
    let late = TestSubscriber::at(&broker, "hallsweep/discovery/state/+");
    let alarms = late.json("hallsweep/discovery/state/alarms", |alarms| alarms.as_array().is_some_and(|all| !all.is_empty()));
    for (place, alarm) in alarms.as_array().expect("a list").iter().enumerate() {
        accepted(&subscriber, "acknowledge", json!({"alarm": alarm["id"]}), &format!("d{place}"));
    }
    accepted(&subscriber, "reset", json!({}), "e");
    until_phase(&TestSubscriber::at(&broker, OURS), "idle");
}

/// The old console's view of the messages: their contents, and their numbers without a gap.
struct Console {
    subscriber: TestSubscriber,
    last: u64,
}

impl Console {
    /// Next content that matches.
    fn until(&mut self, wanted: &str, is_it: impl Fn(&str) -> bool) -> String {
        loop {
            let said = self.subscriber.next(wanted);
            if !said.payload.starts_with(b"msg(modelContent,") {
                continue;
            }
            let text = String::from_utf8(said.payload.to_vec()).expect("it is text");
            let (content, number) = text.strip_suffix(')').and_then(|text| text.rsplit_once(',')).expect("it is numbered");
            assert_eq!((said.topic.as_str(), number), ("unibo/qak/events", (self.last + 1).to_string().as_str()), "{text}");
            self.last += 1;
            let content = content.strip_prefix("msg(modelContent,event,resourcemodel,none,").expect("as it always was");
            if is_it(content) {
                return content.to_owned();
            }
        }
    }

    /// Sends an event, as the old buttons do.
    fn event(&self, name: &str) {
        self.subscriber.say("unibo/qak/events", &format!("msg({name},event,js,none,{name},1)"));
    }

    /// Sends a dispatch, as other old clients do.
    fn dispatch(&self, name: &str) {
        self.subscriber.say("unibo/qak/robotmind", &format!("msg({name},dispatch,js,robotmind,{name},1)"));
    }
}

/// Runs a mission in the old words. All its messages have the same sender and number.
fn over_old_topics(kind: Kind, name: &str) {
    if !kind.is_here() {
        return;
    }
    let broker = Broker::start(kind, name);
    let mut console = Console { subscriber: TestSubscriber::at(&broker, OLD), last: 0 };
    let program = serve(&broker, "airport", "max");
    let at_home = |content: &str| content.starts_with("content(robot(state(stopped),") && content.contains("position(0,0)");
    console.until("the robot at home", at_home);
    console.event("startCmd");
    console.until("the first piece", |content| content.starts_with("content(luggage("));
    console.dispatch("luggageSafe");
    console.until("the next piece", |content| content.starts_with("content(luggage("));
    console.event("luggageDanger");
    console.until("the robot at home again", at_home);
    program.until_phase("bombLocated");
}

/// Kills the broker during a mission: everything else keeps working. When the broker is back, it receives the current
/// state, and commands work again.
fn away(kind: Kind, name: &str) {
    if !kind.is_here() {
        return;
    }
    let mut broker = Broker::start(kind, name);
    let program = serve(&broker, "airport", "max");
    let subscriber = TestSubscriber::at(&broker, OURS);
    until_online(&subscriber);
    accepted(&subscriber, "start", json!({}), "a");
    let first = until_asked(&subscriber, 0);
    drop(subscriber);
    broker.kill();
    program.verdict(first, "safe").accepted();
    let second = program.until("the next piece", |state| state["luggage"][1]["verdict"] == "pending")["luggage"][1]["id"].clone();
    broker.start_again();
    let subscriber = TestSubscriber::at(&broker, OURS);
    until_online(&subscriber);
    let is_newest = |pieces: &Value| pieces[0]["verdict"] == "safe" && pieces[1]["id"] == second;
    subscriber.json("hallsweep/discovery/state/luggage", is_newest);
    accepted(&subscriber, "verdict", json!({"luggage": second, "verdict": "danger"}), "b");
    until_phase(&subscriber, "bombLocated");
}

/// If another client overwrites or removes a retained message of the program, the program restores it after a
/// moment, and logs this once per topic.
fn replaced(kind: Kind, name: &str, larger: &[&str]) {
    if !kind.is_here() {
        return;
    }
    let broker = Broker::start(kind, name);
    let subscriber = TestSubscriber::at(&broker, OURS);
    let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0", "--hall", "empty-8x8"]);
    command.env("HALLSWEEP__MQTT__BROKER", broker.url()).env("HALLSWEEP__MQTT__HOME_ASSISTANT", "true");
    if kind == Kind::MosquittoFive {
        command.env("HALLSWEEP__MQTT__VERSION", "5");
    }
    let log = std::env::temp_dir().join(format!("hallsweep-replaced-{}-{name}", std::process::id()));
    command.stderr(std::fs::File::create(&log).expect("the folder for such files can be written"));
    let program = Program::started(&mut command);
    until_online(&subscriber);
    let usual = [
        "hallsweep/discovery/availability",
        "hallsweep/discovery/state/mission",
        "hallsweep/discovery/state/robot",
        "hallsweep/discovery/homeassistant",
        "homeassistant/device/discovery/config",
    ];
    for topic in usual.iter().chain(larger) {
        let there = TestSubscriber::at(&broker, topic);
        for theirs in ["offline", ""] {
            subscriber.keep(topic, theirs);
            while there.next(topic).payload != theirs {}
            while there.next(topic).payload == theirs {}
            assert_ne!(TestSubscriber::at(&broker, topic).next(topic).payload, theirs, "{topic}");
        }
    }
    drop(program);
    let said = std::fs::read_to_string(&log).expect("the program has written it");
    let _ = std::fs::remove_file(&log);
    assert_eq!(said.matches("another client overwrote a topic of hallsweep").count(), usual.len() + larger.len(), "{said}");
}

#[test]
fn what_somebody_else_keeps_on_our_topics_at_mosquitto_is_replaced() {
    replaced(Kind::Mosquitto, "replaced-mosquitto", &[]);
}

#[test]
fn what_somebody_else_keeps_on_our_topics_at_mosquitto_in_mqtt_5_is_replaced() {
    let larger = ["map", "luggage", "log"].map(|name| format!("hallsweep/discovery/state/{name}"));
    replaced(Kind::MosquittoFive, "replaced-five", &larger.each_ref().map(String::as_str));
}

#[test]
fn what_somebody_else_keeps_on_our_topics_at_nats_is_replaced() {
    replaced(Kind::Nats, "replaced-nats", &[]);
}

#[test]
fn a_mission_runs_over_json_at_mosquitto() {
    over_json(Kind::Mosquitto, "json-mosquitto");
}

#[test]
fn a_mission_runs_over_json_at_mosquitto_in_mqtt_5() {
    over_json(Kind::MosquittoFive, "json-five");
}

#[test]
fn a_mission_runs_over_json_at_mosquitto_with_a_login() {
    over_json(Kind::MosquittoWithLogin, "json-login");
}

#[test]
fn a_mission_runs_over_json_at_nats() {
    over_json(Kind::Nats, "json-nats");
}

#[test]
fn a_mission_runs_over_the_old_topics_at_mosquitto() {
    over_old_topics(Kind::Mosquitto, "old-mosquitto");
}

#[test]
fn a_mission_runs_over_the_old_topics_at_nats() {
    over_old_topics(Kind::Nats, "old-nats");
}

#[test]
fn a_mission_goes_on_while_mosquitto_is_away() {
    away(Kind::Mosquitto, "away-mosquitto");
}

#[test]
fn a_mission_goes_on_while_mosquitto_is_away_in_mqtt_5() {
    away(Kind::MosquittoFive, "away-five");
}

#[test]
fn a_mission_goes_on_while_nats_is_away() {
    away(Kind::Nats, "away-nats");
}

/// The test has no TLS subscriber, so the log of mosquitto shows the farewell of the program.
#[test]
fn the_program_takes_leave_of_a_broker_it_reached_by_tls() {
    if !Kind::MosquittoByTls.is_here() {
        return;
    }
    let broker = Broker::start(Kind::MosquittoByTls, "leave-tls");
    let mut program = serve(&broker, "empty-8x8", "max");
    broker.until_it_says("Received PUBLISH from hallsweep-discovery");
    program.signal("TERM");
    assert!(program.ended_within(Duration::from_secs(60)).is_some_and(|status| status.success()));
    broker.until_it_says("Received DISCONNECT from hallsweep-discovery");
}

/// The answer goes to the topic that the sender names, unless only hallsweep may publish there. Messages carry
/// properties.
#[test]
fn a_command_at_mosquitto_is_answered_where_its_sender_wants_it() {
    if !Kind::MosquittoFive.is_here() || !Client::MosquittoFive.is_here() {
        return;
    }
    let broker = Broker::start(Kind::MosquittoFive, "answer-five");
    let _program = serve(&broker, "empty-8x8", "max");
    let subscriber = TestSubscriber::at(&broker, OURS);
    until_online(&subscriber);
    let answer = mosquitto_rr(broker.port(), "hallsweep/discovery/command/stop", "site/answer");
    assert_eq!(
        (&answer["topic"], answer["payload"].as_str().map(|said| said.contains("\"accepted\":true"))),
        (&json!("site/answer"), Some(true))
    );
    let properties = &answer["properties"];
    assert_eq!((&properties["content-type"], &properties["user-properties"]["by"]), (&json!("application/json"), &json!("mqtt")));
    // The first result on this topic belongs to the command below.
    let answer = mosquitto_rr(broker.port(), "hallsweep/discovery/command/stop", "hallsweep/discovery/command/stop/result");
    assert_eq!(answer["topic"], "hallsweep/discovery/command/stop/result", "as it would be anyhow");
}
