//! Several TCP ports that are used like one, such as those of `127.0.0.1` and `::1`. The number of connections is
//! limited elsewhere.

use std::io;
use std::net::SocketAddr;
use std::task::Poll;

use socket2::SockRef;
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::Handle;

#[derive(Debug)]
pub struct Listeners {
    ports: Vec<TcpListener>,
    /// The port that is polled first. The ports take turns, so that a crowd at one port does not block another port.
    turn: usize,
    /// The runtime that polls the ports and reads input (safety S7).
    pub(super) thread: Handle,
}

impl Listeners {
    /// Listens to ports that are bound and non-blocking. Must be called inside the runtime that will poll them.
    pub fn new(bound: Vec<std::net::TcpListener>) -> io::Result<Listeners> {
        // The system limits this to its own maximum length of a listen queue.
        bound.iter().try_for_each(|port| SockRef::from(port).listen(i32::MAX))?;
        let ports = bound.into_iter().map(TcpListener::from_std).collect::<io::Result<_>>()?;
        Ok(Listeners { ports, turn: 0, thread: Handle::current() })
    }

    pub fn port(&self) -> u16 {
        self.ports.first().and_then(|port| port.local_addr().ok()).map_or(0, |address| address.port())
    }

    pub fn are_local(&self) -> bool {
        self.ports.iter().all(|port| port.local_addr().is_ok_and(|address| address.ip().to_canonical().is_loopback()))
    }

    pub async fn accept(&mut self) -> io::Result<(TcpStream, SocketAddr)> {
        let Listeners { ports, turn, .. } = self;
        std::future::poll_fn(|cx| {
            for step in 0..ports.len() {
                let asked = (*turn + step) % ports.len();
                if let Poll::Ready(accepted) = ports[asked].poll_accept(cx) {
                    *turn = asked + 1;
                    return Poll::Ready(accepted);
                }
            }
            Poll::Pending
        })
        .await
    }
}

impl From<TcpListener> for Listeners {
    /// Listens to one port. Must be called inside the runtime that will poll the port.
    fn from(port: TcpListener) -> Listeners {
        Listeners { ports: vec![port], turn: 0, thread: Handle::current() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S9.
    #[tokio::test]
    async fn a_crowd_at_one_port_keeps_nobody_waiting_at_another() {
        let bound = || {
            let port = std::net::TcpListener::bind("127.0.0.1:0").expect("there is a free port");
            port.set_nonblocking(true).expect("it need not block");
            (port.local_addr().expect("it is bound"), port)
        };
        let [(one, first), (other, second)] = [bound(), bound()];
        let mut listeners = Listeners::new(vec![first, second]).expect("they can be waited for");
        assert!(listeners.are_local());
        let mut crowd = Vec::new();
        for _ in 0..5 {
            crowd.push(TcpStream::connect(one).await.expect("it is listened to"));
        }
        let newcomer = TcpStream::connect(other).await.expect("it is listened to");
        let mut came = Vec::new();
        for _ in 0..2 {
            came.push(listeners.accept().await.expect("somebody is there").1);
        }
        assert!(came.contains(&newcomer.local_addr().expect("it is connected")), "{came:?}");
    }
}
