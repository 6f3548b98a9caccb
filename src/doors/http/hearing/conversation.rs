//! How a connection begins and ends: encrypted where connections are, and cut when its room is needed. What is heard in between stands in
//! `connection`.

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

/// How long a client may take to agree on encryption.
const HANDSHAKE_TIME: Duration = Duration::from_secs(10);

/// Bytes read from a newcomer before its turn comes; a STOP is shorter.
const FIRST_WORDS: usize = 1024;

/// One connection, to its end or until its place is needed. What a client does wrong with it is the client's business.
pub(in crate::doors::http) async fn converse((stream, address): (TcpStream, SocketAddr), context: Arc<ServerContext>) {
    let peer = Peer { address: address.ip(), is_encrypted: context.tls.is_some() };
    let cut = Arc::new(Notify::new());
    let waiting = context.pending.admit(peer.address, Arc::clone(&cut));
    let has_to_go = async {
        cut.notified().await;
        // What has come already is heard before room is made: it is asked for while others have their turn.
        tokio::task::yield_now().await;
    };
    tokio::select! {
        biased;
        () = encrypted(stream, peer, (waiting, Arc::clone(&cut)), context) => {}
        () = has_to_go => tracing::debug!("a connection gave way to a newer one"),
    }
}

/// Agrees on encryption, where there is any, and then hears.
async fn encrypted(stream: TcpStream, peer: Peer, waiting: (PendingConnection, Arc<Notify>), context: Arc<ServerContext>) {
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "small packets of a connection will be held back");
    }
    let Some(Tls(acceptor)) = context.tls.clone() else {
        let said = first_words(&stream);
        let (from, to) = stream.into_split();
        return Connection::new(from, to, peer, waiting, context).hear(said).await;
    };
    // Boxed, since most connections have none of this.
    match timeout(HANDSHAKE_TIME, Box::pin(acceptor.accept(stream))).await {
        Ok(Ok(stream)) => {
            let (from, to) = tokio::io::split(stream);
            Box::pin(Connection::new(from, to, peer, waiting, context).hear(BytesMut::new())).await;
        }
        Ok(Err(error)) => tracing::debug!(%error, "a client could not agree on encryption"),
        Err(_) => tracing::debug!("a client did not agree on encryption in time"),
    }
}

/// What a newcomer has said already: asked of the system itself, as the loop does not know before its next look where something has come.
fn first_words(stream: &TcpStream) -> BytesMut {
    let mut said = BytesMut::zeroed(FIRST_WORDS);
    // Nothing, the end or an error is found again by whoever reads on.
    let length = (&*SockRef::from(stream)).read(&mut said).unwrap_or(0);
    said.truncate(length);
    said
}
