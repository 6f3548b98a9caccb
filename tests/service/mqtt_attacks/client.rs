//! An MQTT client as plain as can be: it sends whatever bytes it is told to, and reads what comes, packet by packet. It knows no
//! session and answers nothing by itself.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use super::five::{bare, dressed, whole};
use super::packets::{CONNACK, PINGREQ, PINGRESP, SUBACK, publish, subscribe};

/// How long anything is waited for: far longer than it takes, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A connection to a broker.
pub(crate) struct Client {
    stream: TcpStream,
    heard: Vec<u8>,
    /// Whether MQTT 5 is spoken; who uses it need not know.
    is_five: bool,
}

/// What came.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Came {
    /// Kind and flags.
    pub(crate) first: u8,
    /// What follows the length.
    pub(crate) body: Vec<u8>,
}

/// A message that came.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Message {
    pub(crate) topic: String,
    pub(crate) payload: Vec<u8>,
    pub(crate) is_kept: bool,
}

impl Client {
    /// A connection on which nothing was said.
    pub(crate) fn silent(at: SocketAddr) -> Client {
        Client::speaking(at, false)
    }

    /// The same in MQTT 5, or not.
    pub(crate) fn speaking(at: SocketAddr, is_five: bool) -> Client {
        let stream = TcpStream::connect(at).expect("the broker listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a wait is more than nothing");
        stream.set_write_timeout(Some(PATIENCE)).expect("a wait is more than nothing");
        stream.set_nodelay(true).expect("a connection of this machine");
        Client { stream, heard: Vec::new(), is_five }
    }

    /// A client that was let in with this CONNECT, if it was.
    pub(crate) fn try_connect(at: SocketAddr, connect: &[u8]) -> Option<Client> {
        Client::try_speaking(at, connect, false)
    }

    /// The same in MQTT 5, or not.
    pub(crate) fn try_speaking(at: SocketAddr, connect: &[u8], is_five: bool) -> Option<Client> {
        let mut client = Client::speaking(at, is_five);
        client.say(connect);
        (client.next() == Some(Came { first: CONNACK, body: vec![0, 0] })).then_some(client)
    }

    /// Sends these bytes.
    pub(crate) fn say(&mut self, bytes: &[u8]) {
        assert!(self.try_say(bytes), "the broker takes it");
    }

    /// Sends these bytes to a broker that may have had enough already; whether it took them.
    pub(crate) fn try_say(&mut self, bytes: &[u8]) -> bool {
        if self.is_five { self.stream.write_all(&dressed(bytes)) } else { self.stream.write_all(bytes) }.is_ok()
    }

    /// Sends no more, and waits for the end of the other side.
    pub(crate) fn hang_up(mut self) {
        let _ = self.stream.shutdown(std::net::Shutdown::Write);
        while self.next().is_some() {}
    }

    /// The next packet; `None` when the broker has closed the connection.
    pub(crate) fn next(&mut self) -> Option<Came> {
        loop {
            if let Some((length, head)) = whole(&self.heard) {
                let packet: Vec<u8> = self.heard.drain(..length).collect();
                let (first, body) = (packet[0], packet[head..].to_vec());
                match if self.is_five { bare(first, &body) } else { Some(body) } {
                    Some(body) => return Some(Came { first, body }),
                    None => continue,
                }
            }
            let mut bytes = [0; 16 * 1024];
            match self.stream.read(&mut bytes) {
                Ok(0) => return None,
                Ok(read) => self.heard.extend_from_slice(&bytes[..read]),
                Err(error) if error.kind() == ErrorKind::ConnectionReset => return None,
                Err(error) => panic!("nothing came for far too long: {error}"),
            }
        }
    }

    /// The next packet of this first byte; others are passed over.
    pub(crate) fn until(&mut self, first: u8) -> Came {
        loop {
            let came = self.next().expect("the connection goes on");
            if came.first == first {
                return came;
            }
        }
    }

    /// The next message; anything else is passed over.
    pub(crate) fn message(&mut self) -> Message {
        loop {
            if let Some(message) = self.next().expect("the connection goes on").message() {
                return message;
            }
        }
    }

    /// Subscribes; the code that it is answered with.
    pub(crate) fn subscribe(&mut self, filter: &str, qos: u8) -> u8 {
        self.say(&subscribe(1, filter, qos));
        self.until(SUBACK).body[2]
    }

    /// Publishes at QoS 0.
    pub(crate) fn publish(&mut self, topic: &str, payload: &[u8]) {
        self.say(&publish(topic, payload, 0, 0, 0));
    }

    /// Asks whether the broker is there, and waits until it has said so: everything before that has come through the gate.
    pub(crate) fn settle(&mut self) {
        self.say(&PINGREQ);
        self.until(PINGRESP);
    }

    /// A second way to the same connection, which only says something.
    pub(crate) fn mouth(&self) -> TcpStream {
        self.stream.try_clone().expect("the system has descriptors")
    }
}

impl Came {
    /// The message, if it is one.
    pub(crate) fn message(&self) -> Option<Message> {
        if self.first >> 4 != 3 {
            return None;
        }
        let length = usize::from(u16::from_be_bytes([self.body[0], self.body[1]]));
        let topic = String::from_utf8(self.body[2..2 + length].to_vec()).expect("topics are text");
        let after = if self.first & 6 == 0 { 2 + length } else { 4 + length };
        Some(Message { topic, payload: self.body[after..].to_vec(), is_kept: self.first & 1 == 1 })
    }
}
