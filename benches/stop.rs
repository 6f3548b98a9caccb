//! Time of a STOP from the request to the robot's port, while every door is under load and the store is slow or hangs
//! (safety S6), beside a plain request under the same load. `tests/stop.rs` tests what does not depend on time.
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

#[path = "common/ask.rs"]
mod ask;
#[path = "common/coap.rs"]
mod coap;
#[path = "../tests/service/mqtt_attacks/five.rs"]
mod five;
#[path = "common/goals.rs"]
#[expect(dead_code, reason = "nobody is compared with")]
mod goals;
#[path = "stop/load.rs"]
mod load;
#[path = "../tests/service/mqtt_attacks/client.rs"]
#[expect(dead_code, reason = "whoever presses STOP attacks nobody")]
mod mqtt;
#[path = "../tests/service/mqtt_attacks/packets.rs"]
#[expect(dead_code, reason = "whoever presses STOP attacks nobody")]
mod packets;
#[path = "stop/tardy.rs"]
mod tardy;
#[path = "../tests/stop/test_app.rs"]
mod test_app;

use std::net::SocketAddr;
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use tardy::{Keeping, Tardy};
use test_app::TestApp;

/// Number of STOPs per door: half of them with a slow store, half with a hung one.
const STOPS: u64 = 1000;

/// Goals of safety S6.
const P99: Duration = Duration::from_millis(50);
const WORST: Duration = Duration::from_millis(100);

/// Time that a slow store takes per page, like a disk under other load.
const SLOW: Duration = Duration::from_millis(10);

/// Time from the beginning of the load to the first STOP.
const WARM_UP: Duration = Duration::from_secs(2);

/// Time limit for the robot to begin a step or to receive a halt, much longer than either takes.
const PATIENCE: Duration = Duration::from_secs(10);

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip_while(|word| word != load::WORD).collect();
    if let [_, http, doors @ ..] = &words[..] {
        let [coap, mqtt, ..] = doors else { panic!("the benchmark gives three addresses") };
        load::press(http, [coap, mqtt].map(|door| door.parse().expect("the benchmark gives addresses")));
        return ExitCode::SUCCESS;
    }
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().expect("the system gives threads");
    let (store, keeping) = Tardy::start(SLOW);
    let (heard, halts) = channel();
    let app = runtime.block_on(TestApp::open(Box::new(store), move |halts| {
        // The receiver is gone when the benchmark has all its STOPs.
        let _ = heard.send((halts.epoch.0, Instant::now()));
    }));
    let address = app.address.to_string();
    let load = Load::start(&address, [app.coap, app.mqtt]);
    std::thread::sleep(WARM_UP);
    let bench = Bench { address, app, halts, keeping };
    println!("STOP, request → robot port, with {}:", load::IN_WORDS);
    let mut by_coap = coap::Coap::at(bench.app.coap);
    let tell = |command: &str| by_coap.ask("POST", &format!("commands/{command}"), "").expect("the door answers").text;
    let (slow_coap, hung_coap) = bench.both(0, tell);
    let tell =
        |command: &str| ask::ask(&bench.address, "POST", &format!("/api/v1/commands/{command}"), "").expect("the door answers");
    let (slow, hung) = bench.both(STOPS, tell);
    let mut by_mqtt =
        mqtt::Client::try_connect(bench.app.mqtt, &packets::connect("operator", 60)).expect("the door lets a client in");
    by_mqtt.subscribe("hallsweep/discovery/command/+/result", 0);
    let tell = |command: &str| {
        by_mqtt.publish(&format!("hallsweep/discovery/command/{command}"), b"");
        String::from_utf8_lossy(&by_mqtt.message().payload).into_owned()
    };
    let (slow_mqtt, hung_mqtt) = bench.both(2 * STOPS, tell);
    let bare = bench.bare_requests();
    drop(load);
    judge("HTTP, slow store", slow);
    judge("HTTP, hung store", hung);
    judge("CoAP, slow store", slow_coap);
    judge("CoAP, hung store", hung_coap);
    judge("MQTT, slow store", slow_mqtt);
    judge("MQTT, hung store", hung_mqtt);
    let _ = print("bare request", bare);
    let (began, late) = (bench.app.watched.began.load(Ordering::SeqCst), bench.app.watched.late.load(Ordering::SeqCst));
    goals::met(&format!("no step begins after a stop was answered: {late} of {began}"), late == 0);
    goals::exit()
}

/// The load, in a separate process that ends when this value is dropped.
struct Load(Child);

impl Load {
    fn start(http: &str, [coap, mqtt]: [SocketAddr; 2]) -> Load {
        let own = std::env::current_exe().expect("the system knows which program this is");
        let load = Command::new(own).args([load::WORD, http, &coap.to_string(), &mqtt.to_string()]).stdin(Stdio::null()).spawn();
        Load(load.expect("this program starts a second time"))
    }
}

impl Drop for Load {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

struct Bench {
    address: String,
    app: TestApp,
    halts: Receiver<(u64, Instant)>,
    keeping: Keeping,
}

impl Bench {
    /// Times of the STOPs over one door with a slow store, then with a hung one. `before` is the number of earlier
    /// STOPs; `tell` sends a command through the door.
    fn both(&self, before: u64, mut tell: impl FnMut(&str) -> String) -> (Vec<Duration>, Vec<Duration>) {
        let mut accepted = |command: &str| {
            let answer = tell(command);
            assert!(answer.contains("\"accepted\":true"), "{command}: {answer}");
        };
        let (first, middle, last) = (before + 1, before + STOPS / 2, before + STOPS);
        (self.stops(first, middle, false, &mut accepted), self.stops(middle + 1, last, true, &mut accepted))
    }

    /// Times of these STOPs, each given while the robot moves. When `hangs` is set, the store hangs from the robot's
    /// first movement until the STOP is answered, because a START could not be recorded while it hangs.
    fn stops(&self, first: u64, last: u64, hangs: bool, mut accepted: impl FnMut(&str)) -> Vec<Duration> {
        let took = |epoch| {
            self.app.watched.standing.store(false, Ordering::SeqCst);
            accepted("start");
            self.drive();
            self.keeping.hang(hangs);
            let asked = Instant::now();
            accepted("stop");
            self.app.watched.standing.store(true, Ordering::SeqCst);
            self.keeping.hang(false);
            self.heard(epoch).duration_since(asked)
        };
        (first..=last).map(took).collect()
    }

    fn bare_requests(&self) -> Vec<Duration> {
        let took = |_| {
            let asked = Instant::now();
            let answer = ask::ask(&self.address, "GET", "/healthz", "").expect("the door answers");
            let took = asked.elapsed();
            assert!(answer.contains(" 200 "), "{answer}");
            took
        };
        (0..STOPS).map(took).collect()
    }

    /// Waits until the robot begins a step.
    fn drive(&self) {
        let (began, since) = (self.app.watched.began.load(Ordering::SeqCst), Instant::now());
        while self.app.watched.began.load(Ordering::SeqCst) == began {
            assert!(since.elapsed() < PATIENCE, "the robot was started and does not move");
            std::thread::sleep(Duration::from_micros(200));
        }
    }

    /// Time when the halt of the STOP with this epoch reached the robot's port.
    fn heard(&self, epoch: u64) -> Instant {
        loop {
            let (at, when) = self.halts.recv_timeout(PATIENCE).expect("every stop comes to the robot");
            if at >= epoch {
                return when;
            }
        }
    }
}

/// Prints the times and compares them with the goals.
fn judge(what: &str, took: Vec<Duration>) {
    let (p99, worst) = print(what, took);
    goals::met(&format!("{what}: p99 ≤ {P99:?}, worst ≤ {WORST:?}"), p99 <= P99 && worst <= WORST);
}

/// Prints the times; returns the 99th percentile and the worst.
fn print(what: &str, mut took: Vec<Duration>) -> (Duration, Duration) {
    took.sort_unstable();
    let at = |percent: usize| took[(took.len() * percent / 100).min(took.len() - 1)];
    println!("  {what:<16} {:4} × p50 {:>9.2?}  p99 {:>9.2?}  worst {:>9.2?}", took.len(), at(50), at(99), at(100));
    (at(99), at(100))
}
