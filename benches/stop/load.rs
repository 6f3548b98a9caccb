//! Concurrent clients of every kind in a separate process until it is killed: readers, streams, commands, and some
//! that behave badly. STOP and START come from the benchmark alone.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::thread::{sleep, spawn};
use std::time::Duration;

use crate::ask::ask;
use crate::coap::Coap;
use crate::mqtt::Client;
use crate::packets;

/// Argument with which the benchmark starts itself as the load.
pub(crate) const WORD: &str = "load";

pub(crate) const IN_WORDS: &str = "4 readers, 2 senders of commands, 32 streams, 4 stalled ones and 16 slow requests over HTTP, 2 readers \
                                    and 16 observers over CoAP, 2 publishers, 8 subscribers and 4 stalled ones over MQTT";

/// Pause of a reader between two requests.
const PAUSE: Duration = Duration::from_millis(5);

/// Pause of a sender between two commands. The robot waits while a command is being recorded in the slow store, so
/// more commands would leave no movement to stop.
const COMMAND_PAUSE: Duration = Duration::from_millis(150);

/// Messages that a publisher sends at once; with its pauses, this makes some thousands per second.
const BURST: usize = 20;

/// Interval between the letters of a slow request.
const LETTER: Duration = Duration::from_millis(500);

/// Pause before a refused client connects again.
const AGAIN: Duration = Duration::from_millis(100);

/// Runs until the process is killed.
pub(crate) fn press(address: &str, [coap, mqtt]: [SocketAddr; 2]) {
    let of = |count: usize, client: fn(&str) -> std::io::Result<()>| {
        for _ in 0..count {
            let address = address.to_owned();
            spawn(move || again(|| client(&address)));
        }
    };
    of(4, read);
    of(2, send);
    of(32, |address| watch(address, true));
    of(4, |address| watch(address, false));
    of(16, dawdle);
    (0..2).for_each(|_| drop(spawn(move || again(|| read_over_coap(coap)))));
    (0..16).for_each(|_| drop(spawn(move || again(|| observe(coap)))));
    (0..2).for_each(|n| drop(spawn(move || again(|| publish(mqtt, n)))));
    (0..12).for_each(|n| drop(spawn(move || again(|| subscribe(mqtt, n, n < 8)))));
    loop {
        sleep(Duration::from_secs(60));
    }
}

/// Repeats the client whenever it ends.
fn again(mut client: impl FnMut() -> std::io::Result<()>) {
    loop {
        if client().is_err() {
            sleep(AGAIN);
        }
    }
}

fn read_over_coap(door: SocketAddr) -> std::io::Result<()> {
    let mut client = Coap::at(door);
    for resource in ["mission", "robot", "temperature"].into_iter().cycle() {
        client.ask("GET", resource, "")?;
        sleep(PAUSE);
    }
    Ok(())
}

fn publish(door: SocketAddr, n: usize) -> std::io::Result<()> {
    let mut client =
        Client::try_connect(door, &packets::connect(&format!("publisher-{n}"), 60)).expect("the door lets a client in");
    let burst = packets::publish(&format!("load/{n}"), &[b'x'; 100], 0, 0, 0).repeat(BURST);
    while client.try_say(&burst) {
        sleep(PAUSE);
    }
    Err(ErrorKind::BrokenPipe.into())
}

/// A subscriber to all topics, which reads or has stalled.
fn subscribe(door: SocketAddr, n: usize, reads: bool) -> std::io::Result<()> {
    let mut client =
        Client::try_connect(door, &packets::connect(&format!("subscriber-{n}"), 60)).expect("the door lets a client in");
    client.subscribe("#", 0);
    while !reads || client.next().is_some() {
        if !reads {
            sleep(LETTER);
        }
    }
    Err(ErrorKind::BrokenPipe.into())
}

fn observe(door: SocketAddr) -> std::io::Result<()> {
    let mut client = Coap::at(door);
    client.observe("robot")?;
    loop {
        client.next()?;
    }
}

fn read(address: &str) -> std::io::Result<()> {
    for resource in ["state", "map", "luggage"] {
        ask(address, "GET", &format!("/api/v1/{resource}"), "")?;
        sleep(PAUSE);
    }
    Ok(())
}

/// Reports a temperature: a recorded command that does not move the robot.
fn send(address: &str) -> std::io::Result<()> {
    sleep(COMMAND_PAUSE);
    ask(address, "PUT", "/api/v1/temperature", "{\"celsius\":20.5}").map(drop)
}

/// An event stream whose reader reads or has stalled.
fn watch(address: &str, reads: bool) -> std::io::Result<()> {
    let mut stream = TcpStream::connect(address)?;
    write!(stream, "GET /api/v1/events HTTP/1.1\r\nHost: {address}\r\n\r\n")?;
    let mut events = [0; 4096];
    while !reads || stream.read(&mut events)? > 0 {
        if !reads {
            sleep(LETTER);
        }
    }
    Ok(())
}

/// A request whose headers come letter by letter until the door closes the connection.
fn dawdle(address: &str) -> std::io::Result<()> {
    let mut stream = TcpStream::connect(address)?;
    write!(stream, "GET /api/v1/state HTTP/1.1\r\nHost: {address}\r\nX-Slow: ")?;
    loop {
        stream.write_all(b"x")?;
        sleep(LETTER);
    }
}
