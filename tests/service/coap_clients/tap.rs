//! A tap between a client and the door: it passes datagrams on, remembers them, and loses some of the door's. What they mean is the
//! tests' business.

use std::net::{SocketAddr, UdpSocket};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How long the tap listens to one side before it looks whether it is still needed.
const GLANCE: Duration = Duration::from_millis(5);

/// A tap for one client after another.
pub(crate) struct Tap {
    address: SocketAddr,
    /// Lives as long as the tap; its thread ends when it is gone.
    passed: Arc<Mutex<Vec<Datagram>>>,
}

/// A datagram that came to the tap.
#[derive(Clone, Debug)]
pub(crate) struct Datagram {
    /// Whether the door sent it.
    pub(crate) is_answer: bool,
    pub(crate) bytes: Vec<u8>,
}

impl Datagram {
    /// Its type: 0 CON, 1 NON, 2 ACK, 3 RST.
    pub(crate) fn kind(&self) -> u8 {
        self.bytes[0] >> 4 & 3
    }

    pub(crate) fn token(&self) -> &[u8] {
        &self.bytes[4..4 + usize::from(self.bytes[0] & 0xf)]
    }
}

impl Tap {
    /// A tap before this door, that loses the first so many datagrams of it.
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
                    // The program may be gone, which the client will find out.
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

    /// Where it is, as the beginning of a URL.
    pub(crate) fn url(&self) -> String {
        format!("coap://{}", self.address)
    }

    /// Everything that came to it.
    pub(crate) fn passed(&self) -> Vec<Datagram> {
        self.passed.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
