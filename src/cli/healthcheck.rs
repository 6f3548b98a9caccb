//! `hallsweep healthcheck`: asks a running hallsweep for `/healthz`, so that a container needs no other program for it.
//! A plain socket with time-outs; no HTTP client is wanted for one line.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use super::failure::Failure;

/// A healthy program answers at once; this leaves room for a busy machine and stays below a container's own time-out.
const TIMEOUT: Duration = Duration::from_secs(2);

/// As much of the answer as is looked at: its first line.
const STATUS_LINE: usize = 64;

/// Asks the program at `address`.
///
/// # Errors
/// `Failure::Run` when it does not answer in time, or not with 200.
pub fn run(address: SocketAddr) -> Result<(), Failure> {
    let answer = ask(address).map_err(|error| Failure::Run(format!("no answer from http://{address}/healthz: {error}")))?;
    let status = answer.lines().next().unwrap_or_default();
    if status.split_whitespace().nth(1) == Some("200") {
        return Ok(());
    }
    Err(Failure::Run(format!("http://{address}/healthz answers `{status}`, not 200: see the log of the program there")))
}

fn ask(address: SocketAddr) -> std::io::Result<String> {
    let mut stream = TcpStream::connect_timeout(&address, TIMEOUT)?;
    stream.set_read_timeout(Some(TIMEOUT))?;
    stream.set_write_timeout(Some(TIMEOUT))?;
    // Whole and at once: an answer to the first piece of a question could cut off the rest of it.
    stream.write_all(format!("GET /healthz HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").as_bytes())?;
    let mut answer = Vec::new();
    stream.take(STATUS_LINE as u64).read_to_end(&mut answer)?;
    Ok(String::from_utf8_lossy(&answer).into_owned())
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
