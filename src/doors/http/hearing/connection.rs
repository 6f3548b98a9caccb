//! Reads one connection from its first byte to its end. A connection is pending until its first head (request
//! line and headers) is complete. Then it gets a slot (one of a limited number of places), or an answer that no
//! slot is free. The connection is read to its end even if its requests fail. Everything here runs on the hearing
//! thread.

use std::io::Read;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use bytes::{BufMut, BytesMut};
use socket2::SockRef;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::Notify;
use tokio::time::{Sleep, sleep, timeout};

use super::connection_task::{ConnectionTask, HEADER_BYTES, HEADER_TIME, put};
use super::context::ServerContext;
use super::frames::Frames;
use super::judge::{Heard, HeardRequest, Judge, StopSearch};
use super::shared::{ConnectionState, StopOutcome};
use crate::api::door;
use crate::doors::connection_limits::{ConnectionSlot, PendingConnection, SlotClaim};
use crate::doors::http::peer::Peer;
use crate::doors::http::problem::Problem;
use crate::doors::http::tls::Tls;
use crate::doors::http::watcher::closed;
use crate::doors::write_timeout::WriteTimeoutStream;
use crate::runtime::figures::Connected;

/// Maximum duration of a TLS handshake.
const HANDSHAKE_TIME: Duration = Duration::from_secs(10);

/// Maximum number of bytes read at once from a new connection, before its first turn. A STOP is shorter.
const FIRST_WORDS: usize = 1024;

/// Maximum time that the first request waits for its body before the task that answers is started. Most bodies arrive
/// with their head, so few requests wait that long.
const WHOLE_TIME: Duration = Duration::from_millis(100);

/// Maximum number of bytes read from a connection in one turn. Then other connections have their turns. A new
/// connection waits for at most a thousand turns, which take some hundredths of a second together.
const TURN: usize = 4 * 1024;
/// Size of the buffer at the beginning of a turn, in bytes. It is small because most heads are short and many
/// connections wait.
const FIRST: usize = 1024;
/// Maximum number of heads scanned in one turn.
const HEADS: usize = 32;

/// Maximum number of bytes that wait for room in the pipe to hyper. The longest head with the longest body fits. If a
/// client sends more without reading its answers, no more of its requests are carried out. STOPs are still found
/// (safety S8).
pub(in crate::doors::http) const AHEAD: usize = 96 * 1024;

/// Maximum time for which a connection is still read after its last answer. In this time, the rest of an incomplete
/// head can arrive, and the answer can reach the client.
const LINGER_TIME: Duration = Duration::from_secs(5);
/// Maximum number of bytes read from a connection after its last answer.
const LINGER_BYTES: usize = 1024 * 1024;

pub(super) struct Connection<R, W> {
    from: R,
    /// Where answers to the client are written. `None` after the task that answers has taken it.
    to: Option<W>,
    cut: Arc<Notify>,
    waiting: Option<PendingConnection>,
    slot: Option<Arc<ConnectionSlot>>,
    /// Counts this connection in the metrics, from the moment when it gets its slot.
    connected: Option<Connected>,
    task: Option<ConnectionTask>,
    context: Arc<ServerContext>,
    search: StopSearch,
    shared: Arc<ConnectionState>,
    /// Sender of the first request. `None` until the head of that request is complete.
    claim: Option<SlotClaim>,
    /// Bytes that were read but not yet passed on.
    read: BytesMut,
    /// Number of bytes of `read` that were already scanned.
    scanned: usize,
    /// Scanned bytes that wait for room in the pipe.
    ahead: BytesMut,
    /// Whether bytes after `ahead` were dropped. Then nothing more is passed on, and only STOPs are carried out.
    is_only_heard: bool,
    /// Position in the stream after the head of a request that may switch this connection to WebSocket.
    upgrade: Option<u64>,
    /// Number of bytes passed on so far.
    handed_on: u64,
    /// Number of bytes read in the present turn.
    turn: usize,
    /// Time limit of the first head, and later of the first body.
    late: Pin<Box<Sleep>>,
}

enum Next {
    More,
    /// The client sends no more bytes.
    End,
    /// The task sends no more answers.
    Over,
}

/// Serves one connection until it ends or is evicted. Errors caused by the client are only logged.
pub(in crate::doors::http) async fn converse(stream: TcpStream, address: SocketAddr, context: Arc<ServerContext>) {
    let peer = Peer { address: address.ip(), is_encrypted: context.tls.is_some() };
    let cut = Arc::new(Notify::new());
    let waiting = context.pending.admit(peer.address, Arc::clone(&cut));
    let has_to_go = async {
        cut.notified().await;
        // The eviction may be requested while other tasks have their turns. This connection is polled once more, so
        // that bytes that arrived before the eviction are read.
        tokio::task::yield_now().await;
    };
    tokio::select! {
        biased;
        () = encrypted(stream, peer, waiting, Arc::clone(&cut), context) => {}
        () = has_to_go => tracing::debug!("a connection was closed to make room for a newer connection"),
    }
}

/// Performs the TLS handshake if this door uses TLS. Then reads the connection.
async fn encrypted(stream: TcpStream, peer: Peer, waiting: PendingConnection, cut: Arc<Notify>, context: Arc<ServerContext>) {
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "TCP_NODELAY could not be set: small packets may be delayed");
    }
    let Some(Tls(acceptor)) = context.tls.clone() else {
        let said = first_words(&stream);
        let (from, to) = stream.into_split();
        return Connection::new(from, to, peer, waiting, cut, context).hear(said).await;
    };
    // Boxed to save memory, because most connections do not use TLS.
    match timeout(HANDSHAKE_TIME, Box::pin(acceptor.accept(stream))).await {
        Ok(Ok(stream)) => {
            let (from, to) = tokio::io::split(stream);
            Box::pin(Connection::new(from, to, peer, waiting, cut, context).hear(BytesMut::new())).await;
        }
        Ok(Err(error)) => tracing::debug!(%error, "a TLS handshake failed"),
        Err(_) => tracing::debug!("a TLS handshake took too long"),
    }
}

/// Reads what a new connection has already sent. The event loop would notice these bytes only at its next poll, so
/// the socket is read directly.
fn first_words(stream: &TcpStream) -> BytesMut {
    let mut said = BytesMut::zeroed(FIRST_WORDS);
    // If there are no bytes yet, or if the stream has ended or failed, the next read reports this.
    let length = (&*SockRef::from(stream)).read(&mut said).unwrap_or(0);
    said.truncate(length);
    said
}

impl<R, W> Connection<R, W>
where
    R: AsyncRead + Unpin + Send,
    W: AsyncWrite + Unpin + Send + 'static,
{
    pub(super) fn new(
        from: R,
        to: W,
        peer: Peer,
        waiting: PendingConnection,
        cut: Arc<Notify>,
        context: Arc<ServerContext>,
    ) -> Connection<R, W> {
        Connection {
            from,
            to: Some(to),
            cut,
            waiting: Some(waiting),
            slot: None,
            connected: None,
            task: None,
            search: StopSearch::new(Judge { halls: context.halls.clone(), hosts: context.hosts.clone(), peer }),
            context,
            shared: ConnectionState::new(),
            claim: None,
            read: BytesMut::new(),
            scanned: 0,
            ahead: BytesMut::new(),
            is_only_heard: false,
            upgrade: None,
            handed_on: 0,
            turn: 0,
            late: Box::pin(sleep(HEADER_TIME)),
        }
    }

    /// Reads the connection to its end. `said` has the bytes that were already read.
    pub(super) async fn hear(mut self, said: BytesMut) {
        self.read = said;
        loop {
            // A switch to WebSocket is known here before the client can know it. WebSocket bytes are therefore never
            // scanned.
            if self.upgrade.is_some() && self.shared.is_handed_over() {
                return self.carry().await;
            }
            self.scan().await;
            if self.slot.is_none()
                && self.has_come()
                && let Err(problem) = self.take_slot()
            {
                return self.refuse(&problem).await;
            }
            if self.is_to_be_answered() {
                self.begin();
            }
            if self.task.is_some() {
                self.hand_on();
            }
            match self.go_on().await {
                Next::More => {}
                Next::Over => return self.linger().await,
                Next::End => break,
            }
        }
        let given = self.search.look();
        self.keep(given);
        if self.slot.is_some() && self.task.is_none() {
            self.begin();
            self.hand_on();
        }
        if let Some(task) = self.task.take() {
            task.ended(&self.shared, &self.ahead).await;
        }
    }

    async fn scan(&mut self) {
        let mut heads = 0;
        while self.scanned < self.read.len() {
            let (taken, heard, given) = self.search.take(&self.read[self.scanned..]);
            self.scanned += taken;
            match heard {
                None => {}
                Some(Heard::Body) => self.tell(|slot| slot.received()),
                Some(Heard::Head(asked)) => {
                    self.note(asked);
                    heads += 1;
                }
            }
            self.keep(given);
            if heads == HEADS {
                heads = 0;
                tokio::task::yield_now().await;
            }
        }
        let given = self.search.look_early();
        self.keep(given);
    }

    /// Records who sent a request, in which epoch it arrived, and whether it has a body. Does nothing if the request
    /// will not be carried out.
    fn note(&mut self, asked: HeardRequest) {
        if self.is_only_heard {
            return;
        }
        self.shared.came(self.search.number(), asked.came);
        self.tell(|slot| slot.asked(asked.claim.clone(), asked.has_body));
        self.claim.get_or_insert(asked.claim);
        if asked.may_hand_over {
            self.upgrade = Some(self.handed_on + self.scanned as u64);
        }
    }

    /// Stores the outcome of a STOP for the handler that answers its request.
    fn keep(&self, given: Option<StopOutcome>) {
        if let Some(given) = given.filter(|_| !self.is_only_heard) {
            self.shared.keep(self.search.number(), given);
        }
    }

    /// Passes on the bytes that were read. If there is no room for them, they are dropped, and all later bytes too.
    fn hand_on(&mut self) {
        self.is_only_heard |= self.ahead.len() + self.read.len() > AHEAD;
        if !self.is_only_heard && self.ahead.is_empty() {
            // A new buffer is used, so that the memory of a large burst is freed.
            self.ahead = BytesMut::from(&self.read[..]);
        } else if !self.is_only_heard {
            self.ahead.extend_from_slice(&self.read);
        }
        self.handed_on += self.read.len() as u64;
        self.read.clear();
        self.scanned = 0;
    }

    fn tell(&self, what: impl FnOnce(&ConnectionSlot)) {
        if let Some(slot) = &self.slot {
            what(slot);
        }
    }

    /// Whether a request can be answered: a head is complete, or the bytes can no longer become a valid head.
    fn has_come(&self) -> bool {
        self.claim.is_some() || self.read.len() >= HEADER_BYTES || self.search.scanner.is_no_request()
    }

    fn take_slot(&mut self) -> Result<(), Problem> {
        let has_heard = self.shared.has_heard();
        // hyper panics if the clock shows a time before 1970.
        if !self.context.halls.process.can_date() {
            return Err(Problem::no_date(has_heard));
        }
        // An evicted connection gets no slot. Otherwise another connection would be evicted to make room for it.
        if self.waiting.take().is_some_and(|waiting| !waiting.leave()) {
            return Err(Problem::no_slot(has_heard));
        }
        let claim = self.claim.clone().unwrap_or_else(|| SlotClaim::new(self.search.judge.peer.address, None));
        let cut = Arc::clone(&self.cut);
        let slot = self.context.slots.take(claim.clone(), has_heard, cut).ok_or_else(|| Problem::no_slot(has_heard))?;
        for _ in 0..self.search.scanner.heads() {
            slot.asked(claim.clone(), !self.search.scanner.is_between());
        }
        self.slot = Some(Arc::new(slot));
        self.connected = Some(self.context.halls.default().hall.handle.figures().connected(door::HTTP));
        self.late.set(sleep(WHOLE_TIME));
        Ok(())
    }

    /// Whether the task that answers should begin. The connection must have a slot, and must not be waiting for the
    /// body of its first request.
    fn is_to_be_answered(&self) -> bool {
        let is_whole = self.search.scanner.heads() != 1 || self.search.scanner.is_between();
        let is_due = self.read.len() >= TURN || self.late.is_elapsed();
        self.slot.is_some() && self.task.is_none() && (is_whole || is_due || self.shared.has_heard())
    }

    fn begin(&mut self) {
        if let (Some(slot), Some(to)) = (&self.slot, self.to.take()) {
            self.task = Some(ConnectionTask::begin(to, self.search.judge.peer, slot, &self.context, &self.shared));
        }
    }

    /// Carries the frames of a WebSocket. A WebSocket has other limits, so its slot is freed.
    async fn carry(mut self) {
        (self.slot, self.connected) = (None, None);
        // If WebSocket bytes were dropped, the following bytes cannot be understood.
        let Some(ConnectionTask { to: Some(to), over, .. }) = &mut self.task else { return };
        // A client may have sent the beginning of a frame before it received the answer. These bytes were passed on
        // unchanged.
        let mut frames = (self.upgrade == Some(self.handed_on)).then(Frames::default);
        let carried = async {
            to.write_all(&self.ahead).await?;
            loop {
                if let Some(frames) = &mut frames {
                    frames.pass(&mut self.read);
                }
                to.write_all(&self.read).await?;
                self.read.clear();
                self.read.reserve(TURN);
                if self.from.read_buf(&mut (&mut self.read).limit(TURN)).await? == 0 {
                    return to.shutdown().await;
                }
            }
        };
        tokio::select! {
            // The task itself sends the remaining bytes to the client.
            _ = carried => {}
            _ = over.changed() => return,
        }
        drop(over.changed().await);
    }

    /// Passes on bytes if the pipe has room, and otherwise reads more.
    async fn go_on(&mut self) -> Next {
        self.take_turns().await;
        let mut closing = self.context.closing.clone();
        let mut room = (&mut self.read).limit(TURN);
        let read = match &mut self.task {
            Some(ConnectionTask { to, over, .. }) => {
                if self.is_only_heard && self.ahead.is_empty() {
                    *to = None;
                }
                tokio::select! {
                    biased;
                    () = self.shared.handed_over(), if self.upgrade.is_some() => return Next::More,
                    _ = over.changed() => return Next::Over,
                    () = put(to, &mut self.ahead), if !self.ahead.is_empty() => return Next::More,
                    read = self.from.read_buf(&mut room) => read,
                }
            }
            None => tokio::select! {
                biased;
                read = self.from.read_buf(&mut room) => read,
                () = &mut self.late => return if self.slot.is_some() { Next::More } else { Next::End },
                () = closed(&mut closing) => return Next::End,
            },
        };
        match read {
            Ok(0) | Err(_) => Next::End,
            Ok(bytes) => {
                self.turn += bytes;
                Next::More
            }
        }
    }

    /// Lets other connections have their turns after a full turn, then reserves room for reading.
    async fn take_turns(&mut self) {
        if self.turn >= TURN {
            self.turn = 0;
            tokio::task::yield_now().await;
        }
        // The buffer is small at first, because most heads are short and many connections wait.
        self.read.reserve(if self.turn < FIRST { FIRST } else { TURN });
    }

    /// Reads the connection after its last answer. In this time, the rest of an incomplete head can arrive, and the
    /// answer can reach a client that is still sending. The slot is already free. If too many connections linger, the
    /// oldest one of the network with the most connections is evicted.
    async fn linger(mut self) {
        // The last body is searched for a STOP now. Nobody knows whether further bytes belong to this body, or when
        // they end.
        drop((self.task.take(), self.search.look()));
        (self.waiting, self.slot, self.is_only_heard) = (None, None, true);
        let _lingering = self.context.lingering.admit(self.search.judge.peer.address, Arc::clone(&self.cut));
        let mut closing = self.context.closing.clone();
        let heard_on = async {
            let mut left = LINGER_BYTES;
            while left > 0 {
                self.scan().await;
                self.hand_on();
                self.take_turns().await;
                let Ok(bytes @ 1..) = self.from.read_buf(&mut (&mut self.read).limit(TURN)).await else { return };
                self.turn += bytes;
                left = left.saturating_sub(bytes);
            }
        };
        tokio::select! {
            _ = timeout(LINGER_TIME, heard_on) => {}
            () = closed(&mut closing) => {}
        }
    }

    /// Answers why the request is not carried out. If there is a STOP in the request, it has halted the robot
    /// already.
    async fn refuse(mut self, problem: &Problem) {
        let body = problem.json();
        let answer = format!(
            "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/problem+json\r\nContent-Length: {}\r\n\
             Connection: close\r\nRetry-After: 1\r\n\r\n{body}",
            body.len()
        );
        if let Some(to) = self.to.take() {
            let mut to = WriteTimeoutStream::new(to);
            // Maximum wait for a client that does not read its answer.
            let _ = timeout(LINGER_TIME, async { drop((to.write_all(answer.as_bytes()).await, to.shutdown().await)) }).await;
        }
        self.linger().await;
    }
}

#[cfg(test)]
#[path = "connection_tests.rs"]
mod tests;
