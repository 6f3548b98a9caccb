//! The beginning and the end of a connection: the TLS handshake, if there is TLS, and the eviction. `connection` reads what comes
//! in between.

use std::io::Read;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use bytes::BytesMut;
use socket2::SockRef;
use tokio::net::TcpStream;
use tokio::sync::Notify;
use tokio::time::timeout;

use super::connection::Connection;
use super::context::ServerContext;
use crate::doors::connection_limits::PendingConnection;
use crate::doors::http::peer::Peer;
use crate::doors::http::tls::Tls;

/// Maximum duration of a TLS handshake.
const HANDSHAKE_TIME: Duration = Duration::from_secs(10);

/// Maximum number of bytes read from a newcomer before its turn comes; a STOP is shorter.
const FIRST_WORDS: usize = 1024;

/// Serves one connection to its end, or until it is evicted. A client's faults are only logged.
pub(in crate::doors::http) async fn converse(stream: TcpStream, address: SocketAddr, context: Arc<ServerContext>) {
    let peer = Peer { address: address.ip(), is_encrypted: context.tls.is_some() };
    let cut = Arc::new(Notify::new());
    let waiting = context.pending.admit(peer.address, Arc::clone(&cut));
    let has_to_go = async {
        cut.notified().await;
        // What has come already is read before the eviction, which may be requested while other tasks have their turn.
        tokio::task::yield_now().await;
    };
    tokio::select! {
        biased;
        () = encrypted(stream, peer, waiting, Arc::clone(&cut), context) => {}
        () = has_to_go => tracing::debug!("a connection gave way to a newer one"),
    }
}

/// Performs the TLS handshake, if there is TLS, and reads the connection.
async fn encrypted(stream: TcpStream, peer: Peer, waiting: PendingConnection, cut: Arc<Notify>, context: Arc<ServerContext>) {
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "small packets of a connection will be held back");
    }
    let Some(Tls(acceptor)) = context.tls.clone() else {
        let said = first_words(&stream);
        let (from, to) = stream.into_split();
        return Connection::new(from, to, peer, waiting, cut, context).hear(said).await;
    };
    // Boxed, because most connections do not use TLS.
    match timeout(HANDSHAKE_TIME, Box::pin(acceptor.accept(stream))).await {
        Ok(Ok(stream)) => {
            let (from, to) = tokio::io::split(stream);
            Box::pin(Connection::new(from, to, peer, waiting, cut, context).hear(BytesMut::new())).await;
        }
        Ok(Err(error)) => tracing::debug!(%error, "a client could not agree on encryption"),
        Err(_) => tracing::debug!("a client did not agree on encryption in time"),
    }
}

/// Reads what a newcomer has sent already. It asks the system, because the event loop learns only at its next poll that bytes
/// have come.
fn first_words(stream: &TcpStream) -> BytesMut {
    let mut said = BytesMut::zeroed(FIRST_WORDS);
    // No bytes, the end and an error are found again by the next read.
    let length = (&*SockRef::from(stream)).read(&mut said).unwrap_or(0);
    said.truncate(length);
    said
}
