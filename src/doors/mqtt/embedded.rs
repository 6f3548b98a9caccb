//! Our own broker, from its start to its end: clients come in by TCP and by WebSocket and are shown to the gate. What a client may do is the
//! gate's business.

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

/// After an accept has failed (as with too many open files) the next is tried this much later.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// So long the last words may take to reach the clients when the program ends; it is to end within two seconds.
const LAST_WORDS: Duration = Duration::from_millis(500);

/// How clients come to our own broker.
pub struct Ways {
    /// By TCP,
    pub listeners: Listeners,
    /// where these are let in;
    pub access: Access,
    /// and by WebSocket.
    pub web_clients: mpsc::Receiver<IncomingConnection>,
    /// Where what they say is heard, and nothing else is done (safety S7); the listeners wait there, too.
    pub hearing: Handle,
}

/// Serves these clients until `shutdown`; then every connection ends, when what was said before that has reached its client. All but the
/// hearing is done where this is called.
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
    // Every connection is told by this that it ends.
    drop(runs);
    if reception.await.is_err() {
        tracing::error!("whoever listened to MQTT clients has ended by a mistake of its own");
    }
}

/// Lets clients in, on the thread that hears.
struct Reception {
    clients: Clients,
    access: Access,
    running: Running,
    /// Where all else is done.
    work: Handle,
}

impl Reception {
    /// Lets clients in until the program ends, and then waits until they have left; whoever takes long is cut off.
    async fn receive(self, mut listeners: Listeners, mut web_clients: mpsc::Receiver<IncomingConnection>) {
        let mut clients = JoinSet::new();
        let mut running = self.running.clone();
        let (clock, mut accepts_at) = (Clock::default(), Duration::ZERO);
        loop {
            tokio::select! {
                // In any order: neither a flood of connections nor one of web clients keeps the others out.
                _ = running.changed() => break,
                Some(_) = clients.join_next() => {}
                accepted = accept_at(&mut listeners, clock, accepts_at) => match accepted {
                    Ok((stream, address)) => self.receive_one(&mut clients, incoming(stream, address, &self.access)),
                    Err(error) => {
                        tracing::warn!(%error, relieved = self.clients.evict_some(), "an MQTT connection could not be accepted");
                        // Meanwhile those come in who have their connection already.
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
        clients.spawn(self.clients.clone().attend(incoming, waiting, (self.running.clone(), self.work.clone())));
    }
}

/// The next connection, but none before then.
async fn accept_at(listeners: &mut Listeners, clock: Clock, then: Duration) -> std::io::Result<(TcpStream, SocketAddr)> {
    clock.reach(Some(then)).await;
    listeners.accept().await
}

fn incoming(stream: TcpStream, address: SocketAddr, access: &Access) -> IncomingConnection {
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "small packets of a connection will be held back");
    }
    let origin = Origin { from: address.ip(), caller: None, access: access.clone() };
    let (reader, writer) = stream.into_split();
    IncomingConnection { reader: Box::new(reader), writer: Box::new(WriteTimeoutStream::new(writer)), origin }
}

#[cfg(test)]
#[path = "embedded_tests.rs"]
mod tests;
