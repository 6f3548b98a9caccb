//! The three doors agree: a mission is followed on the event stream, by observing over CoAP and over MQTT at once. A revision that is
//! seen on two of them has the same content on both, and the last one is the same on all.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use serde_json::{Value, json};

use super::client::Client;
use super::running::RunningClient;
use super::told::{Hello, Say};
use super::{OURS, command};
use crate::coap::client::Coap;
use crate::coap_clients::shown;
use crate::program::{Deadline, Program};
use crate::replica::patched;
use crate::stream::Events;

/// The resources that carry their revision.
const REVISED: [&str; 4] = ["mission", "robot", "map", "temperature"];

/// Those that do not.
const UNREVISED: [&str; 2] = ["luggage", "alarms"];

/// The last temperature that is reported: whoever sees it has seen everything before.
const LAST: f64 = 19.25;

/// How long the doors may take to show what stands, and how often they are looked at meanwhile.
const PATIENCE: Duration = Duration::from_secs(60);
const GLANCE: Duration = Duration::from_millis(20);

/// What was seen at a door: of each resource each revision.
type Seen = BTreeMap<(&'static str, u64), Value>;

/// A door that is watched in a thread of its own.
#[derive(Clone, Default)]
struct Watched(Arc<Mutex<Seen>>);

impl Watched {
    /// Notes a resource; what carries the revision of one that was noted must be the same.
    fn note(&self, resource: &'static str, content: Value) {
        let revision = content["revision"].as_u64().unwrap_or_else(|| panic!("{resource} without a revision: {content}"));
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = seen.insert((resource, revision), content.clone());
        assert!(before.as_ref().is_none_or(|before| *before == content), "{resource} {revision}: {before:?} and {content}");
    }

    fn seen(&self) -> Seen {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Whether its newest of each resource is what stands.
    fn shows(&self, state: &Value) -> bool {
        let seen = self.seen();
        REVISED.iter().all(|resource| {
            let newest = seen.range((*resource, 0)..=(*resource, u64::MAX)).next_back();
            newest.is_some_and(|(_, content)| *content == state[*resource])
        })
    }
}

fn is_last(temperature: &Value) -> bool {
    temperature["celsius"] == LAST
}

/// The event stream; the map comes by changed cells. At the end it tells what it saw last of what carries no revision.
fn follow_stream(program: &Program) -> (Watched, JoinHandle<BTreeMap<&'static str, Value>>) {
    let (watched, mut events) = (Watched::default(), Events::open(program, None));
    let into = watched.clone();
    let thread = std::thread::spawn(move || {
        let (mut map, mut others) = (Value::Null, BTreeMap::new());
        loop {
            let event = events.next();
            for resource in UNREVISED.into_iter().filter(|resource| !event.data[*resource].is_null()) {
                others.insert(resource, event.data[resource].clone());
            }
            for resource in REVISED.into_iter().filter(|resource| !event.data[*resource].is_null()) {
                let newer = &event.data[resource];
                let content = if resource == "map" { patched(&map, newer) } else { newer.clone() };
                if resource == "map" {
                    map = content.clone();
                }
                into.note(resource, content);
            }
            if is_last(&event.data["temperature"]) {
                return others;
            }
        }
    });
    (watched, thread)
}

/// Every resource is observed by a client of its own, until it is told to end.
fn observe(program: &Program, ended: &Arc<AtomicBool>) -> (Watched, Vec<JoinHandle<()>>) {
    let watched = Watched::default();
    let threads = REVISED.map(|resource| {
        let (into, ended, mut client) = (watched.clone(), Arc::clone(ended), Coap::at(program.coap()));
        let first = client.observe(resource).expect("the door answers");
        std::thread::spawn(move || {
            let mut news = Some(first);
            while !ended.load(Ordering::Relaxed) {
                if let Some(reply) = news {
                    assert_eq!(reply.code, "2.05");
                    into.note(resource, serde_json::from_str(&reply.text).expect("JSON in one datagram"));
                }
                // There is none while the robot waits for a verdict.
                news = client.next().ok();
            }
        })
    });
    (watched, threads.into())
}

/// What a subscriber has heard.
fn watched(process: &RunningClient) -> Watched {
    let watched = Watched::default();
    for message in process.heard() {
        let resource = message.topic.strip_prefix("hallsweep/discovery/state/");
        if let Some(resource) = REVISED.into_iter().find(|known| Some(*known) == resource) {
            watched.note(resource, message.json());
        }
    }
    watched
}

/// One door gives START, another says safe, a third danger.
fn a_mission(program: &Program, process: &mut RunningClient) {
    process.say(Say::plain(&command("start"), "").at(1));
    let first = program.until_asked();
    let safe = format!("luggage/{first}/verdict");
    let reply = Coap::at(program.coap()).ask("POST", &safe, "{\"verdict\":\"safe\"}").expect("the door answers");
    assert_eq!(reply.code, "2.04", "{reply:?}");
    program.until("the next piece", |state| state["luggage"].as_array().is_some_and(|all| all.len() == 2));
    let second = program.until_asked();
    program.verdict(second, "danger").accepted();
    program.until_phase("bombLocated");
    program.put("/api/v1/temperature", &json!({"celsius": LAST}).to_string()).accepted();
}

/// Waits until every door shows what stands, and returns that.
fn until_all_show(program: &Program, shows: impl Fn(&Value) -> bool) -> Value {
    let deadline = Deadline::within(PATIENCE);
    loop {
        let state = program.json("state");
        if shows(&state) {
            return state;
        }
        assert!(!deadline.has_passed(), "the doors never showed what stands:\n{state:#}");
        std::thread::sleep(GLANCE);
    }
}

/// What was seen at both is the same at both; how much that was of each resource.
fn compare(one: &Seen, other: &Seen) -> BTreeMap<&'static str, usize> {
    let mut both = BTreeMap::new();
    for (revision, content) in one {
        if let Some(there) = other.get(revision) {
            assert_eq!(content, there, "{revision:?}");
            *both.entry(revision.0).or_default() += 1;
        }
    }
    both
}

/// What carries no revision is compared when everything stands; CoAP shows each piece below its own root.
fn compare_the_rest(program: &Program, state: &Value, stream: &BTreeMap<&'static str, Value>, process: &RunningClient) {
    for resource in UNREVISED {
        assert_eq!(stream[resource], state[resource]);
        let topic = format!("hallsweep/discovery/state/{resource}");
        process.until_newest(&topic, "as it stands", |message| message.json() == state[resource]);
    }
    let mut coap = Coap::at(program.coap());
    let mut read = |path: &str| -> Value {
        let reply = coap.ask("GET", path, "").expect("the door answers");
        serde_json::from_str(&reply.text).unwrap_or_else(|error| panic!("{error}: {reply:?}"))
    };
    assert_eq!(read("alarms"), state["alarms"]);
    for piece in shown::state(state.clone())["luggage"].as_array().expect("a list") {
        assert_eq!(read(&format!("luggage/{}", piece["id"])), *piece);
    }
}

#[test]
fn the_three_doors_agree_through_a_mission() {
    if !Client::Mosquitto.is_here() {
        return;
    }
    // Fast, and slow enough for the doors to see the search in the same steps now and then.
    let program = Program::serve("seed", "20");
    let ended = Arc::new(AtomicBool::new(false));
    let (stream, streaming) = follow_stream(&program);
    let (coap, observing) = observe(&program, &ended);
    let mut process = RunningClient::begin(Client::Mosquitto, &program, Hello::following(&[OURS], 1));
    a_mission(&program, &mut process);
    let others = streaming.join().expect("the stream is as it should be");
    let state = until_all_show(&program, |state| stream.shows(state) && coap.shows(state) && watched(&process).shows(state));
    ended.store(true, Ordering::Relaxed);
    observing.into_iter().for_each(|thread| thread.join().expect("what was observed is as it should be"));

    let [stream, coap, mqtt] = [&stream, &coap, &watched(&process)].map(Watched::seen);
    for both in [compare(&stream, &coap), compare(&stream, &mqtt), compare(&coap, &mqtt)] {
        // The search was seen on both, and not its end alone.
        assert!(both.len() == REVISED.len() && both["robot"] > 2 && both["map"] > 2, "{both:?}");
    }
    compare_the_rest(&program, &state, &others, &process);
    process.leave();
}
