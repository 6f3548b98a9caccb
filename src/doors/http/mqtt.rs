//! `/mqtt`: MQTT over WebSocket, for web clients. The bytes of all messages are passed on as one stream. The MQTT
//! broker reads them, and decides whether a client without a key is admitted.

use std::fmt;
use std::io;
use std::net::IpAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::extract::Request;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::extract::ws::{Message, WebSocket, WebSocketUpgrade};
use axum::http::HeaderMap;
use axum::response::{IntoResponse, Response};
use bytes::BytesMut;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt, DuplexStream, ReadBuf, ReadHalf, WriteHalf};
use tokio::sync::oneshot;

use super::HttpDoor;
use super::guard::is_foreign;
use super::peer::{LetIn, Peer};
use super::problem::Problem;
use crate::access::{Access, Caller};
use crate::doors::connection_limits::PendingConnections;

/// Name of the WebSocket subprotocol (MQTT 3.1.1 §6).
const PROTOCOL: &str = "mqtt";

/// Size of the buffer between the two streams, for each direction, in bytes.
const BETWEEN: usize = 64 * 1024;

/// Number of bytes read from a client at once. Every client has a buffer of this size, even a silent one.
const READ: usize = 4 * 1024;

/// Maximum size of a client's WebSocket message in bytes: the size of the largest allowed MQTT packet, and some room.
const LONGEST: usize = 512 * 1024;

/// Maximum number of unsent bytes for a client that does not read. They include the answers to the client's pings.
/// There is room for these answers and for one more message of the broker.
const UNREAD: usize = 3 * BETWEEN;

/// Maximum time for sending the remaining bytes after the broker has dropped a client. Also the maximum time for the
/// closing message.
const FAREWELL: Duration = Duration::from_secs(1);

/// Maximum number of connections that are still closing after the broker has dropped them. The broker's own limit
/// does not count these connections.
const LEAVING: usize = 64;

#[derive(Debug)]
pub struct IncomingConnection {
    pub stream: CarriedConnection,
    pub from: IpAddr,
    pub caller: Option<Caller>,
    pub access: Access,
}

/// The broker's end of a connection. Dropping it ends the connection, even if the client has not read the remaining
/// bytes.
#[derive(Debug)]
pub struct CarriedConnection {
    stream: DuplexStream,
    _held: oneshot::Sender<()>,
}

impl AsyncRead for CarriedConnection {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(cx, buf)
    }
}

impl AsyncWrite for CarriedConnection {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.stream).poll_write(cx, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(cx)
    }
}

#[derive(Clone)]
pub struct Hall {
    receive: Arc<dyn Fn(IncomingConnection) + Send + Sync>,
    leaving: PendingConnections,
}

impl Hall {
    pub fn new(receive: impl Fn(IncomingConnection) + Send + Sync + 'static) -> Hall {
        Hall { receive: Arc::new(receive), leaving: PendingConnections::new(LEAVING) }
    }
}

impl fmt::Debug for Hall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Hall")
    }
}

/// `GET mqtt`: opens a WebSocket. Browsers also let pages of other origins open a WebSocket, and send the cookies
/// along. Such requests are refused here, as a POST from another origin would be.
pub(super) async fn mqtt(
    door: HttpDoor,
    peer: Peer,
    caller: Result<LetIn, Problem>,
    headers: HeaderMap,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
    request: Request,
) -> Result<Response, Problem> {
    let Some(Hall { receive, leaving }) = door.process.mqtt.clone() else {
        return Err(Problem::not_found(
            "hallsweep runs no MQTT broker: mqtt.bind is none, or mqtt.broker names another broker".to_owned(),
        ));
    };
    if is_foreign(&headers) {
        door.process.note_unrecorded(peer, request.method(), request.uri().path(), "a page of another origin sent the request");
        return Err(Problem::foreign(
            "a page of another origin opened this: hallsweep accepts MQTT only from its own page and from programs".into(),
        ));
    }
    let unspoken =
        || Problem::malformed(format!("this path serves MQTT over WebSocket: connect with the subprotocol {PROTOCOL}"));
    let upgrade = upgrade.map_err(|_| unspoken())?.protocols([PROTOCOL]);
    if upgrade.selected_protocol().is_none() {
        return Err(unspoken());
    }
    let (access, caller) = (door.process.access.clone(), caller.ok().map(|LetIn(caller)| caller));
    let upgrade = upgrade.read_buffer_size(READ).max_message_size(LONGEST).max_frame_size(LONGEST);
    let upgrade = upgrade.write_buffer_size(BETWEEN).max_write_buffer_size(UNREAD);
    Ok(upgrade
        .on_upgrade(async move |socket| {
            let (ours, stream) = tokio::io::duplex(BETWEEN);
            let (held, let_go) = oneshot::channel();
            receive(IncomingConnection { stream: CarriedConnection { stream, _held: held }, from: peer.address, caller, access });
            carry(socket, peer.address, ours, let_go, leaving).await;
        })
        .into_response())
}

/// Copies bytes in both directions until one side ends. Neither direction waits for the other. When the broker drops
/// a client that reads slowly, the connection ends soon after.
async fn carry(
    socket: WebSocket,
    address: IpAddr,
    stream: DuplexStream,
    let_go: oneshot::Receiver<()>,
    leaving: PendingConnections,
) {
    let (from, to) = tokio::io::split(stream);
    let (mut send, receive) = socket.split();
    let carried = async {
        tokio::select! {
            () = inward(receive, to) => {}
            () = outward(from, &mut send) => {}
        }
        // A failure does not matter: the client may be gone already.
        let _ = tokio::time::timeout(FAREWELL, send.send(Message::Close(None))).await;
    };
    tokio::select! {
        () = carried => {}
        () = left(let_go, leaving, address) => {}
    }
}

/// Waits until the broker has dropped the client. Then gives the client time to read the remaining bytes, unless the
/// connection is evicted before.
async fn left(let_go: oneshot::Receiver<()>, leaving: PendingConnections, address: IpAddr) {
    let _ = let_go.await;
    leaving.linger(address, tokio::time::sleep(FAREWELL)).await;
}

async fn inward(mut socket: SplitStream<WebSocket>, mut to: WriteHalf<DuplexStream>) {
    while let Some(Ok(message)) = socket.next().await {
        let carried = match message {
            Message::Binary(bytes) => to.write_all(&bytes).await.is_ok(),
            Message::Ping(_) | Message::Pong(_) => true,
            // Text messages are not allowed in MQTT (MQTT 3.1.1 §6).
            Message::Text(_) | Message::Close(_) => false,
        };
        if !carried {
            return;
        }
    }
}

async fn outward(mut from: ReadHalf<DuplexStream>, socket: &mut SplitSink<WebSocket, Message>) {
    let mut bytes = BytesMut::with_capacity(READ);
    while let Ok(read @ 1..) = from.read_buf(&mut bytes).await {
        if socket.send(Message::Binary(bytes.split().freeze())).await.is_err() {
            return;
        }
        // If much data is sent, a larger buffer leads to fewer messages.
        bytes.reserve(if read < READ { READ } else { BETWEEN });
    }
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt;

    use super::*;
    use crate::runtime::tests::within::within;

    /// Safety A5: the limit holds for any number of clients, even if they read nothing.
    #[tokio::test(start_paused = true)]
    async fn of_those_who_were_let_go_of_and_read_nothing_so_many_are_waited_for() {
        let leaving = PendingConnections::new(LEAVING);
        let (kept, let_go) = oneshot::channel();
        let mut staying = Box::pin(left(let_go, leaving.clone(), IpAddr::from([127, 0, 0, 1])));
        let mut gone = Vec::new();
        for _ in 0..LEAVING + 9 {
            let (held, let_go) = oneshot::channel();
            gone.push(tokio::spawn(left(let_go, leaving.clone(), IpAddr::from([127, 0, 0, 1]))));
            drop(held);
        }
        for _ in 0..3 {
            tokio::task::yield_now().await;
        }
        assert_eq!(gone.iter().filter(|left| left.is_finished()).count(), 9, "no time has passed");
        for left in gone {
            within("the end", left).await.unwrap();
        }
        assert!((&mut staying).now_or_never().is_none(), "whom the broker has, it has");
        drop(kept);
        staying.await;
    }
}
