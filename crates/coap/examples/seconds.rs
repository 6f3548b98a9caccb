//! A server with one resource, `/seconds`, which tells how long it has been running. Read and observe it with
//! `coap-client-notls -s 5 -m get coap://127.0.0.1:5700/seconds`. The program owns the socket and the clock; the
//! endpoint does the rest.
#![expect(clippy::disallowed_methods, reason = "this is a program, and reads the clock for the endpoint")]

use std::fs::File;
use std::io::Read;
use std::net::UdpSocket;
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use coap_endpoint::{Answer, Code, Endpoint, Format, Method, Request, Response};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut secret = [0; 32];
    File::open("/dev/urandom")?.read_exact(&mut secret)?;
    let (start, since_1970) = (Instant::now(), SystemTime::now().duration_since(SystemTime::UNIX_EPOCH)?);
    let mut endpoint = Endpoint::new(secret).started_at(since_1970);
    let (socket, mut buffer) = (UdpSocket::bind("127.0.0.1:5700")?, [0; 65_536]);
    loop {
        let now = start.elapsed();
        for (subject, request) in endpoint.subjects() {
            endpoint.handle_change(subject, vec![Arc::new(answer(&request, now))], now);
        }
        endpoint.handle_timeout(now);
        while let Some((exchange, request)) = endpoint.poll_request() {
            endpoint.handle_answer(exchange, Answer::observable(answer(&request, now)), now);
        }
        while let Some(datagram) = endpoint.poll_transmit() {
            // A datagram that cannot be sent counts as lost on the way.
            let _ = socket.send_to(&datagram.bytes, datagram.peer);
        }
        let next_second = Duration::from_secs(now.as_secs() + 1);
        let due = endpoint.poll_timeout().map_or(next_second, |due| due.min(next_second));
        socket.set_read_timeout(Some(due.saturating_sub(start.elapsed()).max(Duration::from_millis(1))))?;
        if let Ok((length, peer)) = socket.recv_from(&mut buffer) {
            endpoint.handle_datagram(peer, &buffer[..length], start.elapsed());
        }
    }
}

fn answer(request: &Request, now: Duration) -> Response {
    match (request.method, request.path_text().as_str()) {
        (Method::Get, "/seconds") => Response::content(Format::TEXT, now.as_secs().to_string().into_bytes()),
        (_, "/seconds") => Response::refusal(Code::METHOD_NOT_ALLOWED, "it can only be read"),
        (_, path) => Response::refusal(Code::NOT_FOUND, format!("there is no {path}")),
    }
}
