//! Answers the requests of a connection with hyper. Its input is the bytes that the hearing thread passes on. Each
//! request carries the address of its sender, and the STOP that was found in it. When the client has disconnected,
//! its answers are discarded without an error. The requests that it sent before are therefore still carried out.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::task::{Context, Poll};
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::http::{StatusCode, header};
use bytes::BytesMut;
use hyper::body::{Frame, Incoming, SizeHint};
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper::{Request, Response};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite, AsyncWriteExt, DuplexStream, ReadBuf};
use tokio::sync::{Notify, watch};
use tokio::task::JoinSet;

use super::context::ServerContext;
use super::shared::{ConnectionState, Pressed};
use crate::doors::connection_limits::ConnectionSlot;
use crate::doors::http::peer::Peer;
use crate::doors::http::watcher::closed;
use crate::doors::write_timeout::WriteTimeoutStream;

/// Maximum time for the headers of a request to arrive. A connection on which no new request comes is closed after
/// the same time.
pub(super) const HEADER_TIME: Duration = Duration::from_secs(20);

/// Maximum size of a request's line and headers together, in bytes. A longer head is answered with status 431.
pub(super) const HEADER_BYTES: usize = 64 * 1024;

/// Size of the pipe between the hearing thread and hyper, in bytes.
const PIPE: usize = 16 * 1024;

/// Time for which the requests of a client that is gone are still carried out. An endless answer, such as an event
/// stream, ends after that time too.
const GONE_TIME: Duration = Duration::from_secs(2);

/// The task that answers a connection. It runs on another runtime, and ends when this value is dropped.
pub(super) struct ConnectionTask {
    /// The pipe to hyper. `None` when no more bytes follow.
    pub(super) to: Option<DuplexStream>,
    /// This channel is closed when no more requests can be answered. No value is ever sent on it.
    pub(super) over: watch::Receiver<()>,
    task: JoinSet<()>,
}

impl ConnectionTask {
    /// Starts the task on the runtime of the routes.
    pub(super) fn begin<W>(
        to: W,
        peer: Peer,
        slot: &Arc<ConnectionSlot>,
        context: &Arc<ServerContext>,
        shared: &Arc<ConnectionState>,
    ) -> ConnectionTask
    where
        W: AsyncWrite + Unpin + Send + 'static,
    {
        let (ours, theirs) = tokio::io::duplex(PIPE);
        let (held, over) = watch::channel(());
        let gone = Arc::new(Notify::new());
        let transport =
            Transport { from: theirs, to: WriteTimeoutStream::new(to), gone: Arc::clone(&gone), is_gone: false, _held: held };
        let mut task = JoinSet::new();
        task.spawn_on(run(transport, peer, Arc::clone(slot), Arc::clone(context), Arc::clone(shared), gone), &context.work);
        ConnectionTask { to: Some(ours), over, task }
    }

    /// Passes on the last bytes and waits until all requests are answered. If the client closes its side during an
    /// endless answer, the client counts as gone.
    pub(super) async fn ended(self, shared: &ConnectionState, rest: &[u8]) {
        let ConnectionTask { to, over: _over, mut task } = self;
        let mut is_endless = shared.is_endless.subscribe();
        let answered = async {
            if let Some(mut to) = to {
                // If the task does not read any more, it has logged the reason.
                let _ = to.write_all(rest).await;
            }
            task.join_next().await
        };
        tokio::select! {
            _ = answered => {}
            _ = is_endless.wait_for(|is_endless| *is_endless) => {}
        }
    }
}

/// Writes as many bytes into the pipe as fit. Waits if nothing fits. When nobody reads from the pipe any more, all
/// bytes are dropped.
pub(super) async fn put(to: &mut Option<DuplexStream>, bytes: &mut BytesMut) {
    let is_put = match to {
        Some(to) => to.write_buf(bytes).await.is_ok(),
        None => false,
    };
    if !is_put {
        bytes.clear();
    }
}

async fn run<W>(
    transport: Transport<W>,
    peer: Peer,
    slot: Arc<ConnectionSlot>,
    context: Arc<ServerContext>,
    shared: Arc<ConnectionState>,
    gone: Arc<Notify>,
) where
    W: AsyncWrite + Unpin + Send + 'static,
{
    let mut closing = context.closing.clone();
    let routes = TowerToHyperService::new(context.router.clone());
    let numbers = AtomicU64::new(0);
    let service = service_fn(|mut request: Request<Incoming>| {
        let number = numbers.fetch_add(1, Ordering::Relaxed);
        request.extensions_mut().insert(peer);
        if let Some(arrived) = shared.arrived(number) {
            request.extensions_mut().insert(arrived);
        }
        shared.forget_before(number);
        request.extensions_mut().insert(Pressed { shared: Arc::clone(&shared), number });
        let asked = OpenRequest(Arc::clone(&slot));
        let (answer, shared) = (routes.call(request), Arc::clone(&shared));
        async move {
            let answer = answer.await;
            answer.map(|response: Response<Body>| {
                if is_stream(&response) {
                    asked.0.watches();
                    shared.is_endless.send_replace(true);
                }
                if response.status() == StatusCode::SWITCHING_PROTOCOLS {
                    // The slot is freed before the client can know that the protocol has changed.
                    asked.0.hands_over();
                    shared.is_handed_over.send_replace(true);
                }
                response.map(|body| AnswerBody { body, asked })
            })
        }
    });
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEADER_TIME);
    // The guard writes the header `Date`. hyper still reads the clock after every head, and panics before 1970. No
    // task is started while the clock shows such a time.
    http.max_header_size(HEADER_BYTES).max_buf_size(HEADER_BYTES).half_close(true).auto_date_header(false);
    let connection = http.serve_connection(TokioIo::new(transport), service).with_upgrades();
    tokio::pin!(connection);
    let late = async {
        gone.notified().await;
        tokio::time::sleep(GONE_TIME).await;
    };
    let ended = tokio::select! {
        ended = connection.as_mut() => ended,
        () = late => Ok(()),
        () = closed(&mut closing) => {
            connection.as_mut().graceful_shutdown();
            connection.await
        }
    };
    if let Err(error) = ended {
        tracing::debug!(%error, "a connection broke");
    }
}

fn is_stream(response: &Response<Body>) -> bool {
    let media = response.headers().get(header::CONTENT_TYPE);
    media.is_some_and(|media| media.as_bytes().starts_with(b"text/event-stream"))
}

struct OpenRequest(Arc<ConnectionSlot>);

impl Drop for OpenRequest {
    fn drop(&mut self) {
        self.0.answered();
    }
}

/// The body of an answer. Its request counts as open until hyper has received the whole body.
struct AnswerBody {
    body: Body,
    asked: OpenRequest,
}

impl hyper::body::Body for AnswerBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let frame = Pin::new(&mut self.body).poll_frame(cx);
        if frame.is_ready() {
            self.asked.0.sends();
        }
        frame
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

/// The client's bytes, and the stream on which answers are sent. When the client has disconnected, answers are
/// accepted but discarded.
struct Transport<W> {
    from: DuplexStream,
    to: WriteTimeoutStream<W>,
    gone: Arc<Notify>,
    is_gone: bool,
    _held: watch::Sender<()>,
}

impl<W> Transport<W> {
    fn forgiven<T>(&mut self, written: Poll<io::Result<T>>, instead: T) -> Poll<io::Result<T>> {
        let Poll::Ready(Err(error)) = written else { return written };
        tracing::debug!(%error, "a client disconnected before its answer was sent");
        self.is_gone = true;
        self.gone.notify_one();
        Poll::Ready(Ok(instead))
    }
}

impl<W: Unpin> AsyncRead for Transport<W> {
    fn poll_read(mut self: Pin<&mut Self>, cx: &mut Context<'_>, buf: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.from).poll_read(cx, buf)
    }
}

impl<W: AsyncWrite + Unpin> AsyncWrite for Transport<W> {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        if self.is_gone {
            return Poll::Ready(Ok(bytes.len()));
        }
        let written = Pin::new(&mut self.to).poll_write(cx, bytes);
        self.forgiven(written, bytes.len())
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        if self.is_gone {
            return Poll::Ready(Ok(()));
        }
        let flushed = Pin::new(&mut self.to).poll_flush(cx);
        self.forgiven(flushed, ())
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        if self.is_gone {
            return Poll::Ready(Ok(()));
        }
        let shut = Pin::new(&mut self.to).poll_shutdown(cx);
        self.forgiven(shut, ())
    }

    fn poll_write_vectored(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bufs: &[io::IoSlice<'_>]) -> Poll<io::Result<usize>> {
        let all = bufs.iter().map(|buf| buf.len()).sum();
        if self.is_gone {
            return Poll::Ready(Ok(all));
        }
        let written = Pin::new(&mut self.to).poll_write_vectored(cx, bufs);
        self.forgiven(written, all)
    }

    fn is_write_vectored(&self) -> bool {
        self.to.is_write_vectored()
    }
}

#[cfg(test)]
mod tests {
    use super::super::shared::STOP_OUTCOMES;
    use super::*;

    /// Safety A5.
    #[test]
    fn no_more_stops_are_kept_for_their_requests_than_there_is_room_for() {
        let shared = ConnectionState::new();
        (0..10_000).for_each(|number| shared.keep(number, Box::pin(std::future::pending())));
        assert_eq!(shared.stop_outcomes().len(), STOP_OUTCOMES);
    }
}
