//! The load: confirmable GETs, many at once, every answer looked at. It never sleeps, so that no server pays for waking it. How
//! often a server itself sleeps between requests depends on how many ask at once and on what else the machine does.

use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use crate::datagram::{Asking, CONTENT, GET, Told};

/// As many clients as ask at once in `gets`, one request each.
pub(crate) const CLIENTS: usize = 64;

/// The fewest that ask at once anywhere.
pub(crate) const FEWEST: usize = 32;

/// So many clients ask at once in `peers`: fewer datagrams than a receive buffer of the usual size holds.
const GROUP: u32 = 100;

/// An answer that takes longer is lost.
pub(crate) const PATIENCE: Duration = Duration::from_millis(500);

/// What became of the requests.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    /// Answered as they must be.
    pub(crate) right: u64,
    /// Answered otherwise.
    pub(crate) wrong: u64,
    /// Not answered in time.
    pub(crate) lost: u64,
}

impl std::ops::AddAssign for Outcome {
    fn add_assign(&mut self, other: Outcome) {
        self.right += other.right;
        self.wrong += other.wrong;
        self.lost += other.lost;
    }
}

/// Asks one server for one resource, and knows the answer.
pub(crate) struct Load {
    server: SocketAddr,
    expected: Vec<u8>,
    requests: Requests,
    clients: Vec<UdpSocket>,
    /// The port of all `peers`, each of which has an address of its own.
    port: u16,
}

impl Load {
    /// Of this resource, which is to be answered so.
    pub(crate) fn new(server: SocketAddr, path: &str, expected: &[u8]) -> Load {
        let clients: Vec<UdpSocket> = (0..CLIENTS).map(|_| socket(server, Ipv4Addr::LOCALHOST, 0)).collect();
        let port = clients[0].local_addr().expect("it is bound").port();
        let requests = Requests { asking: Asking::new(GET, path, &[], &[]), sent: 0 };
        Load { server, expected: expected.to_vec(), requests, clients, port }
    }

    /// So many requests from so many clients, always the same: all of them ask at once, and again when all have their answers.
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

    /// So many requests in all from so many peers, each with an address of its own from number `first` on: a group of peers asks
    /// at once, one request each. It ends early when `limit` is over.
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

/// Requests of one kind, each numbered.
struct Requests {
    asking: Asking,
    /// How many there were in the whole run: none of them may be taken for another one sent again.
    sent: u32,
}

impl Requests {
    /// Sends one more; its token is its number.
    fn send(&mut self, socket: &UdpSocket) -> u32 {
        self.sent += 1;
        // Requests of one client are at least so many apart, so that their ids differ until long after they are forgotten.
        let _ = socket.send(self.asking.numbered((self.sent / FEWEST as u32) as u16, self.sent));
        self.sent
    }
}

/// Waits for the answer to a request on a socket that does not block, and looks at it.
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

/// A socket that does not block, at this address and port of this machine.
pub(crate) fn socket(server: SocketAddr, address: Ipv4Addr, port: u16) -> UdpSocket {
    let socket = UdpSocket::bind((address, port)).expect("every address that begins with 127 is this machine's");
    socket.connect(server).expect("an address of this machine");
    socket.set_nonblocking(true).expect("a socket need not block");
    socket
}

/// The address of a peer; none of them is the servers' own.
fn address(number: u32) -> Ipv4Addr {
    let [_, high, middle, low] = number.to_be_bytes();
    Ipv4Addr::new(127, high + 1, middle, low)
}
