//! Runs on the hearing thread (safety S7). Reads the input of each client in turns, searches it for a STOP, and passes
//! all input on. A STOP halts the robot as soon as it is found. All other work for a client is done on other threads,
//! apart from short turns of `client_service`.

use std::cell::RefCell;
use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use tokio::io::{AsyncRead, ReadBuf};
use tokio::runtime::Handle;

use super::client_service::serving_here;
use super::incoming::ClientReader;
use super::read_ahead::{Feeder, Left, READ};
use crate::runtime::clock::Clock;
use mqtt_gate::Listener;
use mqtt_gate::UrgentSearch;
use mqtt_gate::packet::Version;

/// Maximum time for one client before other clients get their turns.
const TURN: Duration = Duration::from_millis(2);

/// Maximum number of bytes searched after the end of a session: more than the system buffers for one client.
const REST: usize = 8 * 1024 * 1024;

/// Maximum time for a client to close its connection after the session has ended.
const FAREWELL: Duration = Duration::from_secs(1);

thread_local! {
    /// The read buffer that all clients of this thread share, so that a silent client costs no memory for reading.
    static READ_BUFFER: RefCell<Box<[u8]>> = RefCell::new(vec![0; READ].into());
}

pub(super) struct Hearing {
    search: UrgentSearch,
    listener: Arc<dyn Listener>,
    feeder: Feeder,
    clock: Clock,
    /// The runtime on which the program waits for the result of a STOP.
    work: Handle,
}

struct Read {
    bytes: usize,
    /// The bytes that were not searched yet, because the turn was over.
    rest: Vec<u8>,
}

impl Hearing {
    pub(super) fn new(version: Version, listener: Arc<dyn Listener>, feeder: Feeder, clock: Clock, work: Handle) -> Hearing {
        Hearing { search: UrgentSearch::new(version), listener, feeder, clock, work }
    }

    /// Searches the bytes that arrived after the CONNECT and before `run`, because a STOP may be among them.
    pub(super) async fn begin(&mut self, first: &[u8]) {
        let rest = self.hear(first);
        self.finish(rest).await;
    }

    /// Reads until the client closes the connection, or until its input is no longer wanted.
    pub(super) async fn run(mut self, mut reader: ClientReader) {
        let left = loop {
            let room = match self.feeder.room().await {
                Ok(room) => room,
                Err(left) => break left,
            };
            match self.read(&mut reader, room).await {
                Some(Ok(read)) => self.finish(read.rest).await,
                Some(Err(_)) => return,
                None => {}
            }
        };
        match left {
            Left::Deaf => {}
            Left::HearsRest => self.hear_rest(&mut reader).await,
            Left::HearsOn => {
                // A client that does not close the connection within `FAREWELL` is disconnected.
                let _ = tokio::time::timeout(FAREWELL, self.hear_on(&mut reader)).await;
            }
        }
    }

    /// Reads once, then lets other clients read. Returns `None` when the client's input is no longer wanted.
    async fn read(&mut self, reader: &mut ClientReader, room: usize) -> Option<io::Result<Read>> {
        let Hearing { search, listener, feeder, clock, work } = self;
        let mut hear = |bytes: &[u8]| hear(search, &**listener, feeder, *clock, work, bytes);
        let read = tokio::select! {
            biased;
            read = std::future::poll_fn(|cx| poll_read(reader, room, &mut hear, cx)) => read,
            _ = feeder.left() => return None,
        };
        if read.as_ref().is_ok_and(|read| read.bytes == room) {
            tokio::task::yield_now().await;
        }
        Some(read)
    }

    /// Searches the bytes that were received before the session ended (safety S8), at most about `REST` bytes.
    async fn hear_rest(&mut self, reader: &mut ClientReader) {
        let mut heard = 0;
        while heard < REST {
            let read = std::future::poll_fn(|cx| match poll_read(reader, READ, &mut |bytes| self.hear(bytes), cx) {
                Poll::Ready(read) => Poll::Ready(read.ok()),
                Poll::Pending => Poll::Ready(None),
            });
            let Some(read) = read.await else { return };
            heard += read.bytes;
            self.finish(read.rest).await;
            tokio::task::yield_now().await;
        }
    }

    async fn hear_on(&mut self, reader: &mut ClientReader) {
        loop {
            let read = std::future::poll_fn(|cx| poll_read(reader, READ, &mut |bytes| self.hear(bytes), cx));
            let Ok(read) = read.await else { return };
            self.finish(read.rest).await;
        }
    }

    async fn finish(&mut self, mut rest: Vec<u8>) {
        while !rest.is_empty() {
            tokio::task::yield_now().await;
            rest = self.hear(&rest);
        }
    }

    fn hear(&mut self, bytes: &[u8]) -> Vec<u8> {
        hear(&mut self.search, &*self.listener, &self.feeder, self.clock, &self.work, bytes)
    }
}

/// Searches the input for a STOP and passes the searched part on. Returns the rest if the turn was over before
/// everything was searched.
fn hear(
    search: &mut UrgentSearch,
    listener: &dyn Listener,
    feeder: &Feeder,
    clock: Clock,
    work: &Handle,
    bytes: &[u8],
) -> Vec<u8> {
    let _elsewhere = work.enter();
    let (mut rest, came, mut halted, mut until) = (bytes, listener.epoch(), Vec::new(), None);
    while let Some(begins) = search.next(&mut rest, |said| listener.hear_urgent(said)) {
        halted.push((begins, listener.epoch()));
        let now = clock.since_start();
        if now >= *until.get_or_insert(now + TURN) {
            break;
        }
    }
    serving_here(clock, || feeder.put(&bytes[..bytes.len() - rest.len()], came, &halted));
    rest.to_vec()
}

/// Reads at most `room` bytes and searches them at once.
///
/// # Errors
/// The client has closed the connection, or reading failed.
fn poll_read(
    reader: &mut ClientReader,
    room: usize,
    hear: &mut impl FnMut(&[u8]) -> Vec<u8>,
    cx: &mut Context<'_>,
) -> Poll<io::Result<Read>> {
    READ_BUFFER.with_borrow_mut(|buffer| {
        let mut into = ReadBuf::new(&mut buffer[..room]);
        ready!(Pin::new(reader).poll_read(cx, &mut into))?;
        match into.filled() {
            [] => Poll::Ready(Err(io::ErrorKind::UnexpectedEof.into())),
            came => Poll::Ready(Ok(Read { bytes: came.len(), rest: hear(came) })),
        }
    })
}

#[cfg(test)]
#[path = "hearing_tests.rs"]
mod tests;
