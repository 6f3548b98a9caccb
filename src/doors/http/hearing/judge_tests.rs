//! Safety S8: a STOP with any single fault halts the robot. A request that must never halt does not halt, even with a
//! further fault.

use std::net::Ipv4Addr;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;

use super::*;
use crate::access::{Access, Keyring, Keys, Moment, Person, Role, SESSION_S};
use crate::api::door;
use crate::api::tests::fixture::searching;
use crate::doors::http::HallDoor;
use crate::doors::http::testing::{TestApp, Tokens, app, guarded_app, keys};
use hallsweep_core::hall::HallId;

/// A request, line by line.
#[derive(Clone, Debug)]
struct Sent {
    method: Vec<u8>,
    target: Vec<u8>,
    version: Vec<u8>,
    fields: Vec<Vec<u8>>,
    /// The line ends: of the request line, and of each header line.
    ends: Vec<Vec<u8>>,
    body: Vec<u8>,
}

/// Faults after which a STOP is still a STOP from a sender who may stop.
#[derive(Clone, Debug)]
enum Fault {
    Method(String),
    Query(Vec<u8>),
    Target(&'static str),
    Version(Vec<u8>),
    LineEnd(usize, &'static str),
    /// An additional line at this position.
    Line(usize, Vec<u8>),
    Again(usize),
    /// The value of this header begins on the next line.
    Folded(usize),
    SpaceBeforeColon(usize),
    EmptyLinesBefore(usize),
    Body(Vec<u8>),
    Long(usize, usize),
}

impl Sent {
    fn stop((route, body): (&str, &str), credential: &str) -> Sent {
        let length = format!("Content-Length: {}", body.len());
        let fields = ["Host: localhost:8080", credential, "User-Agent: test", &length];
        Sent {
            method: b"POST".to_vec(),
            target: route.into(),
            version: b"HTTP/1.1".to_vec(),
            fields: fields.iter().filter(|field| !field.is_empty()).map(|field| field.as_bytes().to_vec()).collect(),
            ends: vec![b"\r\n".to_vec(); 6],
            body: body.into(),
        }
    }

    fn insert(&mut self, place: usize, line: Vec<u8>) {
        let place = place % (self.fields.len() + 1);
        self.fields.insert(place, line);
        self.ends.insert(place + 1, b"\r\n".to_vec());
    }

    fn with(mut self, fault: Fault) -> Sent {
        let lines = self.fields.len();
        match fault {
            Fault::Method(method) => self.method = method.into_bytes(),
            Fault::Query(query) => self.target.extend([b"?".to_vec(), query].concat()),
            Fault::Target(form) => {
                let route = String::from_utf8_lossy(&self.target).into_owned();
                self.target = form.replace("/ROUTE", &route).replace("/UPPER", &route.to_uppercase()).into_bytes();
            }
            Fault::Version(version) => self.version = version,
            // A carriage return alone before the empty line would not end the head.
            Fault::LineEnd(line, "\r") => self.ends[line % lines] = b"\r".to_vec(),
            Fault::LineEnd(line, end) => self.ends[line % (lines + 1)] = end.into(),
            Fault::Line(place, line) => self.insert(place, line),
            Fault::Again(line) => self.insert(line + 1, self.fields[line % lines].clone()),
            Fault::Folded(line) => {
                let colon = self.colon(line);
                self.fields[line % lines].splice(colon + 1..=colon + 1, b"\r\n\t ".to_vec());
            }
            Fault::SpaceBeforeColon(line) => {
                let colon = self.colon(line);
                self.fields[line % lines].insert(colon, b' ');
            }
            Fault::EmptyLinesBefore(lines) => self.method.splice(0..0, b"\r\n".repeat(lines)).for_each(drop),
            Fault::Body(body) => self.body.extend(body),
            Fault::Long(place, length) => self.insert(place, [b"X-Long: ".to_vec(), vec![b'x'; length]].concat()),
        }
        self
    }

    fn colon(&self, line: usize) -> usize {
        let line = &self.fields[line % self.fields.len()];
        line.iter().position(|byte| *byte == b':').expect("it was sent with one")
    }

    fn bytes(&self) -> Vec<u8> {
        let first = [&*self.method, b" ", &*self.target, b" ", &*self.version].concat();
        let lines = std::iter::once(&first).chain(&self.fields).zip(&self.ends);
        let mut bytes: Vec<u8> = lines.flat_map(|(line, end)| [&**line, &**end].concat()).collect();
        bytes.extend_from_slice(b"\r\n");
        bytes.extend_from_slice(&self.body);
        bytes
    }
}

fn judge(app: &TestApp) -> Judge {
    let peer = Peer { address: Ipv4Addr::LOCALHOST.into(), is_encrypted: false };
    Judge { halls: app.halls(), hosts: Hosts::new(true, &[]), peer }
}

/// Whether the first request in these bytes halts the robot while its connection is open. The bytes are sent in
/// pieces of this size.
fn halts(judge: &Judge, bytes: &[u8], piece: usize) -> bool {
    let (mut search, mut has_head) = (StopSearch::new(judge.clone()), false);
    for mut piece in bytes.chunks(piece) {
        while !piece.is_empty() {
            let (taken, heard, given) = search.take(piece);
            piece = &piece[taken..];
            has_head |= matches!(heard, Some(Heard::Head(_)));
            if search.number() > 0 {
                return false;
            }
            if given.is_some() {
                return true;
            }
        }
        if search.look_early().is_some() {
            return true;
        }
    }
    assert!(has_head, "no head has ended in {:?}", String::from_utf8_lossy(bytes));
    false
}

const ROUTES: [&str; 4] = ["/api/v1/commands/stop", "/console/stop", "/h", "/stopappl"];

const MOVE: &str = "/api/v1/commands/move";
const BUTTON: &str = "/console/move";

/// Every route for STOP. Where the path alone is not enough, the body says STOP.
const STOPS: [(&str, &str); 14] = [
    (ROUTES[0], ""),
    (ROUTES[1], ""),
    (ROUTES[2], ""),
    (ROUTES[3], ""),
    (MOVE, r#"{"move":"h"}"#),
    (MOVE, r#"{"move":"h","zz":1}"#),
    (MOVE, r#"{"epoch":1,"move":"H""#),
    (MOVE, "move=h"),
    (MOVE, "h"),
    (MOVE, r#"{"move":"stop"}"#),
    (BUTTON, "move=h"),
    (BUTTON, "epoch=3&move=STOP&more"),
    (BUTTON, r#"{"move":"h"}"#),
    (BUTTON, "--x\r\nContent-Disposition: form-data; name=\"move\"\r\n\r\nh\r\n--x--\r\n"),
];

fn line() -> impl Strategy<Value = Vec<u8>> {
    let no_end = |byte: &u8| !matches!(byte, b'\r' | b'\n');
    vec(any::<u8>().prop_filter("it is one line", no_end), 1..200)
        .prop_filter("it is a line of its own", |line| !matches!(line[0], b' ' | b'\t'))
}

/// A header line that must not change the result, with any value.
fn header_line() -> impl Strategy<Value = Vec<u8>> {
    let names = [
        "Content-Length",
        "Transfer-Encoding",
        "Expect",
        "Connection",
        "Upgrade",
        "Content-Type",
        "Accept",
        "Idempotency-Key",
        "Cookie",
        "Content-Encoding",
        "TE",
        "Trailer",
        "X-Forwarded-Host",
        "Forwarded",
        "Referer",
        "X",
        "",
    ];
    let known =
        ["0", "5", "-1", "1, 2", "chunked", "gzip", "100-continue", "close", "h2c", "websocket", "hallsweep-0=wrong", "\u{fc}"];
    let value = prop_oneof![line(), select(known.to_vec()).prop_map(|value| value.into())];
    let name = select(names.to_vec());
    (name, value).prop_map(|(name, value): (&str, Vec<u8>)| [name.as_bytes(), b": ", &*value].concat())
}

fn fault() -> impl Strategy<Value = Fault> {
    let method = prop_oneof![
        select(vec!["PUT", "DELETE", "post", "Stop", "BREW", "PATCH", "CONNECT", "P\u{f6}ST", "\u{1}"]).prop_map(str::to_owned),
        "[A-Z]{5,40}"
    ];
    let targets = select(vec![
        "/ROUTE/",
        "//ROUTE",
        "/UPPER",
        "/.//ROUTE",
        "http://localhost:8080/ROUTE",
        "HTTPS://127.0.0.1/ROUTE/",
        "/ROUTE;a=b",
        "/ROUTE#now",
    ]);
    prop_oneof![
        method.prop_filter("not safe", |method| !matches!(method.as_str(), "TRACE" | "OPTIONS")).prop_map(Fault::Method),
        line().prop_map(Fault::Query),
        targets.prop_map(Fault::Target),
        line().prop_map(Fault::Version),
        (any::<usize>(), select(vec!["\n", "\r\r\n", "\r", "  \r\n", "\t\n"])).prop_map(|(line, end)| Fault::LineEnd(line, end)),
        (any::<usize>(), line()).prop_map(|(place, line)| Fault::Line(place, line)),
        (any::<usize>(), header_line()).prop_map(|(place, line)| Fault::Line(place, line)),
        (any::<usize>(), select(vec!["Authorization: Bearer wrong", "Authorization: Basic eDp5", "Authorization:"]))
            .prop_map(|(place, line)| Fault::Line(place, line.into())),
        (0..1_000usize).prop_map(Fault::Again),
        any::<usize>().prop_map(Fault::Folded),
        any::<usize>().prop_map(Fault::SpaceBeforeColon),
        (1..5usize).prop_map(Fault::EmptyLinesBefore),
        vec(any::<u8>(), 0..300).prop_map(Fault::Body),
        (any::<usize>(), 0..300_000usize).prop_map(|(place, length)| Fault::Long(place, length)),
    ]
}

/// Why a request must never halt, and the change that makes a STOP such a request.
type Exception = (&'static str, fn(Sent, &str) -> Sent);

fn excepted() -> Vec<Exception> {
    fn adds(mut sent: Sent, line: &str) -> Sent {
        sent.insert(0, line.into());
        sent
    }
    fn without_key(mut sent: Sent) -> Sent {
        sent.fields[1] = b"X-Nothing: here".to_vec();
        sent
    }
    vec![
        ("a foreign host", |sent, _| adds(sent, "Host: rebound.example")),
        ("an address that is not of this machine", |sent, _| adds(sent, "Host: 192.0.2.1:8080")),
        ("a foreign host in the target", |mut sent, _| {
            sent.target = [b"http://rebound.example".to_vec(), sent.target].concat();
            sent
        }),
        ("a foreign origin", |sent, _| adds(sent, "Origin: http://elsewhere.example")),
        ("no origin at all", |sent, _| adds(sent, "Origin: null")),
        ("a foreign page", |sent, _| adds(sent, "Sec-Fetch-Site: cross-site")),
        ("a page of another port", |sent, _| adds(sent, "Sec-Fetch-Site: same-site")),
        ("no key", |sent, _| without_key(sent)),
        ("a wrong key", |sent, _| adds(without_key(sent), "Authorization: Bearer wrong")),
        ("an expired session", |sent, expired| adds(without_key(sent), &format!("Cookie: {expired}"))),
        ("a safe method", |mut sent, _| {
            sent.method = b"GET".to_vec();
            sent
        }),
        ("another safe method", |mut sent, _| {
            sent.method = b"OPTIONS".to_vec();
            sent
        }),
    ]
}

/// Returns a door with keys, the credentials of a viewer as header and as cookie, and an expired session. The app's
/// loop runs until the runtime ends.
fn guarded() -> (TestApp, [String; 2], String) {
    let (keyring, Tokens { viewer, .. }) = keys();
    let app = guarded_app(searching(), Access::Keys(keyring.clone()));
    let now = app.door.process.moment();
    let session = |keyring: &Keyring, now| format!("hallsweep-0={}", keyring.sign_in(&viewer, &Person::default(), now).unwrap());
    let credentials = [format!("Authorization: Bearer {viewer}"), format!("Cookie: a=b; {}; c=d", session(&keyring, now))];
    let earlier_run = Keyring::of((*keyring.keys()).clone()).unwrap();
    let over = session(&earlier_run, Moment { unix_s: now.unix_s - SESSION_S, ..now });
    (app, credentials, over)
}

fn check(cases: u32, property: impl Fn(&Judge, &[String; 2], &str, (usize, usize, Fault, usize)) -> Result<(), TestCaseError>) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    let _inside = runtime.enter();
    let (app, credentials, expired) = guarded();
    let judge = judge(&app);
    let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig { cases, ..ProptestConfig::default() });
    let every = (0..STOPS.len(), 0..credentials.len(), fault(), select(vec![1, 7, 1000, usize::MAX]));
    runner.run(&every, |case| property(&judge, &credentials, &expired, case)).unwrap_or_else(|error| panic!("{error}"));
}

/// Safety S8.
#[test]
fn any_single_fault_that_is_added_to_a_stop_leaves_it_halting() {
    check(3000, |judge, credentials, _, (route, credential, fault, piece)| {
        let bytes = Sent::stop(STOPS[route], &credentials[credential]).with(fault).bytes();
        prop_assert!(halts(judge, &bytes, piece), "{}", String::from_utf8_lossy(&bytes));
        Ok(())
    });
}

/// Safety S8, A1, A2.
#[test]
fn what_is_excepted_never_halts_whatever_fault_is_beside_it() {
    check(1500, |judge, credentials, expired, (route, credential, fault, piece)| {
        for (why, except) in excepted() {
            // A fault of the method or of the target would undo the exception.
            if matches!(fault, Fault::Method(_) | Fault::Target(_)) && why.contains("method") | why.contains("target") {
                continue;
            }
            let bytes = except(Sent::stop(STOPS[route], &credentials[credential]), expired).with(fault.clone()).bytes();
            prop_assert!(!halts(judge, &bytes, piece), "{why}: {}", String::from_utf8_lossy(&bytes));
        }
        Ok(())
    });
}

/// Safety S8: the halt and the answer follow the same rule.
#[tokio::test]
async fn who_may_stop_without_a_key_is_on_this_machine() {
    let app = app(searching());
    let mut judge = judge(&app);
    let stop = Sent::stop(("/h", ""), "").bytes();
    assert!(halts(&judge, &stop, 9));
    assert!(halts(&judge, b"POST /h HTTP/1.0\n\n", 9), "no host is no foreign one");
    assert!(halts(&judge, b"POST /h HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\n\r\n", 9));
    judge.peer.address = Ipv4Addr::new(192, 0, 2, 1).into();
    assert!(!halts(&judge, &stop, 9));
}

/// Safety S8, A2: if there are more hosts or origins than can be stored, a host or origin that was not stored may be
/// foreign.
#[tokio::test]
async fn nothing_halts_when_not_all_hosts_and_origins_are_kept() {
    let app = app(searching());
    let judge = judge(&app);
    let ours = ["localhost", "127.0.0.1", "localhost:1", "localhost:2"];
    for field in ["Host: ", "Origin: http://"] {
        let mut sent = Sent::stop(("/h", ""), "");
        for host in ours {
            sent.insert(0, format!("{field}{host}").into_bytes());
        }
        sent.insert(5, format!("{field}elsewhere.example").into_bytes());
        assert!(!halts(&judge, &sent.bytes(), usize::MAX), "{field}");
    }
}

/// Safety A6.
#[tokio::test]
async fn a_stop_that_was_heard_is_on_record_with_who_from_where_and_by_which_door() {
    let (app, [token, _], _) = guarded();
    let judge = judge(&app);
    for (route, door) in ROUTES.into_iter().zip([door::HTTP, door::CONSOLE, door::HTTP, door::HTTP]) {
        let mut sent = Sent::stop((route, ""), &token);
        sent.insert(0, b"Idempotency-Key: \"press-7\"".to_vec());
        let (_, heard, given) = StopSearch::new(judge.clone()).take(&sent.bytes());
        let Some(Heard::Head(HeardRequest { claim, .. })) = heard else { panic!("a head") };
        assert!(given.expect("it halts").await.is_ok());
        let given = app.last();
        assert_eq!((given.command, &*given.issuer.who, &*given.issuer.from), (Command::Stop, "lobby", "127.0.0.1"));
        assert_eq!((given.issuer.door, given.id.map(|id| id.text().to_owned())), (door, Some("press-7".to_owned())));
        assert_ne!(claim, SlotClaim::new(judge.peer.address, None), "the place is the viewer's");
    }
}

/// Safety S8: the rest of the body may be missing or invalid.
#[tokio::test]
async fn a_move_that_says_stop_halts_when_its_word_has_come() {
    let app = app(searching());
    let judge = judge(&app);
    let head = |length: &str| format!("POST {MOVE} HTTP/1.1\r\nHost: localhost\r\n{length}\r\n\r\n");
    for (length, body) in [
        ("Content-Length: 100", r#"{"move":"h""#),
        ("Transfer-Encoding: chunked", "c\r\n{\"move\":\"h\"}\r\n"),
        ("Transfer-Encoding: chunked", "4\r\n{\"mo\r\n8\r\nve\":\"h\"}\r\n"),
        ("Transfer-Encoding: chunked", r#"{"move":"h"}"#),
        ("Transfer-Encoding: chunked", "4\r\n{\"move\":\"h\"}"),
        ("Transfer-Encoding: gzip", r#"{"move":"h"}"#),
        ("Content-Length: 3\r\nContent-Length: 12", r#"{"move":"h"}"#),
        ("Content-Length: 70000", &format!(r#"{{"move":"h","zz":"{}"#, "z".repeat(60_000))),
        ("Content-Length: 5000", &format!(r#"{{"note":"{}","move":"h""#, "z".repeat(1_100))),
        ("Content-Length: 70000", &format!(r#"{{"note":"{}","move" : "h""#, "z".repeat(16_350))),
        ("Transfer-Encoding: chunked", &format!("1000\r\n{{\"note\":\"{}\",\"move\":\"h\"", "z".repeat(1_100))),
        ("Transfer-Encoding: chunked", &format!("{{\"note\":\"{}\",\"move\":\"h\"", "z".repeat(1_100))),
        ("Content-Length: 3\r\nContent-Length: 12", &format!("note={}&move=h", "z".repeat(9_000))),
    ] {
        let sent = head(length) + body;
        for piece in [1, 1000, usize::MAX] {
            assert!(halts(&judge, sent.as_bytes(), piece), "{length} {body:.40}");
        }
    }
    for short in ["Content-Length: 3", "Content-Length: 0", "Transfer-Encoding: chunked\r\n\r\n3\r\n{\"m\r\n0"] {
        let sent = head(short) + r#"{"move":"h"}"#;
        assert!(!halts(&judge, sent.as_bytes(), usize::MAX), "{short} cuts the word off");
    }
    for other in [r#"{"move":"w"}"#, r#"{"x":"h"}"#, ""] {
        let sent = head(&format!("Content-Length: {}", other.len())) + other;
        assert!(!halts(&judge, sent.as_bytes(), 7), "{other}");
        let next = format!("{sent}POST /nothing HTTP/1.1\r\nContent-Length: 12\r\n\r\n{{\"move\":\"h\"}}");
        let mut search = StopSearch::new(judge.clone());
        let mut rest = next.as_bytes();
        while !rest.is_empty() {
            let (taken, _, given) = search.take(rest);
            assert!(given.is_none() && search.look().is_none(), "the body of another says nothing of this");
            rest = &rest[taken..];
        }
    }
}

/// Safety S8: an escaped word for STOP is found only when the whole body is searched. While the body is incomplete,
/// it is not searched whole after every piece.
#[tokio::test]
async fn a_move_that_says_stop_halts_at_the_latest_when_its_connection_ends() {
    let app = app(searching());
    for (word, epochs) in [("w", 0), ("\\u0068", 1)] {
        let before = app.door.hall.handle.epoch();
        let mut search = StopSearch::new(judge(&app));
        let head = format!("POST {MOVE} HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5000\r\n\r\n");
        let (taken, _, _) = search.take(head.as_bytes());
        assert_eq!(taken, head.len());
        for piece in [format!(r#"{{"note":"{}""#, "z".repeat(1_100)), format!(r#","move":"{word}"}}"#)] {
            search.take(piece.as_bytes());
            assert!(search.look_early().is_none());
        }
        drop(search);
        assert_eq!(app.door.hall.handle.epoch().0, before.0 + epochs, "{word}");
        let sent = format!(r#"{head}{{"note":"{}","move":"{word}"}}"#, "z".repeat(1_100));
        assert_eq!(halts(&judge(&app), sent.as_bytes(), usize::MAX), epochs == 1, "a body that has doubled is looked at whole");
    }
}

/// Safety S8, A2: a STOP found in one request does not count for the next request.
#[tokio::test]
async fn each_move_on_a_connection_is_looked_at_by_itself() {
    let app = app(searching());
    let send = |fields: &str, body: &str| format!("POST {MOVE} HTTP/1.1\r\nHost: localhost\r\n{fields}\r\n{body}");
    let (forward, halt) = (r#"{"move":"w"}"#, r#"{"move":"h"}"#);
    for (before, next, stops) in [
        (send("Content-Length: 12\r\n", forward), send("Content-Length: 100\r\n", halt), 1),
        (send("", ""), send("Origin: http://elsewhere.example\r\nContent-Length: 12\r\n", halt), 0),
    ] {
        let (mut search, mut given) = (StopSearch::new(judge(&app)), 0);
        for sent in [before, next] {
            let mut rest = sent.as_bytes();
            while !rest.is_empty() {
                let (taken, _, stop) = search.take(rest);
                given += usize::from(stop.is_some());
                rest = &rest[taken..];
            }
            given += usize::from(search.look_early().is_some());
        }
        assert_eq!(given, stops);
    }
}

/// Safety S8: one valid key among sixteen is enough.
#[tokio::test]
async fn a_stop_with_many_wrong_keys_beside_the_right_one_halts() {
    let (app, credentials, _) = guarded();
    let judge = judge(&app);
    for (place, credential) in (0..16).flat_map(|place| credentials.iter().map(move |credential| (place, credential))) {
        let mut sent = Sent::stop(("/h", ""), "");
        let wrong = |number: usize| match credential.starts_with("Cookie") {
            true => format!("Cookie: hallsweep-0=wrong-{number}"),
            false => format!("Authorization: Bearer wrong-{number}"),
        };
        (0..15).for_each(|number| sent.insert(number, wrong(number).into_bytes()));
        sent.insert(place, credential.as_bytes().to_vec());
        assert!(halts(&judge, &sent.bytes(), usize::MAX), "{place} {credential}");
    }
}

/// Safety S1, S7, S8.
#[tokio::test]
async fn a_stop_halts_the_hall_that_its_path_names_and_no_other_whatever_is_wrong_with_the_path() {
    let (main, south) = (app(searching()), app(searching()));
    let judge = judge(&main);
    let id = |name: &str| HallId::new(name).expect("a plain name");
    judge.halls.add(id("south"), HallDoor::new(south.door.hall.handle.clone(), south.door.hall.archive.clone(), "depot"));
    let epochs = || (main.door.hall.handle.epoch().0, south.door.hall.handle.epoch().0);
    for (route, body) in STOPS {
        let within = route.strip_prefix("/api/v1").map_or_else(
            || vec![format!("/halls/south{route}"), format!("//HALLS/South/.{route}/")],
            |rest| {
                vec![
                    format!("/api/v1/halls/south{rest}"),
                    format!("/halls/south{route}"),
                    format!("/api//v1/%68alls/SOUTH{rest}"),
                ]
            },
        );
        for path in within {
            let before = epochs();
            let request = format!("POST {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {}\r\n\r\n{body}", body.len());
            assert!(halts(&judge, request.as_bytes(), 7), "{path} {body}");
            assert_eq!(epochs(), (before.0, before.1 + 1), "{path} {body}");
        }
        for path in [format!("/halls/north{route}"), format!("/halls{route}"), format!("/halls/so.uth{route}")] {
            let (before, request) =
                (epochs(), format!("POST {path} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {}\r\n\r\n{body}", body.len()));
            assert!(!halts(&judge, request.as_bytes(), 7), "{path} {body}");
            assert_eq!(epochs(), before, "{path}");
        }
    }
}

/// Safety A1.
#[tokio::test]
async fn a_key_halts_the_halls_that_it_sees() {
    let id = |name: &str| HallId::new(name).expect("a plain name");
    let mut keys = Keys::first().unwrap();
    let token = keys.add("south", Role::Viewer, Some([id("south")].into())).unwrap().token.reveal().to_owned();
    let main = guarded_app(searching(), Access::Keys(Keyring::of(keys).unwrap()));
    let south = app(searching());
    let judge = judge(&main);
    judge.halls.add(id("south"), HallDoor::new(south.door.hall.handle.clone(), south.door.hall.archive.clone(), "depot"));
    let before = main.door.hall.handle.epoch();
    for (path, expected) in [("/h", false), ("/halls/main/h", false), ("/halls/north/h", false), ("/halls/south/h", true)] {
        let request = format!("POST {path} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n\r\n");
        assert_eq!(halts(&judge, request.as_bytes(), 9), expected, "{path}");
    }
    assert_eq!(main.door.hall.handle.epoch(), before);
}
