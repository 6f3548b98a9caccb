//! Tests of STOP from the datagram to the loop, through endpoint and resources. With any addition a STOP halts once.
//! If it is repeated after a START, it halts once more. Other messages do not halt, even if they look like a STOP.

use std::net::SocketAddr;
use std::time::Duration;

use proptest::prelude::*;
use tokio::runtime::Runtime;

use super::super::testing::{TestApp, app};
use super::*;
use crate::access::Need;
use crate::api::tests::fixture::searching;
use crate::doors::coap::application::{Application, HALTED};
use crate::doors::coap::resources::table::Table;
use coap_endpoint::{Code, Endpoint, Transmit};

struct Door {
    endpoint: Endpoint,
    app: TestApp,
    runtime: Runtime,
    now: Duration,
}

/// A message whose parts may be faulty in any way.
#[derive(Clone, Debug)]
struct Message {
    version: u8,
    kind: u8,
    code: u8,
    token_bits: u8,
    token: Vec<u8>,
    options: Vec<(u16, Vec<u8>)>,
    /// The bytes after the options, including the payload marker.
    rest: Vec<u8>,
    /// Bytes after the options that break the grammar of CoAP.
    broken: Option<Vec<u8>>,
}

const CON: u8 = 0;
const NON: u8 = 1;

impl Door {
    fn new() -> Door {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().unwrap();
        let app = runtime.block_on(async { app(searching()) });
        let endpoint = Endpoint::new([7; 32]).with_urgent(Resources::IS_STOP, HALTED);
        Door { endpoint, app, runtime, now: Duration::from_secs(100) }
    }

    /// Handles a datagram and all requests that follow from it. Returns the datagrams that are sent back.
    fn take(&mut self, peer: SocketAddr, bytes: &[u8]) -> Vec<Transmit> {
        self.now += Duration::from_millis(1);
        self.endpoint.handle_undone(self.app.resources.undone());
        self.endpoint.handle_datagram(peer, bytes, self.now);
        while let Some((exchange, request)) = self.endpoint.poll_request() {
            let resources = &self.app.resources;
            let answer = self.runtime.block_on(async {
                match resources.answer(&request) {
                    Reply::Now(answer) => answer,
                    Reply::Later(answer) => answer.await,
                }
            });
            self.endpoint.handle_answer(exchange, answer, self.now);
        }
        std::iter::from_fn(|| self.endpoint.poll_transmit()).collect()
    }

    fn start(&self) {
        let start = command::Request::new(Command::Start, caller::issuer(here()));
        assert!(self.runtime.block_on(async { self.app.resources.handle.give(start).await }).is_ok());
    }

    fn given(&self) -> Vec<Command> {
        self.app.given.lock().unwrap().iter().map(|request| request.command.clone()).collect()
    }

    fn refusals(&mut self) -> usize {
        let by_endpoint = std::iter::from_fn(|| self.endpoint.poll_refused()).count();
        by_endpoint + self.runtime.block_on(async { usize::from(self.app.noted().await.is_some()) })
    }
}

impl Message {
    fn new(code: u8, path: &[&str], payload: &[u8]) -> Message {
        let options = path.iter().map(|segment| (11, segment.as_bytes().to_vec())).collect();
        let rest = if payload.is_empty() { Vec::new() } else { [&[0xFF], payload].concat() };
        let token = b"tok".to_vec();
        Message { version: 1, kind: CON, code, token_bits: 3, token, options, rest, broken: None }
    }

    fn bytes(&self, id: u16) -> Vec<u8> {
        let mut bytes = vec![self.version << 6 | self.kind << 4 | self.token_bits, self.code];
        bytes.extend(id.to_be_bytes());
        bytes.extend(&self.token);
        let mut options = self.options.clone();
        options.sort_by_key(|(number, _)| *number);
        let mut before = 0;
        for (number, value) in options {
            let (delta, length) = (usize::from(number - before), value.len());
            bytes.push(half(delta) << 4 | half(length));
            bytes.extend(more(delta));
            bytes.extend(more(length));
            bytes.extend(value);
            before = number;
        }
        bytes.extend(self.broken.iter().flatten());
        bytes.extend(&self.rest);
        bytes
    }
}

fn half(value: usize) -> u8 {
    if value < 13 {
        value as u8
    } else if value < 269 {
        13
    } else {
        14
    }
}

fn more(value: usize) -> Vec<u8> {
    match value {
        0..13 => Vec::new(),
        13..269 => vec![(value - 13) as u8],
        _ => ((value - 269) as u16).to_be_bytes().to_vec(),
    }
}

fn here() -> SocketAddr {
    "127.0.0.1:40000".parse().unwrap()
}

fn stops() -> Vec<Message> {
    vec![
        Message::new(2, &["commands", "stop"], b""),
        Message::new(2, &["commands", "move"], br#"{"move":"h"}"#),
        Message::new(2, &["commands", "move"], b"\xa1\x64move\x61h"),
        Message::new(3, &["resourcemodel"], b"h"),
        Message::new(2, &["resourcemodel"], b"h"),
        Message::new(3, &["resourcemodel"], br#""h""#),
        Message::new(2, &["Commands", "STOP", ""], b""),
        Message::new(2, &["commands", "h"], b""),
        Message::new(2, &["commands/move"], br#"{"move":"Stop"}"#),
        Message::new(3, &["ResourceModel"], b"STOP"),
        Message { options: vec![(35, b"coap://localhost/commands/stop".to_vec())], ..Message::new(2, &[], b"") },
    ]
}

#[derive(Clone, Debug)]
enum Fault {
    /// Adds an option with this number and value, this many times.
    Option(u16, Vec<u8>, usize),
    Method(u8),
    /// Announces this token length, and sends this many token bytes.
    Token(u8, usize),
    /// Sets a body, or adds these bytes to the body of the message.
    Body(Vec<u8>),
    MarkerAlone,
    /// Adds invalid bytes after the options.
    Broken(Vec<u8>),
    Nonconfirmable,
}

fn any_fault() -> impl Strategy<Value = Fault> {
    let known =
        prop::sample::select(vec![1_u16, 3, 4, 5, 6, 7, 8, 9, 12, 14, 15, 17, 19, 20, 23, 27, 28, 31, 35, 39, 60, 252, 258, 292]);
    // Option 11 is a part of the path. Another value would name another path.
    let number = prop_oneof![4 => known, 1 => any::<u16>().prop_filter("the path", |number| *number != 11)];
    let value = prop_oneof![
        4 => prop::collection::vec(any::<u8>(), 0..5),
        1 => prop::collection::vec(any::<u8>(), 0..400),
        1 => Just(vec![7]),
        1 => Just(b"id=two words".to_vec()),
    ];
    prop_oneof![
        8 => (number, value, 1_usize..3).prop_map(|(number, value, times)| Fault::Option(number, value, times)),
        2 => (0_u8..32).prop_filter("safe methods", |code| *code != 1 && *code != 5).prop_map(Fault::Method),
        2 => (0_u8..9).prop_map(|length| Fault::Token(length, usize::from(length))),
        2 => (9_u8..16, 0_usize..9).prop_map(|(bits, length)| Fault::Token(bits, length)),
        1 => (9_u8..16).prop_map(|bits| Fault::Token(bits, usize::from(bits))),
        2 => prop::collection::vec(any::<u8>(), 0..40).prop_map(Fault::Body),
        1 => (16_000_usize..40_000).prop_map(|length| Fault::Body(vec![b' '; length])),
        1 => Just(Fault::MarkerAlone),
        1 => prop::sample::select(vec![&[0xF0_u8][..], &[0x0F], &[0xF1, 0], &[0xFE]]).prop_map(|bytes| Fault::Broken(bytes.to_vec())),
        1 => Just(Fault::Nonconfirmable),
    ]
}

/// Returns the message with the fault. Returns `None` if the fault would remove the name of the STOP.
fn spoilt(message: &Message, fault: &Fault) -> Option<Message> {
    let mut message = message.clone();
    match fault {
        Fault::Option(number, value, times) => message.options.extend(vec![(*number, value.clone()); *times]),
        Fault::Method(code) => message.code = *code,
        Fault::Token(bits, length) => (message.token_bits, message.token) = (*bits, vec![0x33; *length]),
        Fault::Body(body) if message.rest.is_empty() => message.rest = [&[0xFF], &body[..]].concat(),
        // Only blanks after a word leave the word unchanged.
        Fault::Body(body) if body.iter().all(|letter| *letter == b' ') => message.rest.extend(body),
        Fault::Body(_) => return None,
        Fault::MarkerAlone if message.rest.is_empty() => message.rest = vec![0xFF],
        Fault::MarkerAlone => return None,
        Fault::Broken(bytes) => message.broken = Some(bytes.clone()),
        Fault::Nonconfirmable => message.kind = NON,
    }
    Some(message)
}

fn is_known_in_a_flood(bytes: &[u8]) -> bool {
    bytes.windows(4).any(|four| WORDS.iter().any(|word| word.iter().copied().eq(four.iter().map(|byte| byte | 0x20))))
}

/// Generates paths. Each is written as several segments, as one segment, or as a whole address.
fn path_in_parts() -> impl Strategy<Value = (Vec<&'static str>, u8)> {
    let first = prop::sample::select(vec!["commands", "Commands", " commands", "commands ", "ResourceModel", " resourcemodel "]);
    let rest = prop::sample::select(vec!["h", "H", " h", "h ", "stop", "\tSTOP", "move ", "Move", "", " ", "x"]);
    let parts = (prop::collection::vec(Just(""), 0..2), first, prop::collection::vec(rest, 0..3));
    (parts.prop_map(|(empty, first, rest)| [empty, vec![first], rest].concat()), 0_u8..3)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, ..ProptestConfig::default() })]

    /// Safety S1, S8.
    #[test]
    fn any_fault_that_is_added_to_a_stop_leaves_it_halting_once(which in 0..stops().len(), fault in any_fault()) {
        let Some(message) = spoilt(&stops()[which], &fault) else { return Ok(()) };
        let mut door = Door::new();
        let bytes = message.bytes(1);
        prop_assert!(is_known_in_a_flood(&bytes));
        door.take(here(), &bytes);
        prop_assert_eq!(door.given(), [Command::Stop]);
        let sent = door.take(here(), &message.bytes(1));
        prop_assert_eq!(door.given(), [Command::Stop], "a repetition is the same press");
        prop_assert_eq!(door.refusals(), 0, "one press is on record once: {:?}", sent);
        door.take(here(), &message.bytes(2));
        prop_assert_eq!(door.given(), [Command::Stop, Command::Stop], "the next press halts again");
        door.start();
        door.take(here(), &message.bytes(1));
        door.take(here(), &message.bytes(1));
        let given = [Command::Stop, Command::Stop, Command::Start, Command::Stop];
        prop_assert_eq!(door.given(), given, "and a repetition once more after a START");
        prop_assert_eq!(door.refusals(), 0);
    }

    /// Safety S8: every form of STOP contains a word that passes the flood filter, except for a bare `h` in an
    /// unusual form.
    #[test]
    fn however_the_path_of_a_stop_is_written_it_is_known_in_a_flood_but_for_an_unusual_h((parts, cut) in path_in_parts()) {
        let message = match cut {
            0 => Message::new(2, &parts, b"h"),
            1 => Message::new(2, &[&parts.join("/")], b"h"),
            _ => Message {
                options: vec![(35, format!("coap://localhost/{}", parts.join("/")).into_bytes())],
                ..Message::new(2, &[], b"h")
            },
        };
        let (mut door, bytes) = (Door::new(), message.bytes(1));
        door.take(here(), &bytes);
        if !door.given().is_empty() {
            let written = parts.join("/").to_ascii_lowercase();
            let is_unusual = written.trim_end_matches(['/', ' ']).ends_with('h') && !written.trim_matches('/').eq("commands/h");
            prop_assert!(is_known_in_a_flood(&bytes) || is_unusual, "{:?}", message);
        }
    }

    /// Safety S8.
    #[test]
    fn what_must_not_halt_does_not_whatever_else_is_wrong_with_it(
        which in 0..stops().len(), fault in any_fault(), except in 0_usize..9, response in 0x40_u8..,
    ) {
        let Some(mut message) = spoilt(&stops()[which], &fault) else { return Ok(()) };
        let mut peer = here();
        match except {
            0 => peer = "192.0.2.7:40000".parse().unwrap(),
            1 => message.code = 1,
            2 => message.code = 5,
            3 => message.version = 0,
            4 => message.version = 2,
            5 => message.version = 3,
            6 => message.kind = 2,
            7 => message.code = response,
            _ => message.kind = 3,
        }
        let mut door = Door::new();
        door.take(peer, &message.bytes(1));
        prop_assert_eq!(door.given(), []);
    }

    /// Safety S8.
    #[test]
    fn bytes_by_chance_behind_a_stop_leave_it_halting(tail in prop::collection::vec(any::<u8>(), 0..20)) {
        // The byte 0x10 begins another option, so it ends the path.
        let message = Message { rest: [&[0x10_u8][..], &tail].concat(), ..stops().remove(0) };
        let mut door = Door::new();
        door.take(here(), &message.bytes(1));
        prop_assert_eq!(door.given(), [Command::Stop]);
    }
}

/// Returns the code of the answer; it is `0.00` for a rejection.
fn answered(sent: &[Transmit]) -> Option<String> {
    sent.first().map(|transmit| Code(transmit.bytes[1]).to_string())
}

/// Safety S8: the robot halts first. The request is refused afterwards, as the RFC requires.
#[test]
fn a_stop_that_is_refused_has_halted_and_says_so() {
    let stop = || Message::new(2, &["commands", "stop"], b"");
    let with = |number: u16, value: &[u8]| spoilt(&stop(), &Fault::Option(number, value.to_vec(), 1)).unwrap();
    let cases = [
        (with(65_001, b""), "4.02"),
        (with(9, b""), "4.02"),
        (with(19, &[0x08]), "4.02"),
        (spoilt(&stop(), &Fault::Option(17, vec![50], 2)).unwrap(), "4.02"),
        (with(15, b"\xff"), "4.02"),
        (with(23, &[7]), "4.00"),
        (with(27, &[7]), "4.00"),
        (with(35, b"coap://elsewhere"), "5.05"),
        (Message { code: 3, ..stop() }, "4.05"),
        (Message { code: 31, ..stop() }, "4.05"),
    ];
    for (message, code) in cases {
        let mut door = Door::new();
        let sent = door.take(here(), &message.bytes(1));
        assert_eq!(door.given(), [Command::Stop], "{message:?}");
        assert_eq!(answered(&sent).as_deref(), Some(code), "{message:?}");
        let words = String::from_utf8_lossy(&sent[0].bytes).into_owned();
        assert!(words.contains("refused: the robot was halted anyway; "), "{words}");
    }
    for message in [Message { rest: vec![0xFF], ..stop() }, Message { token_bits: 9, ..stop() }] {
        let mut door = Door::new();
        let sent = door.take(here(), &message.bytes(1));
        assert_eq!((door.given(), &sent[0].bytes[..]), (vec![Command::Stop], &[0x70, 0, 0, 1][..]), "RST");
        assert_eq!(door.take(here(), &message.bytes(1)), sent, "and again to a repetition");
    }
}

#[test]
fn a_halt_in_a_body_that_comes_in_blocks_halts_when_its_word_has_come() {
    let block = |id: u16, number: u8, more: bool, bytes: &[u8]| {
        let mut message = Message::new(2, &["commands", "move"], bytes);
        message.options.push((27, vec![number << 4 | u8::from(more) << 3]));
        message.bytes(id)
    };
    let mut door = Door::new();
    door.take(here(), &block(1, 0, true, br#"{"zz":12345,"mov"#));
    assert_eq!(door.given(), []);
    door.take(here(), &block(2, 1, false, br#"e":"h"}"#));
    assert_eq!(door.given(), [Command::Stop]);
}

/// The answer to a STOP may be longer than one block of the client. Fetching the next block of the answer does not
/// press STOP again.
#[test]
fn to_read_on_in_the_answer_to_a_stop_is_no_press_and_to_begin_anew_is_one() {
    let block =
        |number: u8| spoilt(&Message::new(2, &["commands", "stop"], b""), &Fault::Option(23, vec![number << 4], 1)).unwrap();
    let mut door = Door::new();
    let whole: Vec<Vec<Transmit>> =
        (0..3).map(|number| door.take(here(), &block(number).bytes(10 + u16::from(number)))).collect();
    assert!(whole.iter().all(|sent| answered(sent).as_deref() == Some("2.04")), "{whole:?}");
    assert_eq!(door.given(), [Command::Stop]);
    for (id, number, presses) in [(20, 0, 2), (21, 0, 3), (22, 1, 3), (23, 1, 4), (24, 3, 5)] {
        door.take(here(), &block(number).bytes(id));
        assert_eq!(door.given().len(), presses, "{id}");
    }
}

/// Safety S8: each of these halts when its datagram arrives. The flood filter treats these datagrams like other
/// commands.
#[test]
fn a_bare_h_that_is_written_unusually_halts_and_is_not_known_in_a_flood() {
    let address = |path: &str| Message { options: vec![(35, path.as_bytes().to_vec())], ..Message::new(2, &[], b"") };
    let unusual = [
        Message::new(2, &["commands", " h"], b""),
        Message::new(2, &["commands", "h "], b""),
        Message::new(2, &["commands", "", "h"], b""),
        address("coap://localhost/commands//h"),
    ];
    for message in unusual {
        let (mut door, bytes) = (Door::new(), message.bytes(1));
        door.take(here(), &bytes);
        assert_eq!(door.given(), [Command::Stop], "{message:?}");
        assert!(!is_known_in_a_flood(&bytes), "{message:?}");
    }
}

/// Safety S8: every STOP in the table is recognised before anything else is judged.
#[test]
fn every_path_at_which_anybody_may_stop_is_known_as_one() {
    for row in Table::default().rows {
        for (method, action) in row.actions {
            let path: Vec<String> = row.path.split('/').skip(1).map(str::to_owned).collect();
            let halts = |payload: &str| {
                let payload = payload.as_bytes().to_vec();
                is_stop(&Request {
                    path: path.clone(),
                    payload,
                    ..crate::doors::coap::resources::testing::request(method, "/", "")
                })
            };
            let is_known = halts("") || halts("h") || halts(r#"{"move":"h"}"#);
            assert_eq!(is_known, action.need() == Need::Stop, "{} {}", method.name(), row.path);
        }
    }
}
