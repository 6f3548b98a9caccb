//! Random messages by a seed, half of them damaged, from this machine and from elsewhere: nothing panics, what comes
//! out is well formed, the tables keep their bounds, and strangers get no more than three times what they sent.

use std::collections::HashMap;
use std::net::SocketAddr;
use std::time::Duration;

use crate::rig::chance::Chance;
use coap_endpoint::{Code, limits};

use crate::rig::bench::Bench;
use crate::rig::each_seed;
use crate::rig::message::{Kind, Message, option};

const PATHS: [&str; 12] = [
    "/test",
    "/separate",
    "/large",
    "/obs",
    "/obs-large",
    "/model",
    "/large-update",
    "/large-post",
    "/nowhere",
    "/query?a=1&b",
    "/.well-known/core?rt=*",
    "/create9",
];

const OPTIONS: [u16; 20] = [1, 3, 4, 5, 6, 7, 8, 9, 11, 12, 14, 15, 17, 23, 27, 28, 35, 60, 252, 258];

fn peer(chance: &mut Chance) -> SocketAddr {
    let port = 40_000 + u16::try_from(chance.below(5)).unwrap();
    let last = u8::try_from(chance.below(5)).unwrap();
    if chance.happens(0.5) { ([127, 0, 0, 1 + last], port).into() } else { ([192, 0, 2, last], port).into() }
}

fn message(chance: &mut Chance, heard: &[Message]) -> Message {
    let pick = |chance: &mut Chance, bound: usize| usize::try_from(chance.below(bound as u64)).unwrap();
    if !heard.is_empty() && chance.happens(0.3) {
        let kind = if chance.happens(0.7) { Kind::Ack } else { Kind::Rst };
        return Message::empty(kind, heard[pick(chance, heard.len())].id);
    }
    let id = u16::try_from(chance.below(400)).unwrap();
    let mut message = Message::get(PATHS[pick(chance, PATHS.len())], id);
    message.kind = [Kind::Con, Kind::Con, Kind::Non, Kind::Ack, Kind::Rst][pick(chance, 5)];
    message.code = Code([1, 1, 1, 2, 3, 4, 5, 6, 7, 8, 0, 0x45][pick(chance, 12)]);
    message.token = vec![u8::try_from(chance.below(4)).unwrap(); pick(chance, 9)];
    if chance.happens(0.3) {
        message = message.observe(u32::try_from(chance.below(3)).unwrap());
    }
    if chance.happens(0.3) {
        let block = (u32::try_from(chance.below(6)).unwrap(), chance.happens(0.5), u8::try_from(chance.below(8)).unwrap());
        message = if chance.happens(0.5) { message.block1(block) } else { message.block2(block) };
    }
    if chance.happens(0.2) {
        let value: Vec<u8> = (0..chance.below(5)).map(|_| chance.number().to_le_bytes()[0]).collect();
        message = message.with(OPTIONS[pick(chance, OPTIONS.len())], &value);
    }
    let echo = heard.iter().rev().find_map(|heard| heard.values(option::ECHO).first().map(|echo| echo.to_vec()));
    if let Some(echo) = echo.filter(|_| chance.happens(0.1)) {
        message = message.with(option::ECHO, &echo);
    }
    if chance.happens(0.5) {
        message = message.payload(vec![b'x'; [0, 1, 15, 16, 32, 64, 1024, 1400][pick(chance, 8)]]);
    }
    message
}

/// Changes, removes or adds some bytes.
fn spoilt(mut bytes: Vec<u8>, chance: &mut Chance) -> Vec<u8> {
    for _ in 0..chance.below(4) {
        let place = usize::try_from(chance.below(bytes.len() as u64 + 1)).unwrap();
        match chance.below(3) {
            0 => bytes.truncate(place),
            1 => bytes.insert(place, chance.number().to_le_bytes()[0]),
            _ => bytes.get_mut(place).into_iter().for_each(|byte| *byte = chance.number().to_le_bytes()[0]),
        }
    }
    bytes
}

/// What one stranger sent and received while it cannot have proved its address.
#[derive(Default)]
struct Account {
    received: usize,
    sent: usize,
    may_be_proved: bool,
}

fn cook(seed: u64) {
    let mut chance = Chance::new(seed, "soup");
    let mut bench = Bench::seeded(seed);
    let mut heard: HashMap<SocketAddr, Vec<Message>> = HashMap::new();
    let mut accounts: HashMap<SocketAddr, Account> = HashMap::new();
    for turn in 0..2_500 {
        let peer = peer(&mut chance);
        let its = heard.entry(peer).or_default();
        let message = message(&mut chance, its);
        let account = accounts.entry(peer).or_default();
        // Only an Echo that it received proves the address; random ones are shorter.
        account.may_be_proved |= message.values(option::ECHO).iter().any(|echo| echo.len() > 4);
        let bytes = if chance.happens(0.5) { spoilt(message.encoded(), &mut chance) } else { message.encoded() };
        account.received += bytes.len();
        if chance.happens(0.5) {
            bench.hear(peer, &bytes);
        } else {
            bench.take_turn();
            bench.deliver(peer, &bytes);
        }
        if chance.happens(0.1) {
            let wait_ms = [1, 30, 600, 4_000, 300_000][usize::try_from(chance.below(5)).unwrap()];
            bench.wait(Duration::from_millis(wait_ms));
        }
        if chance.happens(0.1) && bench.server.things.contains_key("/obs") {
            bench.change(|server| server.set("/obs", format!("seen {turn}")));
            bench.change(|server| server.set_model(turn % 3, &format!("turn {turn}")));
        }
        taste(&mut bench, &mut heard, &mut accounts);
    }
}

fn taste(bench: &mut Bench, heard: &mut HashMap<SocketAddr, Vec<Message>>, accounts: &mut HashMap<SocketAddr, Account>) {
    for out in bench.take() {
        assert!(out.bytes.len() <= limits::BLOCK + limits::HEAD, "a datagram of {} bytes", out.bytes.len());
        let account = accounts.entry(out.peer).or_default();
        account.sent += out.bytes.len();
        let is_fair = account.sent <= 3 * account.received || account.may_be_proved || out.peer.ip().is_loopback();
        assert!(is_fair, "{} got {} bytes for {}", out.peer, account.sent, account.received);
        heard.entry(out.peer).or_default().push(Message::decoded(&out.bytes));
    }
    let counts = bench.endpoint.counts();
    assert!(counts.exchanges <= 2 * limits::EXCHANGES && counts.open <= limits::OPEN, "{counts:?}");
    assert!(counts.observers <= 25 * limits::OBSERVERS_OF_A_PEER && counts.assemblies <= limits::ASSEMBLIES, "{counts:?}");
    assert!(counts.reliable <= 50 * (limits::WAITING + 1) && counts.peers <= 3 * limits::PEERS, "{counts:?}");
}

#[test]
fn a_soup_of_messages_harms_nothing() {
    each_seed(30, cook);
}

#[test]
fn bytes_by_chance_harm_nothing() {
    each_seed(20, |seed| {
        let mut chance = Chance::new(seed, "bytes");
        let mut bench = Bench::seeded(seed);
        for _ in 0..3_000 {
            let length = chance.below(40);
            let mut bytes: Vec<u8> = (0..length).map(|_| chance.number().to_le_bytes()[0]).collect();
            if let Some(first) = bytes.first_mut().filter(|_| chance.happens(0.9)) {
                *first = 0x40 | (*first & 0x3F);
            }
            let peer = peer(&mut chance);
            bench.deliver(peer, &bytes);
            for out in bench.take() {
                Message::decoded(&out.bytes);
            }
        }
    });
}
