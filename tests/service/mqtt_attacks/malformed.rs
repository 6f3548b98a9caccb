//! Ten thousand faulty connections, several at a time, half of them in MQTT 5. A failure prints its seed, and
//! `HALLSWEEP_SEED` repeats the run.

use std::net::SocketAddr;

use super::client::Client;
use super::five::dressed;
use super::packets::{CONNACK, connect, connect_with, packet, publish, subscribe, text};
use super::siege::Siege;

/// Total number of connections.
const CONNECTIONS: u64 = 10_000;

/// Number of connections at a time.
const AT_A_TIME: u64 = 8;

/// Number of rounds, in each of which the screen must receive changes of the state.
const LOOKS: u64 = 4;

/// Pseudo-random numbers, equal for equal seeds (splitmix64).
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ mixed >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ mixed >> 31
    }

    /// Number below `bound`.
    fn below(&mut self, bound: usize) -> usize {
        usize::try_from(self.next() % bound as u64).expect("it is less than a usize")
    }

    fn byte(&mut self) -> u8 {
        self.next().to_le_bytes()[0]
    }

    fn bytes(&mut self, most: usize) -> Vec<u8> {
        (0..self.below(most) + 1).map(|_| self.byte()).collect()
    }

    fn one<'a>(&mut self, of: &[&'a str]) -> &'a str {
        of[self.below(of.len())]
    }

    /// Copy of the bytes with some bytes changed, inserted or removed.
    fn spoilt(&mut self, mut bytes: Vec<u8>) -> Vec<u8> {
        for _ in 0..=self.below(3) {
            let place = self.below(bytes.len());
            match self.below(4) {
                0 => bytes.insert(place, self.byte()),
                1 if bytes.len() > 1 => drop(bytes.remove(place)),
                2 => bytes[place] ^= 1 << self.below(8),
                _ => bytes[place] = self.byte(),
            }
        }
        bytes
    }
}

const IDS: [&str; 8] = ["a+", "$", "#", "a/b", "ü", "", "same", "\u{10FFFF}"];
const NAMES: [&str; 13] = [
    "ü",
    "$SYS/#",
    "$share/g/a",
    "#",
    "+/+",
    "a/#/b",
    "",
    "/",
    "a",
    "soup/1",
    "hallsweep/discovery/state/temperature",
    "hallsweep/discovery/command/dance",
    "unibo/qak/robotmind",
];

/// Bytes of one connection.
fn said(chance: &mut Chance) -> Vec<u8> {
    let is_five = chance.below(2) == 0;
    let dress = |packet: Vec<u8>| if is_five { dressed(&packet) } else { packet };
    let id = chance.one(&IDS);
    let hello = dress(connect(id, u16::from(chance.byte())));
    let name = chance.one(&NAMES);
    let (qos, flags) = (chance.byte() % 4, chance.byte() & 9);
    let message = dress(publish(name, &chance.bytes(300), qos, flags, u16::from(chance.byte())));
    let question = dress(subscribe(u16::from(chance.byte()), name, chance.byte() % 64));
    match chance.below(12) {
        0 => chance.bytes(400),
        1 => packet(chance.byte(), &chance.bytes(200)),
        2 => chance.spoilt(hello),
        3 => hello[..chance.below(hello.len())].to_vec(),
        4 => [hello, chance.bytes(400)].concat(),
        5 => [hello, packet(CONNACK, &[0, 0, 0][..2 + chance.below(2)])].concat(),
        6 => [hello, vec![chance.byte(), 0xFF, 0xFF, 0xFF, 0xFF, 0xFF]].concat(),
        7 => [hello, chance.spoilt(message)].concat(),
        8 => [hello, question, message, chance.bytes(20)].concat(),
        9 => [hello, chance.spoilt(question), message].concat(),
        10 => connect_with(chance.byte(), chance.byte(), 1, &[text(id), text(name), text(name), chance.bytes(20)].concat()),
        _ => (0..5).flat_map(|_| packet(chance.byte(), &chance.bytes(20))).fold(hello, |said, byte| [said, vec![byte]].concat()),
    }
}

/// Opens `connections` connections, one after the other.
fn pester(broker: SocketAddr, seed: u64, connections: u64) {
    let mut chance = Chance(seed);
    for _ in 0..connections {
        let bytes = said(&mut chance);
        let mut client = Client::silent(broker);
        client.try_say(&bytes);
        // Some connections wait for the end. Others close at once and leave the answers unread.
        if chance.below(3) > 0 {
            client.hang_up();
        }
    }
}

/// Safety A7.
#[test]
fn ten_thousand_malformed_connections_disturb_nobody() {
    let seed = std::env::var("HALLSWEEP_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    eprintln!("the seed is {seed}");
    let mut siege = Siege::begin();
    let (broker, each) = (siege.broker, CONNECTIONS / AT_A_TIME / LOOKS);
    for look in 0..LOOKS {
        std::thread::scope(|scope| {
            for n in 0..AT_A_TIME {
                scope.spawn(move || pester(broker, seed ^ (look * AT_A_TIME + n) << 32, each));
            }
            siege.is_served();
        });
        siege.is_served();
    }
    siege.stands();
}
