//! Crowds: silent clients over TCP and WebSocket, and clients with ever new names. A new client is still accepted.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};

use super::client::Client;
use super::packets::{SUBACK, connect, subscribe, subscribe_all};
use super::siege::Siege;
use crate::program::{Deadline, PATIENCE};

/// Number of silent clients.
const IDLE: usize = 300;

/// Tolerance for descriptors that other activity opens and closes.
const SLACK: usize = 16;

/// HTTP request with which a web client opens its WebSocket.
fn opening(host: SocketAddr) -> String {
    format!(
        "GET /mqtt HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: mqtt\r\n\r\n"
    )
}

/// A web client that was accepted and then says nothing.
pub(crate) fn web_client(host: SocketAddr) -> TcpStream {
    let mut stream = TcpStream::connect(host).expect("the program listens");
    stream.set_read_timeout(Some(PATIENCE)).expect("a wait is more than nothing");
    stream.write_all(opening(host).as_bytes()).expect("the program takes it");
    let mut answer = Vec::new();
    while !answer.ends_with(b"\r\n\r\n") {
        let mut byte = [0];
        stream.read_exact(&mut byte).expect("an answer");
        answer.extend(byte);
    }
    assert!(answer.starts_with(b"HTTP/1.1 101 "), "{}", String::from_utf8_lossy(&answer));
    stream
}

/// A WebSocket frame of a client. The mask is zero, which is valid.
pub(crate) fn framed(bytes: &[u8]) -> Vec<u8> {
    let length = u8::try_from(bytes.len()).ok().filter(|length| *length < 126).expect("packets of this test are short");
    [&[0x82, 0x80 | length, 0, 0, 0, 0], bytes].concat()
}

/// Safety A5.
#[test]
fn three_hundred_clients_that_say_nothing_keep_nobody_out() {
    let mut siege = Siege::begin();
    let mut idle: Vec<Client> = (0..IDLE).map(|_| Client::silent(siege.broker)).collect();
    for (n, client) in idle.iter_mut().enumerate() {
        // Some clients send a part of a CONNECT.
        client.say(&connect("slow", 60)[..n % 10]);
    }
    siege.stands();
    let newcomers: Vec<Client> = (0..100).map(|n| siege.client(&n.to_string())).collect();
    siege.stands();
    drop((idle, newcomers));
    siege.stands();
}

/// Safety A5.
#[test]
fn three_hundred_web_clients_that_say_nothing_keep_nobody_out() {
    let mut siege = Siege::begin();
    let (http, before) = (siege.program.address(), siege.descriptors());
    let idle: Vec<TcpStream> = (0..IDLE).map(|_| web_client(http)).collect();
    siege.stands();
    let deadline = Deadline::within(PATIENCE);
    while siege.descriptors() > before + 64 + SLACK {
        assert!(!deadline.has_passed(), "those who were let go of are kept: {}, and {before} before", siege.descriptors());
    }
    let mut newcomer = web_client(http);
    newcomer.write_all(&framed(&connect("web", 60))).expect("the program takes it");
    newcomer.write_all(&framed(&subscribe(1, "hallsweep/discovery/availability", 0))).expect("the program takes it");
    let mut answer = Vec::new();
    while !answer.windows(6).any(|window| window == b"online") {
        let mut byte = [0];
        newcomer.read_exact(&mut byte).expect("the state comes");
        answer.extend(byte);
    }
    assert!(answer.windows(4).any(|window| window == [0x20, 2, 0, 0]), "it was greeted: {answer:?}");
    drop(idle);
    siege.stands();
}

/// Safety A5: each WebSocket ping has an answer, which waits if the client does not read.
#[test]
fn pings_of_web_clients_that_read_nothing_take_no_memory() {
    let mut siege = Siege::begin();
    let before = siege.memory_mib();
    let ping = [&[0x89, 0xFD, 0, 0, 0, 0][..], &[b'x'; 125]].concat();
    let mut clients: Vec<TcpStream> = (0..2).map(|_| web_client(siege.program.address())).collect();
    for (n, client) in clients.iter_mut().enumerate() {
        client.write_all(&framed(&connect(&format!("pinging-{n}"), 0))).expect("the program takes it");
        // 26 MB of pings, and the same amount of answers.
        for _ in 0..200 {
            client.write_all(&ping.repeat(1_000)).expect("the program takes it");
        }
    }
    let memory = siege.memory_mib();
    assert!(memory < before + 20, "{memory} MiB, and {before} before");
    siege.stands();
}

/// Safety A5.
#[test]
fn thousands_of_names_filters_and_topics_are_borne() {
    let mut siege = Siege::begin();
    for n in 0..2_000 {
        let mut client = siege.client(&format!("client-{n}"));
        if n % 50 == 0 {
            for filter in 0..64 {
                client.say(&subscribe(1, &format!("many/{n}/{filter}"), 1));
            }
        }
        for topic in 0..10 {
            client.publish(&format!("topics/{n}/{topic}"), b"x");
        }
        client.settle();
    }
    siege.stands();
    let memory = siege.memory_mib();
    assert!(memory < 150, "{memory} MiB");
}

/// Home Assistant subscribes to the topics of all its devices in packets of 500 filters; the topics of hallsweep may
/// come last.
#[test]
fn a_client_with_a_thousand_filters_is_served_on_the_last_of_them() {
    Siege::in_both(|mut siege| {
        let mut hub = siege.client("hub");
        let state = "hallsweep/discovery/state/temperature".to_owned();
        let names = (0..999).map(|n| format!("zigbee2mqtt/device {n}/availability")).chain([state.clone()]);
        for packet in names.collect::<Vec<_>>().chunks(500) {
            hub.say(&subscribe_all(1, packet));
            assert_eq!(hub.until(SUBACK).body[2..], [0; 500]);
        }
        assert_eq!(hub.message().topic, state);
        siege.stands();
    });
}
