//! Capacity of the MQTT door, printed beside rumqttd alone, a bound of two bare sockets, and mosquitto. All are
//! measured in this run with the same load on loopback: messages per second to one and to ten subscribers at QoS
//! 0 and 1, the latency of single messages, and memory after a million messages. A rival that is not installed is
//! left out. The exit code is not zero when hallsweep cannot be measured, or when it misses a goal that it met
//! before.
//! `cargo bench --bench mqtt -- latency` runs that part alone; the other parts are `fan-out` and `memory`.
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

#[path = "mqtt/bare.rs"]
mod bare;
#[path = "mqtt/bound.rs"]
mod bound;
#[path = "mqtt/figures.rs"]
mod figures;
#[path = "mqtt/frame.rs"]
mod frame;
#[path = "common/goals.rs"]
mod goals;
#[path = "mqtt/load.rs"]
mod load;
#[path = "mqtt/paced.rs"]
mod paced;
#[path = "mqtt/server.rs"]
mod server;
#[path = "mqtt/wire.rs"]
mod wire;

use std::process::ExitCode;
use std::time::Duration;

use figures::{Measured, median};
use load::Load;
use server::{Kind, Server};

const ALL: [Kind; 5] = [Kind::Hallsweep, Kind::Linked, Kind::Bare, Kind::Bound, Kind::Mosquitto];

/// Number of turns; every figure is their median. The servers take turns, so that other load on the machine affects
/// all of them.
const TURNS: usize = 5;

/// Publishing time per turn.
const TURN: Duration = Duration::from_secs(1);

/// Maximum number of messages on the way to the slowest subscriber where the publisher waits; no server loses a
/// message at this number.
const WINDOW: u64 = 2000;

/// Messages per turn in the latency part.
const SINGLE: usize = 1000;

/// Messages before memory is read: this number to one subscriber, and the same total to ten.
const MILLION: u64 = 1_000_000;

/// Largest ratio of the latency of single messages to mosquitto's.
const LATENCY: f64 = 1.2;

/// Largest ratio that was measured on a machine with some other load.
const LATENCY_BEFORE: f64 = 1.3;

/// Memory limit in MB (10⁶ bytes).
const MEMORY: f64 = 48.0;

/// Time limit for a million messages.
const PATIENCE: Duration = Duration::from_secs(120);

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    if let [who, port] = &words[..]
        && [Kind::Bound.name(), Kind::Bare.name()].contains(&who.as_str())
    {
        let port = port.parse().expect("the benchmark calls itself with a port");
        if who == Kind::Bound.name() {
            bound::serve(port)
        } else {
            bare::serve(port)
        }
        return ExitCode::SUCCESS;
    }
    println!("MQTT on loopback, {} bytes a message; load average {}", load::LENGTH, figures::busy());
    let parts: [(&str, fn()); 3] = [("fan-out", fan_out), ("latency", latency), ("memory", memory)];
    for (name, part) in parts {
        if words.is_empty() || words.iter().any(|word| word == name) {
            part();
        }
    }
    if !words.is_empty() && !parts.iter().any(|(name, _)| words.iter().any(|word| word == name)) {
        goals::left_out(&words.join(" "), true, "no part is called so");
    }
    println!("load average at the end {}", figures::busy());
    goals::exit()
}

fn fan_out() {
    let servers: Vec<Server> = ALL.into_iter().filter_map(Server::start).collect();
    for window in [None, Some(WINDOW)] {
        for (qos, subscribers) in [(0, 1), (0, 10), (1, 1), (1, 10)] {
            let publisher = window.map_or("who waits for nobody".to_owned(), |most| format!("with at most {most} under way"));
            println!("\nQoS {qos}, 1 → {subscribers}, a publisher {publisher}; messages that came, {TURNS} × {TURN:?}:");
            let load = Load { qos, subscribers, messages: u64::MAX, lasting: TURN, window };
            let measured = turns(&servers, load);
            figures::table(&measured);
            if window.is_some() {
                figures::faster(&measured, Kind::Bare, 1.0);
                continue;
            }
            if let Some(own) = figures::of(&measured, Kind::Hallsweep) {
                goals::met("every message came", own.is_whole());
            }
            let goal = match (qos, subscribers) {
                (0, 10) => 8.0,
                (1, 1) => 4.0,
                _ => 2.0,
            };
            figures::faster(&measured, Kind::Mosquitto, goal);
        }
    }
}

fn turns(servers: &[Server], load: Load) -> Vec<Measured> {
    let mut measured: Vec<Measured> = servers.iter().map(|server| Measured::new(server.kind)).collect();
    for _ in 0..TURNS {
        for (server, measured) in servers.iter().zip(&mut measured) {
            let before = server.cpu();
            let outcome = load::run(server.address, load);
            measured.add(outcome, server.cpu().saturating_sub(before));
        }
    }
    measured
}

fn latency() {
    let servers: Vec<Server> = ALL.into_iter().filter_map(Server::start).collect();
    for qos in [0, 1] {
        println!("\nQoS {qos}, 500 single messages a second, from publisher to subscriber; {TURNS} × {SINGLE}:");
        let mut worst: Vec<(Kind, Vec<f64>, Vec<f64>)> = servers.iter().map(|one| (one.kind, vec![], vec![])).collect();
        for _ in 0..TURNS {
            for (server, (kind, halves, most)) in servers.iter().zip(&mut worst) {
                match paced::run(server.address, qos, SINGLE) {
                    Ok(took) if took.len() == SINGLE => {
                        halves.push(took[SINGLE / 2].as_secs_f64() * 1e6);
                        most.push(took[SINGLE * 95 / 100].as_secs_f64() * 1e6);
                    }
                    failed => kind.left_out(&format!("{:?} of {SINGLE} came in one turn", failed.map(|took| took.len()))),
                }
            }
        }
        for (kind, halves, most) in &worst {
            println!("  {:<12} p50 {:>5.0} µs  p95 {:>5.0} µs  ({most:.0?})", kind.name(), median(halves), median(most));
        }
        let of = |wanted| worst.iter().find(|(kind, ..)| *kind == wanted).map(|(_, half, most)| [median(half), median(most)]);
        let both = of(Kind::Hallsweep).zip(of(Kind::Mosquitto));
        for (which, what) in ["p50, of mosquitto", "p95, of mosquitto"].into_iter().enumerate() {
            match both {
                Some((own, other)) => goals::known(what, own[which] / other[which].max(1e-9), LATENCY, LATENCY_BEFORE),
                None => goals::not_judged(what),
            }
        }
    }
}

fn memory() {
    println!("\nmemory in MB: at first, after {MILLION} messages 1 → 1, after as many more 1 → 10, at its most:");
    for kind in ALL {
        let Some(server) = Server::start(kind) else { continue };
        let mut looks = vec![server.memory().0];
        for subscribers in [1, 10] {
            let messages = MILLION / subscribers as u64;
            let load = Load { qos: 0, subscribers, messages, lasting: PATIENCE, window: None };
            if let Err(error) = load::run(server.address, load) {
                kind.left_out(&error.to_string());
            }
            looks.push(server.memory().0);
        }
        let most = server.memory().1;
        println!("  {:<12} {looks:>5.1?}  {most:>5.1}", kind.name());
        if kind == Kind::Hallsweep {
            goals::at_most("memory at its most, in MB", most, MEMORY);
        }
    }
}
