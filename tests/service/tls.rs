//! https: the real program with a certificate made for these tests, asked by a client that verifies it.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::Duration;

use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, ServerName};
use rustls::{ClientConfig, ClientConnection, RootCertStore, StreamOwned};

use crate::program::{Program, hallsweep, run};

const CERTIFICATE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls/test-only-certificate.pem");
const KEY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/service/tls/test-only-key.pem");

fn served() -> Program {
    let mut command = hallsweep(&["serve", "--http", "0.0.0.0:0", "--hall", "empty-8x8"]);
    Program::started(command.env("HALLSWEEP__HTTP__TLS_CERTIFICATE", CERTIFICATE).env("HALLSWEEP__HTTP__TLS_KEY", KEY))
}

/// Asks, and verifies that whoever answers is who the certificate says.
fn asked(program: &Program, name: &'static str, request: &str) -> std::io::Result<String> {
    let mut roots = RootCertStore::empty();
    roots.add(CertificateDer::from_pem_file(CERTIFICATE).expect("the certificate")).expect("it can be trusted");
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions().expect("they are known");
    let config = config.with_root_certificates(roots).with_no_client_auth();
    let stream = TcpStream::connect(program.address())?;
    stream.set_read_timeout(Some(Duration::from_secs(30)))?;
    let name = ServerName::try_from(name).expect("a name");
    let connection = ClientConnection::new(Arc::new(config), name).expect("a connection");
    let mut stream = StreamOwned::new(connection, stream);
    stream.write_all(request.as_bytes())?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer)?;
    Ok(answer)
}

/// The text of a request with a body.
fn request(line: &str, headers: &str, body: &str) -> String {
    let length = body.len();
    format!("{line} HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n{headers}Content-Length: {length}\r\n\r\n{body}")
}

#[test]
fn over_tls_one_signs_in_with_a_cookie_that_is_for_tls_only() {
    let program = served();
    let said = program.says();
    let (link, token) = said.split_once("/sign-in?token=").expect("a ready link");
    assert!(link.ends_with(&format!("https://localhost:{}", program.address().port())), "{said}");
    let form = "Content-Type: application/x-www-form-urlencoded\r\nAccept: text/html\r\nOrigin: https://localhost\r\n";
    let answer = asked(&program, "localhost", &request("POST /sign-in", form, &format!("token={token}"))).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 303") && answer.contains("; Secure"), "{answer}");
    let bearer = format!("Authorization: Bearer {token}\r\n");
    let answer = asked(&program, "localhost", &request("POST /api/v1/commands/stop", &bearer, "")).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    assert!(asked(&program, "elsewhere.example", &request("GET /healthz", "", "")).is_err(), "it is for its own names");
}

#[test]
fn a_tls_door_says_nothing_in_plain_and_its_health_is_asked_all_the_same() {
    let program = served();
    let mut plain = TcpStream::connect(program.address()).expect("the program listens");
    plain.set_read_timeout(Some(Duration::from_secs(30))).expect("a time-out can be set");
    plain.write_all(request("GET /healthz", "", "").as_bytes()).expect("the program listens");
    let mut answer = Vec::new();
    // Whether it hangs up in order or not, nothing of HTTP comes.
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
    assert!(refused("no-such.pem", KEY).contains("http.tls_certificate = \"no-such.pem\": it cannot be read"));
    assert!(refused(CERTIFICATE, CERTIFICATE).contains("BEGIN PRIVATE KEY"));
    assert!(refused(CERTIFICATE, "").contains("of no use without its key"));
}
