//! The three interfaces agree: a mission is followed on the event stream, by CoAP observations and over MQTT at the
//! same time. A revision seen on two of them has the same content on both, and the last revision is the same on all.

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

/// Resources that carry their revision.
const REVISED: [&str; 4] = ["mission", "robot", "map", "temperature"];

/// Resources without a revision.
const UNREVISED: [&str; 2] = ["luggage", "alarms"];

/// Last reported temperature. An interface that shows it has shown everything before it.
const LAST: f64 = 19.25;

/// Longest wait for the interfaces to show the current state, and the interval between two checks.
const PATIENCE: Duration = Duration::from_secs(60);
const GLANCE: Duration = Duration::from_millis(20);

/// Content of each resource at each revision, as seen at one interface.
type Seen = BTreeMap<(&'static str, u64), Value>;

/// Observations of an interface that a separate thread watches.
#[derive(Clone, Default)]
struct Watched(Arc<Mutex<Seen>>);

impl Watched {
    /// Records a resource. Fails if the same revision was recorded with another content.
    fn note(&self, resource: &'static str, content: Value) {
        let revision = content["revision"].as_u64().unwrap_or_else(|| panic!("{resource} without a revision: {content}"));
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = seen.insert((resource, revision), content.clone());
        assert!(before.as_ref().is_none_or(|before| *before == content), "{resource} {revision}: {before:?} and {content}");
    }

    fn seen(&self) -> Seen {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Whether the newest record of each resource equals the current state.
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

/// Follows the event stream, which sends the map as changed cells. At the end the thread returns the last content of
/// the resources without a revision.
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

/// Observes every resource with a separate client until `ended` is set.
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
                // No notification arrives while the robot waits for a verdict.
                news = client.next().ok();
            }
        })
    });
    (watched, threads.into())
}

/// Messages that a subscriber has received so far.
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

/// Runs a mission: START over MQTT, the verdict *safe* over CoAP, and *danger* over HTTP.
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

/// Waits until every interface shows the current state, and returns that state.
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

/// Fails if a revision seen at both interfaces differs. Returns the number of common revisions of each resource.
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

/// Compares the resources without a revision when nothing changes any more. CoAP shows photo paths below its own
/// root.
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
    // Fast, but slow enough for the interfaces to see some of the same steps of the search.
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
        // Both interfaces saw the search, and not only its end.
        assert!(both.len() == REVISED.len() && both["robot"] > 2 && both["map"] > 2, "{both:?}");
    }
    compare_the_rest(&program, &state, &others, &process);
    process.leave();
}
