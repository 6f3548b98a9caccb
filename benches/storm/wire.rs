//! A connection to an MQTT broker over TCP or WebSocket that sends any bytes. Packets that come over TCP can be read.
//! The connection answers nothing by itself.

use std::io::{self, Error, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::spawn;
use std::time::Duration;

use crate::five::{bare, dressed, whole};
use crate::http::connected;
use crate::packets::{CONNACK, connect_with, text};

/// Whether all connections of this process use MQTT 5.
static IS_FIVE: AtomicBool = AtomicBool::new(false);

/// Sets whether all connections of this process use MQTT 5.
pub(crate) fn speak_five(is_five: bool) {
    IS_FIVE.store(is_five, Ordering::Relaxed);
}

pub(crate) fn is_five() -> bool {
    IS_FIVE.load(Ordering::Relaxed)
}

pub(crate) struct Wire {
    stream: TcpStream,
    is_web: bool,
    heard: Vec<u8>,
}

/// CONNECT with this name and password.
pub(crate) fn login(client_id: &str, name: &str, token: &str) -> Vec<u8> {
    // Flags: user name, password, clean session.
    connect_with(4, 0xC2, 60, &[text(client_id), text(name), text(token)].concat())
}

impl Wire {
    /// Connection on which nothing has been sent.
    pub(crate) fn silent(door: SocketAddr, source: Ipv4Addr, patience: Duration) -> io::Result<Wire> {
        Ok(Wire { stream: connected(door, source, patience)?, is_web: false, heard: Vec::new() })
    }

    /// Connection that the broker has accepted.
    pub(crate) fn let_in(door: SocketAddr, source: Ipv4Addr, connect: &[u8], patience: Duration) -> io::Result<Wire> {
        let mut wire = Wire::silent(door, source, patience)?;
        wire.say(connect)?;
        match wire.next()? {
            (CONNACK, body) if body == [0, 0] => Ok(wire),
            (first, body) => Err(Error::other(format!("CONNECT is answered with {first:#x} {body:?}"))),
        }
    }

    /// WebSocket connection on which no MQTT has been sent.
    pub(crate) fn web(door: SocketAddr, source: Ipv4Addr, patience: Duration) -> io::Result<Wire> {
        let mut stream = connected(door, source, patience)?;
        let key = "dGhlIHNhbXBsZSBub25jZQ==";
        let upgrade = format!(
            "GET /mqtt HTTP/1.1\r\nHost: {door}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n\
             Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Protocol: mqtt\r\n\r\n"
        );
        stream.write_all(upgrade.as_bytes())?;
        let mut answer = [0; 1024];
        let read = stream.read(&mut answer)?;
        if answer[..read].starts_with(b"HTTP/1.1 101") {
            return Ok(Wire { stream, is_web: true, heard: Vec::new() });
        }
        Err(Error::other(String::from_utf8_lossy(&answer[..read]).into_owned()))
    }

    /// Sends these bytes; over WebSocket, in one message.
    pub(crate) fn say(&mut self, bytes: &[u8]) -> io::Result<()> {
        if is_five() { self.say_as_it_is(&dressed(bytes)) } else { self.say_as_it_is(bytes) }
    }

    fn say_as_it_is(&mut self, bytes: &[u8]) -> io::Result<()> {
        if !self.is_web {
            return self.stream.write_all(bytes);
        }
        // RFC 6455 §5.2: a final binary frame, masked with zeros, which leaves the bytes as they are.
        let mut frame = vec![0x82];
        match u16::try_from(bytes.len()) {
            Ok(length) if length < 126 => frame.push(0x80 | length as u8),
            Ok(length) => frame.extend([&[0xFE][..], &length.to_be_bytes()].concat()),
            Err(_) => frame.extend([&[0xFF][..], &(bytes.len() as u64).to_be_bytes()].concat()),
        }
        frame.extend([0; 4]);
        frame.extend(bytes);
        self.stream.write_all(&frame)
    }

    /// Next packet that comes over TCP: its first byte and its body.
    pub(crate) fn next(&mut self) -> io::Result<(u8, Vec<u8>)> {
        loop {
            if let Some((length, head)) = whole(&self.heard) {
                let packet: Vec<u8> = self.heard.drain(..length).collect();
                let (first, body) = (packet[0], packet[head..].to_vec());
                match if is_five() { bare(first, &body) } else { Some(body) } {
                    Some(body) => return Ok((first, body)),
                    None => continue,
                }
            }
            let mut bytes = [0; 16 * 1024];
            match self.stream.read(&mut bytes)? {
                0 => return Err(ErrorKind::UnexpectedEof.into()),
                read => self.heard.extend_from_slice(&bytes[..read]),
            }
        }
    }

    /// Body of the next packet of this kind; other packets are skipped.
    pub(crate) fn until(&mut self, kind: u8) -> io::Result<Vec<u8>> {
        loop {
            let (first, body) = self.next()?;
            if first >> 4 == kind >> 4 {
                return Ok(body);
            }
        }
    }

    /// Whether the other side has closed the connection.
    pub(crate) fn is_over(&mut self) -> bool {
        let _ = self.stream.set_nonblocking(true);
        let read = self.stream.read(&mut [0; 4096]);
        let _ = self.stream.set_nonblocking(false);
        match read {
            Ok(read) => read == 0,
            Err(error) => error.kind() != ErrorKind::WouldBlock,
        }
    }

    /// Reads and discards everything on a separate thread, until the connection ends.
    pub(crate) fn read_idly(&self) -> io::Result<()> {
        let mut stream = self.stream.try_clone()?;
        spawn(move || {
            let mut bytes = [0; 64 * 1024];
            loop {
                match stream.read(&mut bytes) {
                    Ok(0) => break,
                    Err(error) if !matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => break,
                    Ok(_) | Err(_) => {}
                }
            }
        });
        Ok(())
    }
}

impl Drop for Wire {
    fn drop(&mut self) {
        // The thread of `read_idly` ends with the connection.
        let _ = self.stream.shutdown(std::net::Shutdown::Both);
    }
}
