//! Clients of every kind at once, in a process of their own, until it is ended: readers, streams, commands, and some that behave
//! badly. Only STOP and START are left to the benchmark.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::thread::{sleep, spawn};
use std::time::Duration;

use crate::ask::ask;
use crate::coap::Coap;
use crate::mqtt::Client;
use crate::packets;

/// The word by which the benchmark starts itself as this.
pub(crate) const WORD: &str = "load";

/// What it comes to.
pub(crate) const IN_WORDS: &str = "4 readers, 2 senders of commands, 32 streams, 4 stalled ones and 16 slow requests over HTTP, 2 readers \
                                    and 16 observers over CoAP, 2 publishers, 8 subscribers and 4 stalled ones over MQTT";

/// A reader waits this long between two requests.
const PAUSE: Duration = Duration::from_millis(5);

/// A sender waits this long between two commands: each goes on record, and while anything is on its way to a slow store the
/// robot rests, so that more of them would leave nothing to stop.
const COMMAND_PAUSE: Duration = Duration::from_millis(150);

/// So many messages a publisher sends at once: with its pauses, some thousands a second.
const BURST: usize = 20;

/// One letter of a slow request comes so often.
const LETTER: Duration = Duration::from_millis(500);

/// A client that was turned away comes again after this long.
const AGAIN: Duration = Duration::from_millis(100);

/// Runs until the process is ended.
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

/// Comes again whenever it is over.
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

/// A subscriber to everything, or one that has stalled.
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

/// A temperature is a command like any other, goes on record, and moves nobody.
fn send(address: &str) -> std::io::Result<()> {
    sleep(COMMAND_PAUSE);
    ask(address, "PUT", "/api/v1/temperature", "{\"celsius\":20.5}").map(drop)
}

/// A stream that is read, or one whose reader has stalled.
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

/// A request whose headers come letter by letter, until the door has had enough of it.
fn dawdle(address: &str) -> std::io::Result<()> {
    let mut stream = TcpStream::connect(address)?;
    write!(stream, "GET /api/v1/state HTTP/1.1\r\nHost: {address}\r\nX-Slow: ")?;
    loop {
        stream.write_all(b"x")?;
        sleep(LETTER);
    }
}
