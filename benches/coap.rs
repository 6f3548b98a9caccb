//! Cost of the CoAP door, printed beside libcoap's example server, coap-rs and a bare bound. All are measured in this
//! run with the same load on loopback: CPU per confirmable GET with few and with very many peers, 50 kB in
//! blocks, and the time that a change takes to reach 500 observers. A rival that is not installed is left out. The
//! exit code is not zero when hallsweep cannot be measured, or when it misses a goal that it met before.
//! `cargo bench --bench coap -- peers` runs that part alone; the other parts are `gets`, `blocks` and `fan-out`.
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

#[path = "coap/blocks.rs"]
mod blocks;
#[path = "coap/client.rs"]
mod client;
#[path = "coap/datagram.rs"]
mod datagram;
#[path = "coap/fan_out.rs"]
mod fan_out;
#[path = "coap/figures.rs"]
mod figures;
#[path = "common/goals.rs"]
mod goals;
#[path = "coap/load.rs"]
mod load;
#[path = "coap/rivals.rs"]
mod rivals;
#[path = "coap/server.rs"]
mod server;
#[path = "coap/stage.rs"]
mod stage;

use std::process::ExitCode;
use std::time::Duration;

use figures::{Measured, best_of, median, micros, of, share};
use load::{CLIENTS, FEWEST, Load, Outcome};
use server::{Kind, Server};
use stage::{RESOURCE, photo, prepared, read, reading};

const ALL: [Kind; 4] = [Kind::Hallsweep, Kind::Libcoap, Kind::CoapRs, Kind::Bare];

/// Number of turns; every figure is their median. The servers take turns, so that other load on the machine affects
/// all of them.
const TURNS: usize = 5;

/// Requests per turn.
const GETS: usize = 32_000;

/// Largest shares of coap-rs's and of libcoap's CPU that hallsweep used with `FEWEST` clients when they were first
/// measured.
const BEFORE: (f64, f64) = (0.66, 0.80);

/// Requests per turn, from few peers and from many; each of the many peers sends one.
const PEER_GETS: u32 = 30_000;
const FEW: u32 = 100;

/// Turns with many peers; each turn uses new peers.
const PEER_TURNS: usize = 3;

/// Time limit of a turn; requests that remain then are not sent.
const PEER_LIMIT: Duration = Duration::from_secs(5);

/// Transfers per turn.
const TRANSFERS: usize = 200;

fn main() -> ExitCode {
    rivals::build();
    println!("CoAP on loopback; load average {}", figures::busy());
    let parts: [(&str, fn()); 4] = [("gets", gets), ("peers", peers), ("blocks", block_wise), ("fan-out", fan_out)];
    let named: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    for (name, part) in parts {
        if named.is_empty() || named.iter().any(|word| word == name) {
            part();
        }
    }
    if !named.is_empty() && !parts.iter().any(|(name, _)| named.iter().any(|word| word == name)) {
        goals::left_out(&named.join(" "), true, "no part is called so");
    }
    println!("load average at the end {}", figures::busy());
    goals::exit()
}

/// Starts a server and returns it with its answer to a GET of the measured resource.
fn started(kind: Kind) -> Option<(Server, Vec<u8>)> {
    let server = Server::start(kind)?;
    prepared(&server).map(|body| (server, body))
}

/// CPU that a server uses during `work`, per request that was answered correctly.
fn cost(server: &Server, work: impl FnOnce() -> Outcome) -> (Duration, Outcome) {
    let before = server.cpu();
    let outcome = work();
    let used = server.cpu().saturating_sub(before);
    (used / u32::try_from(outcome.right.max(1)).unwrap_or(u32::MAX), outcome)
}

fn gets() {
    let servers: Vec<_> = ALL.into_iter().filter_map(started).collect();
    let load = |(server, body): &(Server, Vec<u8>)| Load::new(server.address, read(server.kind), body);
    let mut loads: Vec<Load> = servers.iter().map(load).collect();
    for clients in [FEWEST, CLIENTS] {
        println!("\nCPU per CON GET of 119 bytes, {TURNS} × {GETS} requests, {clients} at once:");
        let mut measured: Vec<Measured> = servers.iter().map(|(server, _)| Measured::new(server.kind)).collect();
        for _ in 0..TURNS {
            for ((server, _), (load, measured)) in servers.iter().zip(loads.iter_mut().zip(&mut measured)) {
                measured.add(cost(server, || load.gets(GETS, clients)));
            }
        }
        figures::table(&measured, micros);
        let own = of(&measured, Kind::Hallsweep);
        for (rival, goal, before) in [(Kind::CoapRs, 0.60, BEFORE.0), (Kind::Libcoap, 0.65, BEFORE.1)] {
            let what = format!("CPU per CON GET with {clients} at once, of {}", rival.name());
            match share(&what, own, best_of(&measured, rival)) {
                // With few clients, part of the cost is waking the process up, and hallsweep has never met the goal.
                Some(ratio) if clients == FEWEST => goals::known(&what, ratio, goal, before),
                Some(ratio) => goals::at_most(&what, ratio, goal),
                None => {}
            }
        }
    }
}

fn peers() {
    println!("\nCPU per CON GET of 119 bytes, {PEER_TURNS} × {PEER_GETS} requests: {FEW} peers, then as many peers as requests:");
    for kind in ALL {
        // Few and many peers get separate servers, because the state that many peers leave behind would slow the few.
        let (Some((calm, body)), Some((busy, _))) = (started(kind), started(kind)) else { continue };
        let (mut few, mut many) = (Measured::new(kind), Measured::new(kind));
        let mut of_few = Load::new(calm.address, read(kind), &body);
        let mut of_many = Load::new(busy.address, read(kind), &body);
        let mut memory = vec![busy.memory()];
        for turn in 0..PEER_TURNS as u32 {
            few.add(cost(&calm, || of_few.peers(0, FEW, PEER_GETS, PEER_LIMIT)));
            many.add(cost(&busy, || of_many.peers(turn * PEER_GETS, PEER_GETS, PEER_GETS, PEER_LIMIT)));
            memory.push(busy.memory());
        }
        figures::peers(&few, &many, &memory);
        if kind == Kind::Hallsweep {
            let ratio = many.median().as_secs_f64() / few.median().as_secs_f64().max(1e-9);
            goals::at_most("30,000 peers, of 100 peers", ratio, 1.2);
        }
    }
}

fn block_wise() {
    println!("\nCPU for 50 kB in {} blocks, {TURNS} × {TRANSFERS} transfers, 8 at once:", blocks::BLOCKS);
    let servers: Vec<_> =
        ALL.iter().filter_map(|kind| Server::start(*kind)).filter_map(|server| Some((photo(&server)?, server))).collect();
    let mut measured: Vec<Measured> = servers.iter().map(|(_, server)| Measured::new(server.kind)).collect();
    for _ in 0..TURNS {
        for (((path, bytes), server), measured) in servers.iter().zip(&mut measured) {
            let (each, outcome) = cost(server, || blocks::fetch(server.address, path, bytes, TRANSFERS));
            measured.add((each * blocks::BLOCKS, outcome));
        }
    }
    figures::table(&measured, micros);
}

fn fan_out() {
    let (observers, rounds) = (fan_out::OBSERVERS, fan_out::ROUNDS);
    println!("\n{observers} observers of {RESOURCE}, {rounds} changes, until the last of those that heard within 2 s:");
    let mut measured = Vec::new();
    for kind in [Kind::Hallsweep, Kind::Libcoap, Kind::LibcoapNon, Kind::CoapRs, Kind::Bare] {
        let Some((server, _)) = started(kind) else { continue };
        let before = server.cpu();
        let rounds = fan_out::rounds(server.address, RESOURCE, |celsius| reading(kind, celsius));
        let used = server.cpu().saturating_sub(before) / fan_out::ROUNDS;
        let last = median(rounds.iter().map(|round| round.last).collect());
        let complete = rounds.iter().filter(|round| round.heard == observers).count();
        figures::fan_out(kind, last, &rounds, used);
        measured.push((kind, last, complete));
    }
    let last = |wanted| measured.iter().find(|(kind, ..)| *kind == wanted).map(|(_, last, _)| *last);
    let what = "change → last of 500, of libcoap";
    if let Some(ratio) = share(what, last(Kind::Hallsweep), last(Kind::Libcoap)) {
        goals::at_most(what, ratio, 0.1);
    }
    if let Some((.., complete)) = measured.iter().find(|(kind, ..)| *kind == Kind::Hallsweep) {
        goals::met("every round complete", *complete == rounds as usize);
    }
}
