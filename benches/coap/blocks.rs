//! Block-wise transfers: a few clients fetch the same 50 kB repeatedly, block by block, and compare every byte.

use std::net::{Ipv4Addr, SocketAddr, UdpSocket};
use std::time::Instant;

use crate::client::BLOCK;
use crate::datagram::{Asking, BLOCK2, GET, block};
use crate::load::{Outcome, PATIENCE, look, socket};

/// Number of concurrent clients.
const CLIENTS: usize = 8;

/// Blocks per transfer: 50,176 bytes.
pub(crate) const BLOCKS: u32 = 49;

/// Fetches `path` `transfers` times in all; the outcome counts blocks.
pub(crate) fn fetch(server: SocketAddr, path: &str, expected: &[u8], transfers: usize) -> Outcome {
    let mut askings: Vec<Asking> =
        (0..BLOCKS).map(|number| Asking::new(GET, path, &[(BLOCK2, &block(number, false))], &[])).collect();
    let sockets: Vec<UdpSocket> = (0..CLIENTS).map(|_| socket(server, Ipv4Addr::LOCALHOST, 0)).collect();
    let mut outcome = Outcome::default();
    let mut id = 0;
    for _ in 0..transfers / CLIENTS {
        for (asking, part) in askings.iter_mut().zip(expected.chunks(BLOCK)) {
            id += 1;
            for socket in &sockets {
                let _ = socket.send(asking.numbered(id, id.into()));
            }
            let until = Instant::now() + PATIENCE;
            sockets.iter().for_each(|socket| look(socket, id.into(), part, until, &mut outcome));
        }
    }
    outcome
}
