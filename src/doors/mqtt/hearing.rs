//! What runs on the thread that hears (safety S7): it reads what a client says, in turns, looks through it for a STOP, which halts at
//! once, and passes it on. What all else means, and what the client is told, is done elsewhere.

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

/// After so long it is read what others say.
const TURN: Duration = Duration::from_millis(2);

/// Of a client that is to go, so much that has come already is looked through, in bytes: more than the system keeps for it.
const REST: usize = 8 * 1024 * 1024;

/// So long a client may take to end a connection that is over.
const FAREWELL: Duration = Duration::from_secs(1);

thread_local! {
    /// Where everything is read into on this thread: a client that says nothing costs no room for it.
    static READ_BUFFER: RefCell<Box<[u8]>> = RefCell::new(vec![0; READ].into());
}

pub(super) struct Hearing {
    search: UrgentSearch,
    listener: Arc<dyn Listener>,
    feeder: Feeder,
    clock: Clock,
    /// Where what a STOP brings about is waited for.
    work: Handle,
}

struct Read {
    bytes: usize,
    /// What of it was not looked through, because that took too long.
    rest: Vec<u8>,
}

impl Hearing {
    /// Of a client that speaks this version.
    pub(super) fn new(version: Version, listener: Arc<dyn Listener>, feeder: Feeder, (clock, work): (Clock, Handle)) -> Hearing {
        Hearing { search: UrgentSearch::new(version), listener, feeder, clock, work }
    }

    /// What came together with the CONNECT.
    pub(super) async fn begin(&mut self, first: &[u8]) {
        let rest = self.hear(first);
        self.finish(rest).await;
    }

    /// Listens until the client ends, or until nobody wants to know any more what it says.
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
                // Whoever does not end it is cut off.
                let _ = tokio::time::timeout(FAREWELL, self.hear_on(&mut reader)).await;
            }
        }
    }

    /// Reads once, and then lets others read; `None` when nobody wants to know any more.
    async fn read(&mut self, reader: &mut ClientReader, room: usize) -> Option<io::Result<Read>> {
        let Hearing { search, listener, feeder, clock, work } = self;
        let mut hear = |bytes: &[u8]| hear(search, &**listener, feeder, (*clock, work), bytes);
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

    /// What has come already of a client that is to go.
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

    /// Looks through what was left over, after others.
    async fn finish(&mut self, mut rest: Vec<u8>) {
        while !rest.is_empty() {
            tokio::task::yield_now().await;
            rest = self.hear(&rest);
        }
    }

    fn hear(&mut self, bytes: &[u8]) -> Vec<u8> {
        hear(&mut self.search, &*self.listener, &self.feeder, (self.clock, &self.work), bytes)
    }
}

/// Looks through what was read, and passes it on; what was not looked through when the time was over.
fn hear(
    search: &mut UrgentSearch,
    listener: &dyn Listener,
    feeder: &Feeder,
    (clock, work): (Clock, &Handle),
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

/// Reads at most so much, if anything is there, and lets it be heard at once.
///
/// # Errors
/// When nothing more comes.
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
