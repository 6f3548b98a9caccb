//! The socket of this door. It has room for many datagrams at once. No error of the socket ends the door. The
//! protocol is not here.

use std::io::{self, ErrorKind};
use std::net::SocketAddr;
use std::time::Duration;

use socket2::{Domain, SockRef, Type};
use tokio::net::UdpSocket;

use super::flood_filter::FloodFilter;
use coap_endpoint::Transmit;

/// Requested size in bytes of the receive buffer and of the send buffer. They are large, because all observers may
/// acknowledge at the same time. If a datagram does not fit, the client sends it again.
const ROOM: usize = 4 * 1024 * 1024;

/// Maximum size of a datagram in bytes. No datagram is longer, so none is cut off, and the endpoint can recognise a
/// datagram that is too long.
const LONGEST: usize = 64 * 1024;

/// Maximum number of datagrams read before other work gets a turn.
pub(super) const BATCH: usize = 64;

/// Pause after an error of the socket, before the next read.
const PAUSE: Duration = Duration::from_millis(1);

pub struct Socket {
    udp: UdpSocket,
    buffer: Vec<u8>,
}

impl Socket {
    /// Makes the door's socket from a bound socket. Must be called inside the runtime that will poll it.
    pub fn new(bound: std::net::UdpSocket) -> io::Result<Socket> {
        bound.set_nonblocking(true)?;
        let udp = UdpSocket::from_std(bound)?;
        let raw = SockRef::from(&udp);
        let asked = raw.set_recv_buffer_size(ROOM).and_then(|()| raw.set_send_buffer_size(ROOM));
        match asked.and_then(|()| Ok((raw.recv_buffer_size()?, raw.send_buffer_size()?))) {
            Ok((receive_bytes, send_bytes)) => tracing::debug!(receive_bytes, send_bytes, "the socket's buffers were enlarged"),
            Err(error) => tracing::debug!(%error, "the socket's buffers could not be enlarged"),
        }
        Ok(Socket { udp, buffer: vec![0; LONGEST] })
    }

    pub(super) async fn readable(&self) {
        // If the socket cannot be polled, the next read reports the error.
        let _ = self.udp.readable().await;
    }

    pub(super) async fn read(&mut self) -> Option<(SocketAddr, &[u8])> {
        match self.udp.try_recv_from(&mut self.buffer) {
            Ok((length, peer)) => return Some((peer, &self.buffer[..length])),
            Err(error) if error.kind() == ErrorKind::WouldBlock => {}
            Err(error) => {
                // Some systems report here that a client's port is closed. Other errors are more serious.
                tracing::debug!(%error, "a datagram could not be received");
                tokio::time::sleep(PAUSE).await;
            }
        }
        None
    }

    /// Makes the system drop every datagram that does not pass the filter.
    pub(super) fn attach(&self, filter: &FloodFilter) {
        if let Err(error) = filter.fit(&SockRef::from(&self.udp)) {
            tracing::debug!(%error, "the flood filter could not be attached to the socket");
        }
    }

    /// Sends a datagram. If it cannot be sent immediately, it is dropped, as if the network had lost it. Nothing
    /// waits for the network.
    pub(super) fn send(&self, transmit: &Transmit) {
        if let Err(error) = self.udp.try_send_to(&transmit.bytes, transmit.peer) {
            tracing::debug!(%error, peer = %transmit.peer, "a datagram could not be sent");
        }
    }
}

/// Binds a second socket to the same port at another address that the first socket covers. The port can be shared
/// only during this call, so that no other program can join.
///
/// # Errors
/// The address does not exist, or another program uses it.
pub fn beside(first: &std::net::UdpSocket, address: SocketAddr) -> io::Result<std::net::UdpSocket> {
    let (first, second) = (SockRef::from(first), socket2::Socket::new(Domain::for_address(address), Type::DGRAM, None)?);
    first.set_reuse_address(true)?;
    second.set_reuse_address(true)?;
    let bound = second.bind(&address.into());
    first.set_reuse_address(false)?;
    second.set_reuse_address(false)?;
    bound.map(|()| second.into())
}
