//! Our own broker, from its start to its end. It accepts clients over TCP and WebSocket and passes them to the gate,
//! which decides what they may do.

use std::net::SocketAddr;
use std::time::Duration;

use tokio::net::TcpStream;
use tokio::runtime::Handle;
use tokio::sync::{mpsc, watch};
use tokio::task::JoinSet;

use super::client_io::Running;
use super::clients::Clients;
use super::incoming::{IncomingConnection, Origin};
use crate::access::Access;
use crate::doors::listeners::Listeners;
use crate::doors::write_timeout::WriteTimeoutStream;
use crate::runtime::clock::Clock;

/// Pause after a connection could not be accepted, for example because too many files are open.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// Maximum time for sending the last messages to clients when the program ends. The program must end in less than two
/// seconds.
const LAST_WORDS: Duration = Duration::from_millis(500);

pub struct Ways {
    pub listeners: Listeners,
    /// Access rules for clients over TCP. Each web client has an `Access` of its own.
    pub access: Access,
    pub web_clients: mpsc::Receiver<IncomingConnection>,
    /// The runtime that reads input and polls the listeners. Apart from short turns of `client_service` it runs
    /// nothing else (safety S7).
    pub hearing: Handle,
}

/// Serves clients until `shutdown`. Then each connection is closed once its client has received everything that was
/// published before. Input is read on `hearing`. Everything else runs on the caller's runtime, apart from short turns
/// of `client_service`.
pub async fn serve(clients: Clients, ways: Ways, shutdown: impl Future<Output = ()>) {
    let Ways { listeners, access, web_clients, hearing } = ways;
    let (runs, running) = watch::channel(());
    let keeper = clients.clone();
    let reception = Reception { clients, access, running, work: Handle::current() };
    let reception = hearing.spawn(reception.receive(listeners, web_clients));
    tokio::select! {
        () = shutdown => {}
        () = keeper.keep() => {}
    }
    // Dropping `runs` tells every connection to end.
    drop(runs);
    if reception.await.is_err() {
        tracing::error!("an internal error has ended the task that accepts MQTT clients");
    }
}

struct Reception {
    clients: Clients,
    access: Access,
    running: Running,
    /// The runtime for everything except reading input (safety S7).
    work: Handle,
}

impl Reception {
    /// Accepts clients until the program ends. Then waits at most `LAST_WORDS` until they have left, and disconnects
    /// the rest.
    async fn receive(self, mut listeners: Listeners, mut web_clients: mpsc::Receiver<IncomingConnection>) {
        let mut clients = JoinSet::new();
        let mut running = self.running.clone();
        let (clock, mut accepts_at) = (Clock::default(), Duration::ZERO);
        loop {
            let next_connection = async {
                clock.reach(Some(accepts_at)).await;
                listeners.accept().await
            };
            tokio::select! {
                // `select` polls its branches in random order. So a flood of TCP connections does not block web
                // clients, nor a flood of web clients TCP connections.
                _ = running.changed() => break,
                Some(_) = clients.join_next() => {}
                accepted = next_connection => match accepted {
                    Ok((stream, address)) => self.receive_one(&mut clients, incoming(stream, address, &self.access)),
                    Err(error) => {
                        tracing::warn!(%error, relieved = self.clients.evict_some(), "an MQTT connection could not be accepted");
                        // After the pause the next TCP client is accepted. Web clients are accepted during the pause
                        // too.
                        accepts_at = clock.now().since_start + ACCEPT_PAUSE;
                    }
                },
                Some(incoming) = web_clients.recv() => self.receive_one(&mut clients, incoming),
            }
        }
        drop(listeners);
        let ended = async { while clients.join_next().await.is_some() {} };
        if tokio::time::timeout(LAST_WORDS, ended).await.is_err() {
            tracing::debug!(cut = clients.len(), "some MQTT clients were cut off");
        }
    }

    fn receive_one(&self, clients: &mut JoinSet<()>, incoming: IncomingConnection) {
        let waiting = self.clients.admit_pending(incoming.origin.from);
        clients.spawn(self.clients.clone().attend(incoming, waiting, self.running.clone(), self.work.clone()));
    }
}

fn incoming(stream: TcpStream, address: SocketAddr, access: &Access) -> IncomingConnection {
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "TCP_NODELAY could not be set: small packets may be delayed");
    }
    let origin = Origin { from: address.ip(), caller: None, access: access.clone() };
    let (reader, writer) = stream.into_split();
    IncomingConnection { reader: Box::new(reader), writer: Box::new(WriteTimeoutStream::new(writer)), origin }
}

#[cfg(test)]
#[path = "embedded_tests.rs"]
mod tests;
