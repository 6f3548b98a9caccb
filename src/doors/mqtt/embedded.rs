//! Our own broker, from start to end. Clients connect over TCP and WebSocket, and are passed to the gate, which decides what
//! they may do.

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

/// Pause after a failed accept, as with too many open files.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// Maximum time for the last messages to reach the clients when the program ends: it must end in less than two seconds.
const LAST_WORDS: Duration = Duration::from_millis(500);

pub struct Ways {
    pub listeners: Listeners,
    /// For clients over TCP only: a web client comes with an `Access` of its own.
    pub access: Access,
    pub web_clients: mpsc::Receiver<IncomingConnection>,
    /// The runtime that reads input, and runs nothing else except short turns of `client_service` (safety S7). The listeners
    /// are polled there, too.
    pub hearing: Handle,
}

/// Serves clients until `shutdown`. Then every connection ends when everything sent before has reached its client. Input is
/// read on `hearing`; the rest runs on the caller's runtime, apart from short turns of `client_service`.
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
    // Tells every connection to end.
    drop(runs);
    if reception.await.is_err() {
        tracing::error!("an internal error has ended the task that accepts MQTT clients");
    }
}

struct Reception {
    clients: Clients,
    access: Access,
    running: Running,
    /// The runtime for everything but input (safety S7).
    work: Handle,
}

impl Reception {
    /// Accepts clients until the program ends, then waits until they have left, for `LAST_WORDS` at most. Slow clients are cut
    /// off.
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
                // `select` polls in random order, so that neither a flood of connections nor one of web clients keeps the
                // others out.
                _ = running.changed() => break,
                Some(_) = clients.join_next() => {}
                accepted = next_connection => match accepted {
                    Ok((stream, address)) => self.receive_one(&mut clients, incoming(stream, address, &self.access)),
                    Err(error) => {
                        tracing::warn!(%error, relieved = self.clients.evict_some(), "an MQTT connection could not be accepted");
                        // During the pause, clients whose connections are open already are still accepted.
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
