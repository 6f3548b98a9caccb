//! The accept loop: bounded connections, bounded header time, bounded write time, and an end within two seconds.
//! The listener is bound, and the end decided, by whoever calls.

use std::future::Future;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, watch};
use tokio::task::JoinSet;

use super::gate::Peer;
use super::patience::Patient;
use super::watcher::closed;
use super::{Door, Hosts, router};

/// Connections open at once: every stream there may be, and as many again for requests beside each.
const CONNECTIONS: usize = 1024;

/// How long a client may take over a request's headers, and how long it may be silent between two requests.
const HEADER_TIME: Duration = Duration::from_secs(20);

/// How long a request's line and headers may be together; longer ones are answered with 431.
const HEADER_BYTES: usize = 64 * 1024;

/// How long open requests are waited for at the end: with what closing a stream takes, within two seconds.
const GRACE: Duration = Duration::from_millis(1500);

/// After an accept has failed (as with too many open files) the next is tried this much later.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// Serves under these names until `shutdown`, then ends every stream, waits shortly for open requests, and returns whatever clients do.
pub async fn serve(listener: TcpListener, door: Door, hosts: &[String], shutdown: impl Future<Output = ()>) {
    let is_local = listener.local_addr().is_ok_and(|address| address.ip().is_loopback());
    let router = router(&door, Hosts::new(is_local, hosts));
    let places = Arc::new(Semaphore::new(CONNECTIONS));
    let mut connections = JoinSet::new();
    tokio::pin!(shutdown);
    loop {
        let accepted = async {
            let place = Arc::clone(&places).acquire_owned().await;
            (listener.accept().await, place)
        };
        tokio::select! {
            biased;
            () = &mut shutdown => break,
            Some(_) = connections.join_next() => {}
            (accepted, place) = accepted => match accepted {
                Ok((stream, address)) => {
                    let peer = Peer { address: address.ip(), is_encrypted: false };
                    let connection = converse(stream, peer, router.clone(), door.closing.subscribe());
                    connections.spawn(async move {
                        connection.await;
                        drop(place);
                    });
                }
                Err(error) => {
                    tracing::warn!(%error, "a connection could not be accepted");
                    tokio::time::sleep(ACCEPT_PAUSE).await;
                }
            },
        }
    }
    door.close();
    drop(listener);
    let drained = tokio::time::timeout(GRACE, async { while connections.join_next().await.is_some() {} }).await;
    if drained.is_err() {
        tracing::info!(open = connections.len(), "connections that would not end were cut");
    }
}

/// One connection, to its end. What a client does wrong with it is the client's business.
async fn converse(stream: TcpStream, peer: Peer, router: Router, mut closing: watch::Receiver<bool>) {
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "small packets of a connection will be held back");
    }
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEADER_TIME).max_buf_size(HEADER_BYTES);
    let routes = TowerToHyperService::new(router);
    let service = service_fn(move |mut request: Request<Incoming>| {
        request.extensions_mut().insert(peer);
        routes.call(request)
    });
    let connection = http.serve_connection(TokioIo::new(Patient::new(stream)), service);
    tokio::pin!(connection);
    let ended = tokio::select! {
        ended = connection.as_mut() => ended,
        () = closed(&mut closing) => {
            connection.as_mut().graceful_shutdown();
            connection.await
        }
    };
    if let Err(error) = ended {
        tracing::debug!(%error, "a connection broke");
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::house;
    use super::*;
    use crate::wire::fixture::searching;
    use std::io::{Read, Write};
    use std::net::{SocketAddr, TcpStream as Client};
    use tokio::sync::oneshot;
    use tokio::time::timeout;

    fn client(address: SocketAddr, begins: &str) -> Client {
        let mut client = Client::connect(address).unwrap();
        client.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        client.write_all(begins.as_bytes()).unwrap();
        client
    }

    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn the_end_comes_within_two_seconds_whatever_clients_do() {
        let house = house(searching());
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let (end, ended) = oneshot::channel::<()>();
        let serving = tokio::spawn(serve(listener, house.door.clone(), &[], async { drop(ended.await) }));

        let _slow = client(address, "GET /api/v1/state HTTP/1.1\r\nHost: localhost\r\nX-Slow: ");
        let _half = client(address, "POST /api/v1/commands/move HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n{");
        let mut watching = client(address, "GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
        let mut first = [0; 12];
        watching.read_exact(&mut first).unwrap();
        assert_eq!(&first, b"HTTP/1.1 200");

        end.send(()).unwrap();
        timeout(Duration::from_secs(2), serving).await.expect("it ends within two seconds").unwrap();
        watching.read_to_end(&mut Vec::new()).expect("the stream was closed, and in order");
    }
}
