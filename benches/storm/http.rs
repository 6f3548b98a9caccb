//! A simple HTTP client: requests as bytes, connections from any loopback address, and whole answers. It follows no
//! redirect and reads no stream.

use std::io::{self, Error, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::time::Duration;

use socket2::{Domain, Socket, Type};

/// Persistent connection.
pub(crate) struct Kept {
    stream: TcpStream,
    heard: Vec<u8>,
}

pub(crate) struct Answer {
    pub(crate) body: String,
}

/// Connection from this local address.
pub(crate) fn connected(door: SocketAddr, source: Ipv4Addr, patience: Duration) -> io::Result<TcpStream> {
    let socket = Socket::new(Domain::IPV4, Type::STREAM, None)?;
    socket.bind(&SocketAddr::from((source, 0)).into())?;
    socket.connect_timeout(&door.into(), patience)?;
    let stream = TcpStream::from(socket);
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(patience))?;
    stream.set_write_timeout(Some(patience))?;
    Ok(stream)
}

/// One of six loopback addresses from which floods come; the operator uses 127.0.0.1.
pub(crate) fn somewhere(n: usize) -> Ipv4Addr {
    Ipv4Addr::new(127, 0, 0, u8::try_from(2 + n % 6).expect("less than 8"))
}

pub(crate) fn near(_: usize) -> Ipv4Addr {
    Ipv4Addr::LOCALHOST
}

/// Builds a request. A `body` is sent as JSON.
pub(crate) fn request(method: &str, path: &str, door: SocketAddr, token: Option<&str>, body: &str) -> Vec<u8> {
    let key = token.map(|token| format!("Authorization: Bearer {token}\r\n")).unwrap_or_default();
    let kind = if body.is_empty() { "" } else { "Content-Type: application/json\r\n" };
    let length = body.len();
    format!("{method} {path} HTTP/1.1\r\nHost: {door}\r\n{key}{kind}Content-Length: {length}\r\n\r\n{body}").into_bytes()
}

impl Kept {
    pub(crate) fn to(door: SocketAddr, source: Ipv4Addr, patience: Duration) -> io::Result<Kept> {
        Ok(Kept { stream: connected(door, source, patience)?, heard: Vec::new() })
    }

    /// Sends a request and waits for the whole answer.
    pub(crate) fn ask(&mut self, request: &[u8]) -> io::Result<Answer> {
        self.stream.write_all(request)?;
        self.answer()
    }

    /// Returns the next whole answer.
    pub(crate) fn answer(&mut self) -> io::Result<Answer> {
        let head_end = loop {
            if let Some(at) = find(&self.heard, b"\r\n\r\n") {
                break at + 4;
            }
            self.read()?;
        };
        let head = String::from_utf8_lossy(&self.heard[..head_end]).to_ascii_lowercase();
        let field = |name: &str| head.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':')).map(str::trim);
        let end = match field("content-length").and_then(|length| length.parse::<usize>().ok()) {
            Some(length) => head_end + length,
            None if field("transfer-encoding") == Some("chunked") => loop {
                if let Some(at) = find(&self.heard[head_end..], b"0\r\n\r\n") {
                    break head_end + at + 5;
                }
                self.read()?;
            },
            None => head_end,
        };
        while self.heard.len() < end {
            self.read()?;
        }
        let body = String::from_utf8_lossy(&self.heard[head_end..end]).into_owned();
        self.heard.drain(..end);
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok());
        status.map(|_: u16| Answer { body }).ok_or_else(|| Error::other(format!("no answer of HTTP: {head}")))
    }

    fn read(&mut self) -> io::Result<()> {
        let mut bytes = [0; 16 * 1024];
        match self.stream.read(&mut bytes)? {
            0 => Err(ErrorKind::UnexpectedEof.into()),
            read => {
                self.heard.extend_from_slice(&bytes[..read]);
                Ok(())
            }
        }
    }
}

fn find(bytes: &[u8], wanted: &[u8]) -> Option<usize> {
    bytes.windows(wanted.len()).position(|window| window == wanted)
}
