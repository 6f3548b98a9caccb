//! The accept loop: bounded connections, bounded handshake, header and write time, and an end within two seconds.
//! The ports are bound, and the end decided, by whoever calls; whose connection gives way to another's is decided in `places`.

use std::future::Future;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::Router;
use axum::body::{Body, Bytes};
use hyper::body::{Frame, Incoming, SizeHint};
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper::{Request, Response};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio::sync::watch;
use tokio::task::JoinSet;

use super::gate::Peer;
use super::tls::Tls;
use super::watcher::closed;
use super::{Door, Hosts, router};
use crate::inbound::listeners::Listeners;
use crate::inbound::patience::Patient;
use crate::inbound::places::{PLACES, Place, Places, Request as Asked};

/// How long a client may take to agree on encryption.
const HANDSHAKE_TIME: Duration = Duration::from_secs(10);

/// How long a client may take over a request's headers, and how long it may be silent between two requests.
const HEADER_TIME: Duration = Duration::from_secs(20);

/// How long a request's line and headers may be together; longer ones are answered with 431.
const HEADER_BYTES: usize = 64 * 1024;

/// How long open requests are waited for at the end: with what closing a stream takes, within two seconds.
const GRACE: Duration = Duration::from_millis(1500);

/// After an accept has failed (as with too many open files) the next is tried this much later.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// But so much later when connections were cut for it, which takes them this long to close.
const RELIEF_PAUSE: Duration = Duration::from_millis(2);

/// What stands before the door.
#[derive(Clone, Default)]
pub struct Front {
    /// The names under which it is reached, beside its addresses and this machine's own names.
    pub hosts: Vec<String>,
    /// How connections are encrypted, where they are.
    pub tls: Option<Tls>,
}

/// What every connection has in common.
#[derive(Clone)]
struct Line {
    router: Router,
    tls: Option<Tls>,
    closing: watch::Receiver<bool>,
}

/// Serves until `shutdown`, then ends every stream, waits shortly for open requests, and returns whatever clients do.
pub async fn serve(listeners: Listeners, door: Door, front: Front, shutdown: impl Future<Output = ()>) {
    serve_so_many(listeners, door, front, &Places::new(PLACES), shutdown).await;
}

async fn serve_so_many(mut listeners: Listeners, door: Door, front: Front, places: &Places, shutdown: impl Future<Output = ()>) {
    let router = router(&door, Hosts::new(listeners.are_local(), &front.hosts));
    let line = Line { router, tls: front.tls, closing: door.closing.subscribe() };
    let mut connections = JoinSet::new();
    tokio::pin!(shutdown);
    loop {
        tokio::select! {
            biased;
            () = &mut shutdown => break,
            Some(_) = connections.join_next() => {}
            accepted = listeners.accept() => match accepted {
                Ok((stream, address)) => match places.take(address.ip()) {
                    Some(place) => drop(connections.spawn(converse(stream, Arc::new(place), line.clone()))),
                    None => tracing::debug!(%address, "a connection was refused: every place is taken"),
                },
                Err(error) => {
                    let relieved = places.relieve();
                    tracing::warn!(%error, relieved, "a connection could not be accepted");
                    tokio::time::sleep(if relieved > 0 { RELIEF_PAUSE } else { ACCEPT_PAUSE }).await;
                }
            },
        }
    }
    door.close();
    drop(listeners);
    let drained = tokio::time::timeout(GRACE, async { while connections.join_next().await.is_some() {} }).await;
    if drained.is_err() {
        tracing::info!(open = connections.len(), "connections that would not end were cut");
    }
}

/// One connection, to its end or until its place is needed. What a client does wrong with it is the client's business.
async fn converse(stream: TcpStream, place: Arc<Place>, line: Line) {
    tokio::select! {
        () = place.cut() => tracing::debug!("a connection gave way to a newer one"),
        () = encrypted(stream, &place, line) => {}
    }
}

/// Agrees on encryption, where there is any, and then talks.
async fn encrypted(stream: TcpStream, place: &Arc<Place>, line: Line) {
    let Ok(address) = stream.peer_addr() else { return };
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "small packets of a connection will be held back");
    }
    let peer = Peer { address: address.ip(), is_encrypted: line.tls.is_some() };
    let stream = Patient::new(stream);
    let Some(Tls(acceptor)) = line.tls.clone() else { return talk(stream, peer, place, line).await };
    match tokio::time::timeout(HANDSHAKE_TIME, acceptor.accept(stream)).await {
        Ok(Ok(stream)) => talk(stream, peer, place, line).await,
        Ok(Err(error)) => tracing::debug!(%error, "a client could not agree on encryption"),
        Err(_) => tracing::debug!("a client did not agree on encryption in time"),
    }
}

/// Request after request, each with whoever is at the other end written into it.
async fn talk(stream: impl AsyncRead + AsyncWrite + Unpin + Send + 'static, peer: Peer, place: &Arc<Place>, line: Line) {
    let Line { router, mut closing, .. } = line;
    let routes = TowerToHyperService::new(router);
    let service = service_fn(|mut request: Request<Incoming>| {
        let asked = place.begin();
        request.extensions_mut().insert(peer);
        request.extensions_mut().insert(Arc::clone(place));
        let answer = routes.call(request);
        async move { answer.await.map(|response: Response<Body>| response.map(|body| Answer { body, _asked: asked })) }
    });
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEADER_TIME).max_buf_size(HEADER_BYTES);
    let connection = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
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

/// The body of an answer; its request is over when all of it is on its way.
struct Answer {
    body: Body,
    _asked: Asked,
}

impl hyper::body::Body for Answer {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(cx)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

#[cfg(test)]
#[path = "serve_tests.rs"]
mod tests;
