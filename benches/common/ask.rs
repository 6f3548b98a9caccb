//! One HTTP request on a separate connection, as simple as possible, so that its cost is the program's. It follows no
//! redirect and reads no stream.

use std::io::{Read, Write};
use std::net::TcpStream;

/// Sends a request and returns the whole answer, headers included. A `body` is sent as JSON.
///
/// # Errors
/// When nothing listens at `address`, or the connection breaks.
pub(crate) fn ask(address: &str, method: &str, path: &str, body: &str) -> std::io::Result<String> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_nodelay(true)?;
    let kind = if body.is_empty() { "" } else { "Content-Type: application/json\r\n" };
    let length = body.len();
    let request = format!(
        "{method} {path} HTTP/1.1\r\nHost: {address}\r\n{kind}Content-Length: {length}\r\nConnection: close\r\n\r\n{body}"
    );
    stream.write_all(request.as_bytes())?;
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer)?;
    Ok(String::from_utf8_lossy(&answer).into_owned())
}
