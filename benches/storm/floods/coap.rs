//! Floods of the CoAP door from this machine, where no sign-in is needed.

use std::io;
use std::net::UdpSocket;
use std::sync::Arc;

use coap_lite::{CoapOption, MessageClass, MessageType, Packet};

use crate::course::Course;
use crate::http::somewhere;

/// Number of concurrent clients.
const CLIENTS: usize = 8;

/// Datagrams sent before the received ones are read.
const BURST: u16 = 32;

pub(super) fn gets(course: &Arc<Course>) {
    course.clients(CLIENTS, |course, n| {
        let path = ["state", "map", "robot", ".well-known/core"][n % 4];
        pour(course, n, |id| request(1, path, id, b"").to_bytes())
    });
}

/// Commands with invalid values.
pub(super) fn refused(course: &Arc<Course>) {
    course.clients(CLIENTS, |course, n| {
        let (code, path) = [(3, "temperature"), (2, "commands/goto")][n % 2];
        pour(course, n, |id| request(code, path, id, br#"{"celsius":"x","x":-1}"#).to_bytes())
    });
}

/// Invalid or truncated messages.
pub(super) fn malformed(course: &Arc<Course>) {
    course.clients(CLIENTS, |course, n| {
        pour(course, n, |id| {
            let mut datagram = request(1, "state", id, b"x").to_bytes()?;
            let at = usize::from(id) % datagram.len();
            match id % 4 {
                0 => datagram.truncate(at),
                1 => datagram[at] ^= 0xFF,
                2 => datagram = vec![id as u8; 1000],
                _ => datagram[0] = 0x4F,
            }
            Ok(datagram)
        })
    });
}

/// Observers on new ports that never answer.
pub(super) fn observers(course: &Arc<Course>) {
    course.clients(CLIENTS, |course, n| {
        let socket = UdpSocket::bind((somewhere(n), 0))?;
        socket.connect(course.doors.coap)?;
        for (id, path) in (0..).zip(["robot", "mission", "state", "map"]) {
            let mut packet = request(1, path, id, b"");
            packet.add_option(CoapOption::Observe, Vec::new());
            let _ = socket.send(&packet.to_bytes().map_err(|error| io::Error::other(error.to_string()))?);
            course.did(1);
        }
        Ok(())
    });
}

fn request(code: u8, path: &str, id: u16, payload: &[u8]) -> Packet {
    let mut packet = Packet::new();
    packet.header.set_type(MessageType::Confirmable);
    packet.header.code = MessageClass::from(code);
    packet.header.message_id = id;
    packet.set_token(id.to_be_bytes().to_vec());
    path.split('/').for_each(|segment| packet.add_option(CoapOption::UriPath, segment.as_bytes().to_vec()));
    packet.payload = payload.to_vec();
    packet
}

/// Sends the datagram made for each number as fast as the system accepts it, and discards what it receives.
fn pour(course: &Course, n: usize, datagram: impl Fn(u16) -> Result<Vec<u8>, coap_lite::error::MessageError>) -> io::Result<()> {
    let socket = UdpSocket::bind((somewhere(n), 0))?;
    socket.connect(course.doors.coap)?;
    socket.set_nonblocking(true)?;
    let mut id = 0_u16;
    while course.goes_on() {
        for _ in 0..BURST {
            id = id.wrapping_add(1);
            let datagram = datagram(id).map_err(|error| io::Error::other(error.to_string()))?;
            // A datagram that does not fit into the system's buffers is lost, as on any network.
            let _ = socket.send(&datagram);
        }
        course.did(BURST.into());
        while socket.recv(&mut [0; 2048]).is_ok() {}
    }
    Ok(())
}
