//! A proxy between a client and the program that forwards and records datagrams, and drops some of the program's
//! answers. The tests interpret the datagrams.

use std::net::{SocketAddr, UdpSocket};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Longest wait for one side before the proxy checks whether it is still needed.
const GLANCE: Duration = Duration::from_millis(5);

/// A proxy that serves one client after another.
pub(crate) struct Tap {
    address: SocketAddr,
    /// The thread of the proxy ends when this `Arc` is dropped.
    passed: Arc<Mutex<Vec<Datagram>>>,
}

/// A datagram that reached the proxy.
#[derive(Clone, Debug)]
pub(crate) struct Datagram {
    /// Whether the program sent the datagram.
    pub(crate) is_answer: bool,
    pub(crate) bytes: Vec<u8>,
}

impl Datagram {
    /// Message type: 0 CON, 1 NON, 2 ACK, 3 RST.
    pub(crate) fn kind(&self) -> u8 {
        self.bytes[0] >> 4 & 3
    }

    pub(crate) fn token(&self) -> &[u8] {
        &self.bytes[4..4 + usize::from(self.bytes[0] & 0xf)]
    }
}

impl Tap {
    /// Creates a proxy that drops the first `lost` datagrams from the program.
    pub(crate) fn losing(door: SocketAddr, lost: usize) -> Tap {
        let bound = || {
            let socket = UdpSocket::bind("127.0.0.1:0").expect("a free port");
            socket.set_read_timeout(Some(GLANCE)).expect("a time-out that is not zero");
            socket
        };
        let (outer, inner) = (bound(), bound());
        inner.connect(door).expect("an address of this machine");
        let address = outer.local_addr().expect("it is bound");
        let passed = Arc::new(Mutex::new(Vec::new()));
        let noted = Arc::downgrade(&passed);
        std::thread::spawn(move || {
            let (mut client, mut bytes, mut left) = (None, [0; 2048], lost);
            while let Some(noted) = noted.upgrade() {
                let note = |is_answer, bytes: &[u8]| {
                    noted.lock().unwrap_or_else(PoisonError::into_inner).push(Datagram { is_answer, bytes: bytes.to_vec() });
                };
                if let Ok((length, from)) = outer.recv_from(&mut bytes) {
                    client = Some(from);
                    note(false, &bytes[..length]);
                    // If the program has ended, the client will notice.
                    let _ = inner.send(&bytes[..length]);
                }
                while let Ok(length) = inner.recv(&mut bytes) {
                    note(true, &bytes[..length]);
                    match client.filter(|_| left == 0) {
                        Some(client) => drop(outer.send_to(&bytes[..length], client)),
                        None => left = left.saturating_sub(1),
                    }
                }
            }
        });
        Tap { address, passed }
    }

    /// Beginning of a URL of the proxy.
    pub(crate) fn url(&self) -> String {
        format!("coap://{}", self.address)
    }

    pub(crate) fn passed(&self) -> Vec<Datagram> {
        self.passed.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
