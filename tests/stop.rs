//! STOP through the real doors and the real main loop, a thousand times each. `benches/stop.rs` measures the time;
//! this test does not depend on time.

#[path = "../benches/common/ask.rs"]
mod ask;
#[path = "../benches/common/coap.rs"]
#[expect(dead_code, reason = "a stop observes nothing")]
mod coap;
#[path = "service/mqtt_attacks/five.rs"]
mod five;
#[path = "service/mqtt_attacks/client.rs"]
#[expect(dead_code, reason = "whoever presses STOP attacks nobody")]
mod mqtt;
#[path = "service/mqtt_attacks/packets.rs"]
#[expect(dead_code, reason = "whoever presses STOP attacks nobody")]
mod packets;
#[path = "stop/test_app.rs"]
mod test_app;

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use hallsweep::storage::sqlite::MemoryStore;
use test_app::{TestApp, Watched};

/// Number of STOPs per door.
const STOPS: u64 = 1000;

/// Interval between checks whether the robot moves.
const GLANCE: Duration = Duration::from_millis(1);

/// Maximum number of checks, which take a minute: much longer than any wait on a busy machine.
const PATIENCE: u32 = 60_000;

/// Waits until the robot has begun `steps` further steps.
fn drive(watched: &Watched, steps: u64) {
    let enough = watched.began.load(Ordering::SeqCst) + steps;
    let mut glances = 0;
    while watched.began.load(Ordering::SeqCst) < enough {
        assert!(glances < PATIENCE, "the robot was started and does not move");
        glances += 1;
        std::thread::sleep(GLANCE);
    }
}

/// Safety S8: the state named in the answer says that the robot stands or is halting. The current state may be newer,
/// but no START has come since.
fn stands(address: &str, answer: &str) {
    let json = |text: &str| {
        let body = text.find('{').map_or("", |begins| &text[begins..]);
        serde_json::from_str::<serde_json::Value>(body).expect("the door answers in JSON")
    };
    let state = json(&ask::ask(address, "GET", "/api/v1/state", "").expect("the door answers"));
    assert!(json(answer)["revision"].as_u64() <= state["revision"].as_u64(), "{answer}: {state}");
    let robot = &state["robot"];
    assert!(robot["state"] == "stopped" || robot["halting"] == true, "{answer}: {robot}");
}

/// Presses START and STOP repeatedly. The distance driven between varies and is often zero. `tell` sends a
/// command and returns its answer.
fn press(watched: &Watched, address: &str, mut tell: impl FnMut(&str) -> String) {
    let mut accepted = |command: &str| {
        let answer = tell(command);
        assert!(answer.contains("\"accepted\":true"), "{command}: {answer}");
        answer
    };
    for n in 1..=STOPS {
        watched.standing.store(false, Ordering::SeqCst);
        accepted("start");
        drive(watched, n % 3);
        let answer = accepted("stop");
        watched.standing.store(true, Ordering::SeqCst);
        assert!(answer.contains(&format!("\"epoch\":{n}")), "stop {n}: {answer}");
        stands(address, &answer);
        assert_eq!(watched.late.load(Ordering::SeqCst), 0, "after stop {n} was answered a step began");
    }
}

async fn no_step_begins_late(app: &TestApp, tell: impl FnMut(&str) -> String + Send + 'static) {
    let (watched, address) = (Arc::clone(&app.watched), app.address.to_string());
    tokio::task::spawn_blocking(move || press(&watched, &address, tell)).await.expect("every stop held the robot");
    let (began, late) = (app.watched.began.load(Ordering::SeqCst), app.watched.late.load(Ordering::SeqCst));
    assert!(began >= STOPS, "only {began} steps were begun: that proves little");
    assert_eq!(late, 0, "a step began after the last stop was answered");
}

/// Safety S6: no step begins after the STOP was answered, in 1,000 STOPs.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_step_begins_after_a_stop_was_answered_over_http() {
    let app = TestApp::open(Box::new(MemoryStore::new()), |_| {}).await;
    let address = app.address.to_string();
    let tell =
        move |command: &str| ask::ask(&address, "POST", &format!("/api/v1/commands/{command}"), "").expect("the door answers");
    no_step_begins_late(&app, tell).await;
}

/// Safety S6.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_step_begins_after_a_stop_was_answered_over_coap() {
    let app = TestApp::open(Box::new(MemoryStore::new()), |_| {}).await;
    let mut client = coap::Coap::at(app.coap);
    let tell = move |command: &str| client.ask("POST", &format!("commands/{command}"), "").expect("the door answers").text;
    no_step_begins_late(&app, tell).await;
}

/// Safety S6.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn no_step_begins_after_a_stop_was_answered_over_mqtt() {
    let app = TestApp::open(Box::new(MemoryStore::new()), |_| {}).await;
    let broker = app.mqtt;
    let coming = tokio::task::spawn_blocking(move || {
        let mut client = mqtt::Client::try_connect(broker, &packets::connect("operator", 60)).expect("the door lets a client in");
        assert_eq!(client.subscribe("hallsweep/discovery/command/+/result", 0), 0);
        client
    });
    let mut client = coming.await.expect("the door lets a client in");
    let tell = move |command: &str| {
        client.publish(&format!("hallsweep/discovery/command/{command}"), b"");
        String::from_utf8_lossy(&client.message().payload).into_owned()
    };
    no_step_begins_late(&app, tell).await;
}
