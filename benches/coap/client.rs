//! A client that sends one request at a time and waits for the answer. It prepares the servers and makes no load.

use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicU16, Ordering};
use std::time::Duration;

use crate::datagram::{Asking, BLOCK1, BLOCK2, CONTENT, CONTINUE, FORMAT, GET, JSON, POST, PUT, Told, acknowledgement, block};

/// Time after which an answer counts as lost.
const PATIENCE: Duration = Duration::from_millis(500);

/// Size of a block, in bytes.
pub(crate) const BLOCK: usize = 1024;

pub(crate) struct Client {
    socket: UdpSocket,
}

/// Code and payload of an answer.
pub(crate) type Answer = (u8, Vec<u8>);

impl Client {
    pub(crate) fn new(server: SocketAddr) -> Client {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
        socket.connect(server).expect("an address of this machine");
        socket.set_read_timeout(Some(PATIENCE)).expect("a time");
        Client { socket }
    }

    /// Returns the answer to a GET, which is at least the first block; `None` when no answer comes.
    pub(crate) fn get(&mut self, path: &str) -> Option<Answer> {
        self.ask(Asking::new(GET, path, &[], &[]))
    }

    pub(crate) fn post(&mut self, path: &str) -> Option<Answer> {
        self.ask(Asking::new(POST, path, &[], &[]))
    }

    pub(crate) fn put(&mut self, path: &str, json: &str) -> Option<Answer> {
        self.ask(Asking::new(PUT, path, &[(FORMAT, &[JSON])], json.as_bytes()))
    }

    /// Sends `bytes` with PUT, block by block.
    pub(crate) fn put_blocks(&mut self, path: &str, bytes: &[u8]) -> Option<Answer> {
        let mut last = None;
        let count = bytes.len().div_ceil(BLOCK);
        for (number, part) in bytes.chunks(BLOCK).enumerate() {
            let option = block(number as u32, number + 1 < count);
            let answer = self.ask(Asking::new(PUT, path, &[(BLOCK1, &option)], part))?;
            last = Some(answer).filter(|(code, _)| *code == CONTINUE || number + 1 == count);
            last.as_ref()?;
        }
        last
    }

    /// Returns the first `count` blocks of the resource, or all blocks if it has fewer.
    pub(crate) fn blocks(&mut self, path: &str, count: u32) -> Vec<u8> {
        let mut bytes = Vec::new();
        for number in 0..count {
            let answer = self.ask(Asking::new(GET, path, &[(BLOCK2, &block(number, false))], &[]));
            let Some((CONTENT, part)) = answer else { break };
            bytes.extend_from_slice(&part);
        }
        bytes
    }

    fn ask(&mut self, mut asking: Asking) -> Option<Answer> {
        static NUMBER: AtomicU16 = AtomicU16::new(1);
        let id = NUMBER.fetch_add(1, Ordering::Relaxed);
        self.socket.send(asking.numbered(id, id.into())).ok()?;
        let mut room = [0; 2048];
        loop {
            let length = self.socket.recv(&mut room).ok()?;
            let Some(told) = Told::read(&room[..length]) else { continue };
            if told.confirmable {
                self.socket.send(&acknowledgement(told.id)).ok()?;
            }
            if told.token == Some(id.into()) {
                return Some((told.code, told.payload.to_vec()));
            }
        }
    }
}
