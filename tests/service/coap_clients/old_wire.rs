//! The datagrams of the old console and its Californium client, sent byte by byte as that client sent them, without
//! any client library.

use std::io::ErrorKind;
use std::net::{SocketAddr, UdpSocket};
use std::time::Duration;

use super::observer::items;
use super::{serve, shown};
use crate::program::Deadline;

/// Longest wait for a datagram.
const PATIENCE: Duration = Duration::from_secs(60);

/// First byte of a CON message: version 1, with a token of 8 bytes.
const CON: u8 = 0x48;

/// Numbers of types, codes and options (RFC 7252, section 12).
const ACK: u8 = 2;
const GET: u8 = 1;
const PUT: u8 = 3;
const CHANGED: u8 = 0x44;
const CONTENT: u8 = 0x45;
const OBSERVE: u16 = 6;

/// The old console's CoAP client, which sends all requests from one socket.
struct Console {
    socket: UdpSocket,
    next_id: u16,
}

/// A datagram, parsed.
#[derive(Debug)]
struct Message {
    kind: u8,
    code: u8,
    id: u16,
    token: Vec<u8>,
    observe: Option<u32>,
    payload: String,
}

impl Console {
    fn at(door: SocketAddr) -> Console {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        socket.connect(door).expect("an address of this machine");
        socket.set_read_timeout(Some(PATIENCE)).expect("a time-out that is not zero");
        Console { socket, next_id: 0x1e5f }
    }

    /// Sends a GET that observes `/resourcemodel`.
    fn observe(&mut self, token: [u8; 8]) -> Message {
        // 0x60 is Observe (option 6) with an empty value, which means 0. 0x5d is Uri-Path (option 11) with 13 bytes.
        self.send(GET, token, &[&[0x60, 0x5d, 0x00], b"resourcemodel".as_slice()].concat());
        self.receive()
    }

    /// Sends a PUT of a word to `/resourcemodel`, as text/plain, which is an option with an empty value.
    fn put(&mut self, token: [u8; 8], word: &str) -> u16 {
        self.send(PUT, token, &[&[0xbd, 0x00], b"resourcemodel".as_slice(), &[0x10, 0xff], word.as_bytes()].concat())
    }

    fn send(&mut self, code: u8, token: [u8; 8], rest: &[u8]) -> u16 {
        let id = self.next_id;
        self.next_id += 1;
        let datagram = [&[CON, code], id.to_be_bytes().as_slice(), &token, rest].concat();
        self.socket.send(&datagram).expect("the door is there");
        id
    }

    /// Next datagram. A CON message is acknowledged.
    fn receive(&self) -> Message {
        let mut datagram = [0; 2048];
        let length = loop {
            match self.socket.recv(&mut datagram) {
                // A child process of another test ended, and its signal interrupted the read.
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                heard => break heard.expect("the door says something"),
            }
        };
        let message = Message::read(&datagram[..length]);
        if message.kind == 0 {
            self.socket.send(&[&[0x60, 0x00], message.id.to_be_bytes().as_slice()].concat()).expect("the door is there");
        }
        message
    }

    /// Reads until the answer to this token arrives. All other messages are stored in `seen`.
    fn answer(&self, token: [u8; 8], seen: &mut Vec<Message>) -> Message {
        let deadline = Deadline::within(PATIENCE);
        loop {
            let message = self.receive();
            if message.token == token {
                return message;
            }
            seen.push(message);
            assert!(!deadline.has_passed(), "no answer among {seen:?}");
        }
    }

    /// Reads notifications until the items seen so far match.
    fn until(&self, seen: &mut Vec<Message>, wanted: &str, is_so: impl Fn(&[String]) -> bool) {
        let deadline = Deadline::within(PATIENCE);
        while !is_so(&shown_to(seen)) {
            assert!(!deadline.has_passed(), "never came to be: {wanted}; it saw {seen:?}");
            seen.push(self.receive());
        }
    }
}

impl Message {
    fn read(bytes: &[u8]) -> Message {
        let token_end = 4 + usize::from(bytes[0] & 0xf);
        let (mut place, mut number, mut observe) = (token_end, 0, None);
        while place < bytes.len() && bytes[place] != 0xff {
            let (delta, length) = (bytes[place] >> 4, bytes[place] & 0xf);
            place += 1;
            number += extended(delta, bytes, &mut place);
            let end = place + usize::from(extended(length, bytes, &mut place));
            let end = end.max(place);
            if number == OBSERVE {
                observe = Some(bytes[place..end].iter().fold(0, |number, byte| number << 8 | u32::from(*byte)));
            }
            place = end;
        }
        let payload = bytes.get(place + 1..).unwrap_or_default();
        Message {
            kind: bytes[0] >> 4 & 3,
            code: bytes[1],
            id: u16::from_be_bytes([bytes[2], bytes[3]]),
            token: bytes[4..token_end].to_vec(),
            observe,
            payload: String::from_utf8(payload.to_vec()).expect("the old resource speaks text"),
        }
    }
}

/// Decodes an option delta or length, including the one or two bytes that extend a large value.
fn extended(nibble: u8, bytes: &[u8], place: &mut usize) -> u16 {
    let (extra, base) = match nibble {
        13 => (1, 13),
        14 => (2, 269),
        small => return u16::from(small),
    };
    let value = bytes[*place..*place + extra].iter().fold(0, |number, byte| number << 8 | u16::from(*byte));
    *place += extra;
    value + base
}

/// Items seen so far, in order.
fn shown_to(seen: &[Message]) -> Vec<String> {
    seen.iter().flat_map(|message| items(&message.payload)).collect()
}

#[test]
fn the_old_console_runs_a_whole_mission_by_its_own_datagrams() {
    const MODEL: [u8; 8] = *b"\x9f\x01\xd3\x44\x00\x7a\xee\x51";
    let program = serve("seed", "max");
    let mut console = Console::at(program.coap());
    let first = console.observe(MODEL);
    assert_eq!((first.kind, first.code, first.token.as_slice()), (ACK, CONTENT, MODEL.as_slice()), "{first:?}");
    assert!(first.observe.is_some() && !items(&first.payload).is_empty(), "{first:?}");
    let mut seen = vec![first];

    // The stray command that the old console sends when it starts.
    let id = console.put(*b"stray--w", "w");
    let refused = console.answer(*b"stray--w", &mut seen);
    assert_eq!((refused.kind, refused.id, refused.code >> 5), (ACK, id, 4), "{refused:?}");
    assert!(refused.payload.starts_with("refused: "), "{refused:?}");

    // The old page sent START over MQTT or HTTP, not over CoAP.
    program.press("/startappl").accepted();
    for (found, word, token) in [(1, "safe", *b"verdict1"), (2, "danger", *b"verdict2")] {
        let luggage = |items: &[String]| items.iter().any(|item| item.contains(&format!("'photo {found}, ")));
        console.until(&mut seen, "a piece is shown", luggage);
        program.until_asked();
        console.put(token, word);
        let answer = console.answer(token, &mut seen);
        assert_eq!((answer.code, answer.payload.as_str()), (CHANGED, "accepted"), "{answer:?}");
    }
    let state = program.until_phase("bombLocated");
    let (robot, map) = (shown::robot(&state), shown::map(&program));
    let last = |items: &[String], head: &str| items.iter().rfind(|item| item.starts_with(head)).cloned();
    let stands = |items: &[String]| last(items, "robot(") == Some(robot.clone()) && last(items, "roomMap(") == Some(map.clone());
    console.until(&mut seen, "the last state", stands);
    let numbers: Vec<u32> = seen.iter().filter(|message| message.token == MODEL).filter_map(|message| message.observe).collect();
    assert!(numbers.is_sorted() && numbers.len() > 6, "each notification is newer than the one before: {numbers:?}");
}
