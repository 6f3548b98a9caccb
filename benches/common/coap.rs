//! A simple CoAP client for tests and benchmarks. It sends one request at a time, sends it again when no answer
//! comes, accepts piggybacked and separate answers, and can observe. It does not reassemble blocks.

use std::io::{Error, ErrorKind, Result};
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::time::Duration;

use coap_lite::{CoapOption, MessageClass, MessageType, Packet};

/// Time without an answer after which a request is sent again.
const WAIT: Duration = Duration::from_secs(1);

/// Maximum number of times that a request is sent.
const TRIES: u32 = 10;

pub(crate) struct Coap {
    socket: UdpSocket,
    id: u16,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Reply {
    /// Code such as `2.05`.
    pub(crate) code: String,
    /// Payload as text.
    pub(crate) text: String,
}

impl Coap {
    pub(crate) fn at(door: SocketAddr) -> Coap {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("this machine has a free port");
        socket.connect(door).expect("a socket of this machine reaches it");
        socket.set_read_timeout(Some(WAIT)).expect("a wait is more than nothing");
        Coap { socket, id: 0 }
    }

    /// Sends a request such as `POST commands/stop?id=7`; a payload is sent as text.
    ///
    /// # Errors
    /// When no answer comes.
    pub(crate) fn ask(&mut self, method: &str, path: &str, payload: &str) -> Result<Reply> {
        let request = self.request(method, path, payload);
        self.exchange(&request)
    }

    /// Sends a GET that registers this client as an observer.
    ///
    /// # Errors
    /// When no answer comes.
    pub(crate) fn observe(&mut self, path: &str) -> Result<Reply> {
        let mut request = self.request("GET", path, "");
        request.add_option(CoapOption::Observe, Vec::new());
        self.exchange(&request)
    }

    /// Returns the next message, which is a notification if the client observes a resource.
    ///
    /// # Errors
    /// When no message comes.
    pub(crate) fn next(&self) -> Result<Reply> {
        self.receive().map(|packet| Reply::of(&packet))
    }

    fn request(&mut self, method: &str, path: &str, payload: &str) -> Packet {
        self.id = self.id.wrapping_add(1);
        let mut packet = Packet::new();
        packet.header.set_type(MessageType::Confirmable);
        packet.header.code = MessageClass::from(match method {
            "GET" => 1,
            "POST" => 2,
            "PUT" => 3,
            "DELETE" => 4,
            other => panic!("{other} is no method here"),
        });
        packet.header.message_id = self.id;
        packet.set_token(self.id.to_be_bytes().to_vec());
        let (path, query) = path.split_once('?').map_or((path, None), |(path, query)| (path, Some(query)));
        path.split('/').for_each(|segment| packet.add_option(CoapOption::UriPath, segment.as_bytes().to_vec()));
        query.into_iter().for_each(|query| packet.add_option(CoapOption::UriQuery, query.as_bytes().to_vec()));
        packet.payload = payload.as_bytes().to_vec();
        packet
    }

    fn exchange(&self, request: &Packet) -> Result<Reply> {
        let datagram = request.to_bytes_unlimited().map_err(|error| Error::other(error.to_string()))?;
        for _ in 0..TRIES {
            self.socket.send(&datagram)?;
            loop {
                match self.receive() {
                    Ok(answer) if answer.get_token() == request.get_token() => return Ok(Reply::of(&answer)),
                    // A notification, or a second answer to an earlier request.
                    Ok(_) => {}
                    Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => break,
                    Err(error) => return Err(error),
                }
            }
        }
        Err(ErrorKind::TimedOut.into())
    }

    /// Returns the next message that is not empty, and acknowledges it if it is confirmable.
    fn receive(&self) -> Result<Packet> {
        let mut buffer = [0; 2048];
        loop {
            let length = match self.socket.recv(&mut buffer) {
                // A signal interrupted the call because another child of this process has ended.
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                heard => heard?,
            };
            let packet = Packet::from_bytes(&buffer[..length]).map_err(|error| Error::other(error.to_string()))?;
            if packet.header.get_type() == MessageType::Confirmable {
                let [high, low] = packet.header.message_id.to_be_bytes();
                self.socket.send(&[0x60, 0, high, low])?;
            }
            if packet.header.code != MessageClass::Empty {
                return Ok(packet);
            }
        }
    }
}

impl Reply {
    fn of(packet: &Packet) -> Reply {
        let code = u8::from(packet.header.code);
        let text = String::from_utf8_lossy(&packet.payload).into_owned();
        Reply { code: format!("{}.{:02}", code >> 5, code & 0x1F), text }
    }
}
