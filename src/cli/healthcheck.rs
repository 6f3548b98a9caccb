//! `hallsweep healthcheck`: asks a running hallsweep for `/healthz`, so that a container needs no other program for
//! its health check. It uses a plain socket with time-outs instead of an HTTP client. A TLS door is recognised by its
//! answer to a plain request; `unverified` then asks again over TLS.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use super::failure::Failure;

mod unverified;

/// Time-out. A healthy program answers at once, and this time is enough on a busy machine. It is shorter than a
/// container's own time-out.
const TIMEOUT: Duration = Duration::from_secs(2);

/// Maximum number of bytes to read: enough for the first line of the answer.
const STATUS_LINE: u64 = 64;

/// The first byte of a TLS door's answer to a client that does not speak TLS (an alert, RFC 8446, section 5.1).
const ALERT: u8 = 21;

pub fn run(address: SocketAddr) -> Result<(), Failure> {
    let plain = ask(address, Ok);
    let (at, answer) = match plain {
        Ok(answer) if answer.first() == Some(&ALERT) => {
            let at = format!("https://{address}/healthz");
            if !address.ip().is_loopback() {
                let advice = "healthcheck does not verify certificates, so run it on the same machine with --http 127.0.0.1:PORT";
                return Err(Failure::Run(format!("{at} speaks TLS: {advice}")));
            }
            (at, ask(address, unverified::encrypted))
        }
        other => (format!("http://{address}/healthz"), other),
    };
    let answer = answer.map_err(|error| Failure::Run(format!("no answer from {at}: {error}")))?;
    let answer = String::from_utf8_lossy(&answer);
    let status = answer.lines().next().unwrap_or_default();
    if status.split_whitespace().nth(1) == Some("200") {
        return Ok(());
    }
    Err(Failure::Run(format!("{at} answers `{status}`, not 200: see the log of the program there")))
}

/// Sends the request; returns the beginning of the answer. `through` turns the socket into the connection to use,
/// such as a TLS connection.
fn ask<S: Read + Write>(address: SocketAddr, through: impl Fn(TcpStream) -> std::io::Result<S>) -> std::io::Result<Vec<u8>> {
    let stream = TcpStream::connect_timeout(&address, TIMEOUT)?;
    stream.set_read_timeout(Some(TIMEOUT))?;
    stream.set_write_timeout(Some(TIMEOUT))?;
    let mut stream = through(stream)?;
    // The request is sent in one write. After a first part alone, the server could answer and close before the rest
    // is sent.
    stream.write_all(format!("GET /healthz HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").as_bytes())?;
    stream.flush()?;
    let mut answer = Vec::new();
    let read = stream.take(STATUS_LINE).read_to_end(&mut answer);
    // An error after the beginning of the answer does not matter.
    if answer.is_empty() { read.map(|_| answer) } else { Ok(answer) }
}

#[cfg(test)]
mod tests {
    use std::net::TcpListener;

    use super::*;

    fn answered_with(answer: &'static str) -> Result<(), Failure> {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let address = listener.local_addr().expect("a bound port");
        let server = std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().expect("the question");
            let mut question = Vec::new();
            while !question.ends_with(b"\r\n\r\n") {
                let mut letter = [0];
                stream.read_exact(&mut letter).expect("the whole question");
                question.extend(letter);
            }
            assert!(question.starts_with(b"GET /healthz HTTP/1.1\r\n"));
            stream.write_all(answer.as_bytes()).expect("the answer");
        });
        let said = run(address);
        server.join().expect("the server saw the right question");
        said
    }

    #[test]
    fn a_200_is_well_and_anything_else_is_not() {
        assert!(answered_with("HTTP/1.1 200 OK\r\n\r\nok").is_ok());
        let said = answered_with("HTTP/1.1 503 Service Unavailable\r\n\r\n").expect_err("not well").to_string();
        assert!(said.contains("503 Service Unavailable"), "{said}");
        assert!(answered_with("").is_err());
    }

    #[test]
    fn nobody_there_is_a_failure_with_the_address_in_it() {
        let address = "127.0.0.1:1".parse().expect("an address at whose port nobody listens");
        assert!(run(address).expect_err("nobody listens").to_string().contains(&address.to_string()));
    }
}
