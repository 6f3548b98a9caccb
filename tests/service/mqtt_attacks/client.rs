//! A minimal MQTT client that sends arbitrary bytes and reads the incoming packets one by one. It has no session
//! state and sends nothing by itself.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use super::five::{bare, dressed, whole};
use super::packets::{CONNACK, PINGREQ, PINGRESP, SUBACK, publish, subscribe};

/// Longest wait for anything. It is far longer than needed, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) struct Client {
    stream: TcpStream,
    heard: Vec<u8>,
    /// Whether the connection uses MQTT 5. The client converts packets, so callers always use MQTT 3.1.1.
    is_five: bool,
}

/// An incoming packet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Came {
    /// Packet type and flags.
    pub(crate) first: u8,
    /// Bytes after the length field.
    pub(crate) body: Vec<u8>,
}

/// A received message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Message {
    pub(crate) topic: String,
    pub(crate) payload: Vec<u8>,
    pub(crate) is_kept: bool,
}

impl Client {
    /// Connects without sending anything.
    pub(crate) fn silent(at: SocketAddr) -> Client {
        Client::speaking(at, false)
    }

    /// Like `silent`, with MQTT 5 if `is_five`.
    pub(crate) fn speaking(at: SocketAddr, is_five: bool) -> Client {
        let stream = TcpStream::connect(at).expect("the broker listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a wait is more than nothing");
        stream.set_write_timeout(Some(PATIENCE)).expect("a wait is more than nothing");
        stream.set_nodelay(true).expect("a connection of this machine");
        Client { stream, heard: Vec::new(), is_five }
    }

    /// Connects with this CONNECT. Returns `None` if the broker refuses.
    pub(crate) fn try_connect(at: SocketAddr, connect: &[u8]) -> Option<Client> {
        Client::try_speaking(at, connect, false)
    }

    /// Like `try_connect`, with MQTT 5 if `is_five`.
    pub(crate) fn try_speaking(at: SocketAddr, connect: &[u8], is_five: bool) -> Option<Client> {
        let mut client = Client::speaking(at, is_five);
        client.say(connect);
        (client.next() == Some(Came { first: CONNACK, body: vec![0, 0] })).then_some(client)
    }

    pub(crate) fn say(&mut self, bytes: &[u8]) {
        assert!(self.try_say(bytes), "the broker takes it");
    }

    /// Sends these bytes and returns whether that worked, since the broker may already have closed the connection.
    pub(crate) fn try_say(&mut self, bytes: &[u8]) -> bool {
        if self.is_five { self.stream.write_all(&dressed(bytes)) } else { self.stream.write_all(bytes) }.is_ok()
    }

    /// Closes the sending side, and waits until the broker closes the other.
    pub(crate) fn hang_up(mut self) {
        let _ = self.stream.shutdown(std::net::Shutdown::Write);
        while self.next().is_some() {}
    }

    /// Next packet, or `None` if the broker has closed the connection.
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

    /// Next packet with this first byte. Other packets are skipped.
    pub(crate) fn until(&mut self, first: u8) -> Came {
        loop {
            let came = self.next().expect("the connection goes on");
            if came.first == first {
                return came;
            }
        }
    }

    /// Next message. Other packets are skipped.
    pub(crate) fn message(&mut self) -> Message {
        loop {
            if let Some(message) = self.next().expect("the connection goes on").message() {
                return message;
            }
        }
    }

    /// Subscribes and returns the code in the SUBACK.
    pub(crate) fn subscribe(&mut self, filter: &str, qos: u8) -> u8 {
        self.say(&subscribe(1, filter, qos));
        self.until(SUBACK).body[2]
    }

    pub(crate) fn publish(&mut self, topic: &str, payload: &[u8]) {
        self.say(&publish(topic, payload, 0, 0, 0));
    }

    /// Sends a ping and waits for the answer: by then the broker has processed everything sent before the ping.
    pub(crate) fn settle(&mut self) {
        self.say(&PINGREQ);
        self.until(PINGRESP);
    }

    /// Second handle of the same connection, for writing from another thread.
    pub(crate) fn mouth(&self) -> TcpStream {
        self.stream.try_clone().expect("the system has descriptors")
    }
}

impl Came {
    /// The packet as a message, if it is a PUBLISH.
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
