//! A CoAP client as plain as can be, for tests and benchmarks: it asks one thing at a time, again when something is lost, takes
//! an answer with the acknowledgement or after it, and can be told of changes. It puts no blocks together.

use std::io::{Error, ErrorKind, Result};
use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::time::Duration;

use coap_lite::{CoapOption, MessageClass, MessageType, Packet};

/// After so long without an answer a request is sent again.
const WAIT: Duration = Duration::from_secs(1);

/// So often it is sent.
const TRIES: u32 = 10;

/// One client, on a port of its own.
pub(crate) struct Coap {
    socket: UdpSocket,
    id: u16,
}

/// What was answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Reply {
    /// As `2.05`.
    pub(crate) code: String,
    /// What it carries, as text.
    pub(crate) text: String,
}

impl Coap {
    /// A client of the door at this address.
    pub(crate) fn at(door: SocketAddr) -> Coap {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).expect("this machine has a free port");
        socket.connect(door).expect("a socket of this machine reaches it");
        socket.set_read_timeout(Some(WAIT)).expect("a wait is more than nothing");
        Coap { socket, id: 0 }
    }

    /// Asks, as `POST commands/stop?id=7`; a payload is sent as text.
    ///
    /// # Errors
    /// When nobody answers.
    pub(crate) fn ask(&mut self, method: &str, path: &str, payload: &str) -> Result<Reply> {
        let request = self.request(method, path, payload);
        self.exchange(&request)
    }

    /// Asks, and is told of changes from now on.
    ///
    /// # Errors
    /// When nobody answers.
    pub(crate) fn observe(&mut self, path: &str) -> Result<Reply> {
        let mut request = self.request("GET", path, "");
        request.add_option(CoapOption::Observe, Vec::new());
        self.exchange(&request)
    }

    /// The next of what was not read yet: news of something observed, as far as this client sees.
    ///
    /// # Errors
    /// When nothing comes.
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
                    // News, or the answer to something that was asked before and answered twice.
                    Ok(_) => {}
                    Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => break,
                    Err(error) => return Err(error),
                }
            }
        }
        Err(ErrorKind::TimedOut.into())
    }

    /// The next message that says something; one that wants to be acknowledged is.
    fn receive(&self) -> Result<Packet> {
        let mut buffer = [0; 2048];
        loop {
            let length = match self.socket.recv(&mut buffer) {
                // A child of the same process has ended.
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
