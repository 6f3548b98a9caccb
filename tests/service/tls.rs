//! HTTPS: the real program with a certificate made for these tests, and a client that verifies the certificate.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::Arc;
use std::time::Duration;

use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, ServerName};
use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

use crate::program::{Deadline, PATIENCE, Program, hallsweep, run};

const CERTIFICATE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls/test-only-certificate.pem");
const KEY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls/test-only-key.pem");

fn served() -> Program {
    let mut command = hallsweep(&["serve", "--http", "0.0.0.0:0", "--hall", "empty-8x8"]);
    Program::started(command.env("HALLSWEEP__HTTP__TLS_CERTIFICATE", CERTIFICATE).env("HALLSWEEP__HTTP__TLS_KEY", KEY))
}

type Stream = StreamOwned<ClientConnection, TcpStream>;

/// Connects and verifies that the certificate is for this name.
fn connected(program: &Program, name: &'static str) -> std::io::Result<Stream> {
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from_pem_file(CERTIFICATE).expect("the certificate")).expect("it can be trusted");
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions().expect("they are known");
    let config = config.with_root_certificates(roots).with_no_client_auth();
    let stream = TcpStream::connect(program.address())?;
    stream.set_read_timeout(Some(Duration::from_secs(30)))?;
    let name = ServerName::try_from(name).expect("a name");
    let connection = ClientConnection::new(Arc::new(config), name).expect("a connection");
    Ok(StreamOwned::new(connection, stream))
}

/// Sends a request over a verified connection, and returns the answer.
fn asked(program: &Program, name: &'static str, request: &str) -> std::io::Result<String> {
    let mut stream = connected(program, name)?;
    stream.write_all(request.as_bytes())?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer)?;
    Ok(answer)
}

fn request(line: &str, headers: &str, body: &str) -> String {
    let length = body.len();
    format!("{line} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n{headers}Content-Length: {length}\r\n\r\n{body}")
}

#[test]
fn over_tls_one_signs_in_with_a_cookie_that_is_for_tls_only() {
    let program = served();
    let said = program.says();
    let (link, token) = said.split_once("/sign-in?token=").expect("a ready link");
    assert!(link.ends_with(&format!("https://127.0.0.1:{}", program.address().port())), "{said}");
    let form = "Content-Type: application/x-www-form-urlencoded\r\nAccept: text/html\r\nOrigin: https://localhost\r\n";
    let answer = asked(&program, "localhost", &request("POST /sign-in", form, &format!("token={token}"))).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 303") && answer.contains("; Secure"), "{answer}");
    let bearer = format!("Authorization: Bearer {token}\r\n");
    let answer = asked(&program, "localhost", &request("POST /api/v1/commands/stop", &bearer, "")).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    assert!(asked(&program, "elsewhere.example", &request("GET /healthz", "", "")).is_err(), "it is for its own names");
}

/// A STOP with this key, and the epoch before it.
fn stop(program: &Program, key: &str, route: &str, headers: &str) -> (String, u64) {
    let request = format!("POST {route} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {key}\r\n{headers}\r\n");
    (request, epoch(program, key))
}

fn epoch(program: &Program, key: &str) -> u64 {
    let bearer = format!("Authorization: Bearer {key}\r\n");
    let answer = asked(program, "localhost", &request("GET /api/v1/state", &bearer, "")).expect("an answer");
    let state: serde_json::Value = serde_json::from_str(answer.split_once("\r\n\r\n").expect("a head").1).expect("JSON");
    state["mission"]["epoch"].as_u64().expect("an epoch")
}

/// Waits until exactly one more STOP has halted.
fn check_halts(program: &Program, key: &str, before: u64, why: &str) {
    let deadline = Deadline::within(PATIENCE);
    while epoch(program, key) == before {
        assert!(!deadline.has_passed(), "it has not halted: {why}");
    }
    assert_eq!(epoch(program, key), before + 1, "one press is one stop: {why}");
}

/// The key in the ready link that the program has printed.
fn key(program: &Program) -> String {
    program.says().split_once("/sign-in?token=").expect("a ready link").1.trim().to_owned()
}

/// Safety S8.
#[test]
fn a_stop_over_tls_halts_although_its_sender_half_closes_hangs_up_or_sends_no_body() {
    let program = served();
    let key = key(&program);
    for route in ["/api/v1/commands/stop", "/console/stop", "/h", "/stopappl"] {
        for headers in ["Content-Length: 0\r\n", "Content-Length: 100\r\n", "Transfer-Encoding: chunked\r\n", "no header\r\n"] {
            for end in ["half-closes", "half-closes below TLS", "says that it ends and hangs up", "hangs up", "stays"] {
                let (request, before) = stop(&program, &key, route, headers);
                let mut stream = connected(&program, "localhost").expect("the program listens");
                stream.write_all(request.as_bytes()).expect("it is taken");
                if end.contains("half-closes") || end.contains("says") {
                    if end != "half-closes below TLS" {
                        stream.conn.send_close_notify();
                    }
                    stream.flush().expect("it is taken");
                    stream.sock.shutdown(Shutdown::Write).expect("it is open");
                }
                let mut open = (!end.contains("hangs up")).then_some(stream);
                check_halts(&program, &key, before, &format!("{route} {headers:?} {end}"));
                if let Some(stream) = open.as_mut().filter(|_| headers == "Content-Length: 0\r\n") {
                    let mut answer = [0; 12];
                    stream.read_exact(&mut answer).expect("it is answered");
                    assert!([b"200", b"303"].contains(&&answer[9..].try_into().expect("three")), "{route} {end}: {answer:?}");
                }
            }
        }
    }
}

/// Safety S9.
#[test]
fn handshakes_that_are_begun_and_not_gone_on_with_keep_no_stop_out() {
    let program = served();
    let key = key(&program);
    let mut crowd = Vec::new();
    for number in 0..40 {
        for begun in 0..20 {
            let mut stream = TcpStream::connect(program.address()).expect("the program listens");
            // Header of a TLS record, and the beginning of the ClientHello that it announces.
            let hello = [0x16, 3, 1, 2, 0, 1, 0, 1, 0xFC, 3, 3];
            stream.write_all(&hello[..begun % 12]).expect("it is taken");
            crowd.push(stream);
        }
        let (request, before) = stop(&program, &key, "/api/v1/commands/stop", "Content-Length: 0\r\n");
        let mut stream = connected(&program, "localhost").expect("the program listens");
        stream.write_all(request.as_bytes()).expect("it is taken");
        let mut answer = [0; 12];
        stream.read_exact(&mut answer).expect("it is answered");
        assert_eq!(&answer, b"HTTP/1.1 200", "newcomer {number}");
        check_halts(&program, &key, before, "a newcomer");
    }
}

#[test]
fn a_tls_door_says_nothing_in_plain_and_its_health_is_asked_all_the_same() {
    let program = served();
    let mut plain = TcpStream::connect(program.address()).expect("the program listens");
    plain.set_read_timeout(Some(Duration::from_secs(30))).expect("a time-out can be set");
    plain.write_all(request("GET /healthz", "", "").as_bytes()).expect("the program listens");
    let mut answer = Vec::new();
    // The connection may end in order or not, but no HTTP answer may arrive.
    let _ = plain.read_to_end(&mut answer);
    assert!(!answer.windows(4).any(|four| four == b"HTTP"), "{answer:?}");
    let output = run(&["healthcheck", "--http", &program.address().to_string()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn files_that_cannot_be_used_stop_the_start_with_what_to_do() {
    let refused = |certificate: &str, key: &str| {
        let mut command = hallsweep(&["serve", "--http", "127.0.0.1:0"]);
        command.env("HALLSWEEP__HTTP__TLS_CERTIFICATE", certificate).env("HALLSWEEP__HTTP__TLS_KEY", key);
        let output = command.output().expect("the program starts");
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert!(refused("no-such.pem", KEY).contains("http.tls_certificate = \"no-such.pem\": the file cannot be read"));
    assert!(refused(CERTIFICATE, CERTIFICATE).contains("BEGIN PRIVATE KEY"));
    assert!(refused(CERTIFICATE, "").contains("needs its key"));
}
