//! The load: many concurrent confirmable GETs whose answers are all checked. The load never sleeps, so that no server
//! pays for waking it. How often a server sleeps between requests depends on the number of clients and on the other
//! load of the machine.

use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use crate::datagram::{Asking, CONTENT, GET, Told};

/// Number of concurrent clients in `gets`, with one request each.
pub(crate) const CLIENTS: usize = 64;

/// Smallest number of concurrent clients in any part.
pub(crate) const FEWEST: usize = 32;

/// Number of concurrent peers in `peers`; a receive buffer of the usual size holds more datagrams than this.
const GROUP: u32 = 100;

/// Time after which an answer counts as lost.
pub(crate) const PATIENCE: Duration = Duration::from_millis(500);

/// Numbers of requests by result.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    /// Requests with the expected answer.
    pub(crate) right: u64,
    /// Requests with any other answer.
    pub(crate) wrong: u64,
    /// Requests without an answer in time.
    pub(crate) lost: u64,
}

impl std::ops::AddAssign for Outcome {
    fn add_assign(&mut self, other: Outcome) {
        self.right += other.right;
        self.wrong += other.wrong;
        self.lost += other.lost;
    }
}

/// Sends GETs for one resource to one server and compares the answers with the expected bytes.
pub(crate) struct Load {
    server: SocketAddr,
    expected: Vec<u8>,
    requests: Requests,
    clients: Vec<UdpSocket>,
    /// Port that all `peers` share; each of them has its own address.
    port: u16,
}

impl Load {
    pub(crate) fn new(server: SocketAddr, path: &str, expected: &[u8]) -> Load {
        let clients: Vec<UdpSocket> = (0..CLIENTS).map(|_| socket(server, Ipv4Addr::LOCALHOST, 0)).collect();
        let port = clients[0].local_addr().expect("it is bound").port();
        let requests = Requests { asking: Asking::new(GET, path, &[], &[]), sent: 0 };
        Load { server, expected: expected.to_vec(), requests, clients, port }
    }

    /// Sends `count` requests from `clients` fixed clients. All clients send at once, and send again when every
    /// answer has come.
    pub(crate) fn gets(&mut self, count: usize, clients: usize) -> Outcome {
        let mut outcome = Outcome::default();
        let clients = &self.clients[..clients];
        for _ in 0..count / clients.len() {
            let tokens: Vec<u32> = clients.iter().map(|client| self.requests.send(client)).collect();
            let until = Instant::now() + PATIENCE;
            for (client, token) in clients.iter().zip(tokens) {
                look(client, token, &self.expected, until, &mut outcome);
            }
        }
        outcome
    }

    /// Sends `count` requests from `peers` peers, whose addresses are numbered from `first`. A group of peers sends
    /// at once, one request each. The function returns early when `limit` is over.
    pub(crate) fn peers(&mut self, first: u32, peers: u32, count: u32, limit: Duration) -> Outcome {
        let began = Instant::now();
        let mut outcome = Outcome::default();
        for start in (0..count).step_by(GROUP as usize).take_while(|_| began.elapsed() < limit) {
            let numbers = (start..start + GROUP).map(|number| first + number % peers);
            let sockets: Vec<UdpSocket> = numbers.map(|number| socket(self.server, address(number), self.port)).collect();
            let tokens: Vec<u32> = sockets.iter().map(|socket| self.requests.send(socket)).collect();
            let until = Instant::now() + PATIENCE;
            for (socket, token) in sockets.iter().zip(tokens) {
                look(socket, token, &self.expected, until, &mut outcome);
            }
        }
        outcome
    }
}

/// Numbered requests for one resource.
struct Requests {
    asking: Asking,
    /// Number of requests in the whole run; it makes every token unique, so that no request looks like a
    /// retransmission.
    sent: u32,
}

impl Requests {
    /// Sends the next request; its token is its number.
    fn send(&mut self, socket: &UdpSocket) -> u32 {
        self.sent += 1;
        // One client's requests are at least `FEWEST` apart, so their ids stay different until the server has long
        // forgotten the earlier ones.
        let _ = socket.send(self.asking.numbered((self.sent / FEWEST as u32) as u16, self.sent));
        self.sent
    }
}

/// Waits on a non-blocking socket for the answer to a request, and adds its result to `outcome`.
pub(crate) fn look(socket: &UdpSocket, token: u32, expected: &[u8], until: Instant, outcome: &mut Outcome) {
    let mut room = [0; 2048];
    loop {
        match socket.recv(&mut room) {
            Ok(length) => {
                let Some(told) = Told::read(&room[..length]).filter(|told| told.token == Some(token)) else { continue };
                let is_right = told.code == CONTENT && told.payload == expected;
                *(if is_right { &mut outcome.right } else { &mut outcome.wrong }) += 1;
                return;
            }
            Err(_) if Instant::now() < until => std::thread::yield_now(),
            Err(_) => break,
        }
    }
    outcome.lost += 1;
}

/// Non-blocking socket at this address and port of the local machine.
pub(crate) fn socket(server: SocketAddr, address: Ipv4Addr, port: u16) -> UdpSocket {
    let socket = UdpSocket::bind((address, port)).expect("every address that begins with 127 is this machine's");
    socket.connect(server).expect("an address of this machine");
    socket.set_nonblocking(true).expect("a socket need not block");
    socket
}

/// Address of a peer in 127.0.0.0/8, from 127.1.0.0 on, so that it is never the servers' 127.0.0.1.
fn address(number: u32) -> Ipv4Addr {
    let [_, high, middle, low] = number.to_be_bytes();
    Ipv4Addr::new(127, high + 1, middle, low)
}
