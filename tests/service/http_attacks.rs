//! STOP over HTTP, as raw bytes to the real program: malformed requests, and crowds that occupy the connections.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpStream};
use std::time::Duration;

use hallsweep::app::raise_descriptors;

use crate::access::Site;
use crate::program::Program;

const ROUTES: [&str; 4] = ["/api/v1/commands/stop", "/console/stop", "/h", "/stopappl"];

/// Headers and a body that never becomes complete.
const HALF: &str = "Host: localhost\r\nContent-Type: application/json\r\nContent-Length: 100\r\n\r\n{";

pub(crate) fn connected(program: &Program, says: &str) -> TcpStream {
    let mut stream = TcpStream::connect(program.address()).expect("the program listens");
    stream.set_read_timeout(Some(Duration::from_secs(30))).expect("a time-out can be set");
    // The program may already have closed this connection in favour of another.
    let _ = stream.write_all(says.as_bytes());
    stream
}

/// Status of the answer. Empty if there is no answer.
pub(crate) fn status(stream: &mut TcpStream) -> String {
    let mut begin = [0; 12];
    stream.read_exact(&mut begin).map_or_else(|_| String::new(), |()| String::from_utf8_lossy(&begin[9..]).into_owned())
}

pub(crate) fn stop(route: &str, headers: &str) -> String {
    format!("POST {route} HTTP/1.1\r\nHost: localhost\r\n{headers}\r\n")
}

fn epoch(program: &Program) -> u64 {
    program.json("state")["mission"]["epoch"].as_u64().expect("an epoch")
}

/// Waits until this many more stops have halted, and fails if there are more.
fn check_halts(program: &Program, before: u64, stops: u64) {
    let state = program.until("every stop has halted", |state| state["mission"]["epoch"].as_u64() >= Some(before + stops));
    assert_eq!(state["mission"]["epoch"], before + stops, "one press is one stop");
}

/// Safety S8, S1.
#[test]
fn a_stop_halts_a_moving_robot_although_its_sender_half_closes_or_hangs_up() {
    let program = Program::serve("airport", "1");
    let headers = "Content-Length: 0\r\n";
    let before = epoch(&program);
    for number in 0..80 {
        program.command("start").accepted();
        let mut stream = connected(&program, &stop(ROUTES[number % 4], headers));
        if number < 40 {
            stream.shutdown(Shutdown::Write).expect("it is open");
            assert!(["200", "303"].contains(&status(&mut stream).as_str()), "{number}: it is answered");
        }
        drop(stream);
        let halted = |state: &serde_json::Value| state["mission"]["epoch"].as_u64() == Some(before + number as u64 + 1);
        let state = program.until("this stop has halted", halted);
        assert!(state["mission"]["holds"].as_array().expect("holds").contains(&"operator".into()), "{state}");
    }
    check_halts(&program, before, 80);
}

/// Safety S8.
#[test]
fn a_stop_halts_whatever_is_wrong_with_it_or_before_it() {
    let program = Program::serve("empty-8x8", "max");
    let long = "x".repeat(70_000);
    let look = "GET /api/v1/state HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let watch = "GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let plain = stop("/h", "");
    let cases = [
        stop("/h", "Content-Length: 5\r\nExpect: 100-continue\r\n"),
        stop("/console/stop", "Transfer-Encoding: chunked\r\n"),
        stop("/h", "Content-Length: 99999999\r\n"),
        stop("/h", "Content-Length: 1\r\nContent-Length: 2\r\n"),
        stop("/h", "Content-Length: 1\r\nTransfer-Encoding: gzip\r\n"),
        stop("/h", "no header at all\r\n"),
        stop("/h", &format!("X: {long}\r\n")),
        stop("/h", "Upgrade: h2c\r\nConnection: Upgrade\r\n"),
        stop("/h?now=1", ""),
        stop("/api/v1/commands/stop/", ""),
        stop("http://localhost/h", ""),
        plain.replace("POST", "PUT"),
        plain.replace("POST", "post"),
        plain.replace("HTTP/1.1", "HTTP/7"),
        plain.replace("\r\n", "\n"),
        format!("{}{plain}", look.repeat(50)),
        format!("{watch}{plain}"),
        format!("{watch}{}{plain}", look.repeat(10_000)),
        format!("{}{plain}", look.repeat(50_000)),
    ];
    let before = epoch(&program);
    let mut open = Vec::new();
    for (number, case) in cases.iter().enumerate() {
        let mut stream = connected(&program, case);
        check_halts(&program, before, number as u64 + 1);
        assert!(!status(&mut stream).is_empty(), "it is answered: {case:.200}");
        open.push(stream);
    }
}

/// Safety S8, A2.
#[test]
fn nothing_that_is_excepted_halts() {
    let program = Program::serve("empty-8x8", "max");
    let before = epoch(&program);
    for (headers, expect) in [
        ("Origin: http://elsewhere.example\r\n", "403"),
        ("Sec-Fetch-Site: cross-site\r\n", "403"),
        // A second Host header, beside the one of the STOP itself.
        ("Host: rebound.example\r\n", "400"),
    ] {
        for route in ROUTES {
            assert_eq!(status(&mut connected(&program, &stop(route, headers))), expect, "{headers}");
        }
    }
    for method in ["GET", "HEAD", "OPTIONS"] {
        assert_eq!(status(&mut connected(&program, &stop("/h", "").replace("POST", method))), "405", "{method}");
    }
    assert_eq!(epoch(&program), before);
}

/// Safety S9.
#[test]
fn two_thousand_bodies_that_do_not_come_keep_no_stop_out() {
    // The crowd is smaller on a system that allows a process fewer sockets.
    let most = raise_descriptors(4096);
    let crowd = usize::try_from(most.saturating_sub(200)).unwrap_or(usize::MAX).min(2000);
    let program = Program::serve("empty-8x8", "max");
    let half = format!("POST /api/v1/commands/goto HTTP/1.1\r\n{HALF}");
    let before = epoch(&program);
    let crowd: Vec<TcpStream> = (0..crowd).map(|_| connected(&program, &half)).collect();
    for number in 0..300 {
        assert_eq!(status(&mut connected(&program, &stop("/api/v1/commands/stop", ""))), "200", "newcomer {number}");
    }
    check_halts(&program, before, 300);
    drop(crowd);
}

/// Safety S9.
#[test]
fn a_viewers_key_from_many_addresses_keeps_no_stop_out() {
    let most = raise_descriptors(4096);
    let crowd = usize::try_from(most.saturating_sub(200)).unwrap_or(usize::MAX).min(1200);
    let site = Site::new("crowd", &["HTTP__REQUIRE_TOKEN"]);
    let program = &site.program;
    let [viewer, operator] = [&site.viewer, &site.operator].map(|token| format!("Authorization: Bearer {token}\r\n"));
    let crowd: Vec<TcpStream> = (0..crowd)
        .map(|number| {
            let from = SocketAddr::from((Ipv4Addr::new(127, 0, 0, 2 + (number % 6) as u8), 0));
            let mut stream = from_address(from, program.address());
            let asked = ["POST /api/v1/commands/goto HTTP/1.1\r\n", "GET /api/v1/events HTTP/1.1\r\n"][number % 2];
            let _ = stream.write_all(format!("{asked}{viewer}{HALF}").as_bytes());
            stream
        })
        .collect();
    for number in 0..50 {
        let key = [&operator, &viewer][number % 2];
        assert_eq!(status(&mut connected(program, &stop("/api/v1/commands/stop", key))), "200", "newcomer {number}");
    }
    let mut page = connected(program, &format!("GET /console/live HTTP/1.1\r\nHost: localhost\r\n{operator}\r\n"));
    assert_eq!(status(&mut page), "200", "an operator's page has its stream");
    drop(crowd);
}

/// Safety S8, S9: 512 connections may wait; a few of them are the test's own requests.
#[test]
fn five_hundred_that_have_not_said_all_yet_stay_and_the_stop_of_each_halts() {
    let most = raise_descriptors(4096);
    if most < 700 {
        eprintln!("left out: this system lets one process have {most} descriptors");
        return;
    }
    let program = Program::serve("empty-8x8", "max");
    let before = epoch(&program);
    let stop = stop("/h", "");
    let (begin, rest) = stop.split_at(20);
    let mut waiting: Vec<TcpStream> = (0..500).map(|_| connected(&program, begin)).collect();
    assert_eq!(epoch(&program), before);
    for stream in &mut waiting {
        stream.write_all(rest.as_bytes()).expect("it is there still");
    }
    for stream in &mut waiting {
        assert_eq!(status(stream), "200");
    }
    check_halts(&program, before, 500);
}

/// Connects from this local address.
fn from_address(from: SocketAddr, to: SocketAddr) -> TcpStream {
    let socket = socket2::Socket::new(socket2::Domain::IPV4, socket2::Type::STREAM, None).expect("a socket");
    socket.bind(&from.into()).expect("every address of 127.0.0.0/8 is this machine's");
    socket.connect(&to.into()).expect("the program listens");
    socket.into()
}
