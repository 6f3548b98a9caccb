//! The connection to one program. Input is read while output is still being written, so that a halt is obeyed while a
//! photo is sent. The simulated faults of the wire are applied here.

use std::collections::VecDeque;
use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt, ReadHalf, WriteHalf};

use super::faults::Faults;
use super::wire::Stream;
use crate::runtime::clock::Clock;
use hallsweep_core::rng::RandomStream;

/// Photos are written in pieces of this many bytes.
const PIECE: usize = 16 << 10;

/// Maximum number of waiting pieces of input, and of output. At the maximum, reading pauses, or reporting pauses. A
/// single photo may have more pieces.
const WAITING: usize = 64;

pub(super) struct Connection {
    reader: ReadHalf<Stream>,
    writer: WriteHalf<Stream>,
    faults: Faults,
    chance: RandomStream,
    clock: Clock,
    heard: Late,
    said: Late,
    /// The piece being written, and the number of its bytes already sent.
    writing: Option<(Vec<u8>, usize)>,
    cut_at: Option<Duration>,
}

type Late = VecDeque<(Duration, Vec<u8>)>;

impl Connection {
    pub(super) fn new(stream: Stream, faults: Faults, chance: RandomStream, clock: Clock) -> Connection {
        let (reader, writer) = tokio::io::split(stream);
        let cut_at = faults.cut_after.map(|after| clock.since_start() + after);
        Connection { reader, writer, faults, chance, clock, heard: Late::new(), said: Late::new(), writing: None, cut_at }
    }

    pub(super) fn has_room(&self) -> bool {
        self.said.len() < WAITING
    }

    pub(super) fn say(&mut self, bytes: &[u8]) {
        let at = self.clock.since_start() + self.faults.delay;
        for piece in bytes.chunks(PIECE) {
            self.said.push_back((at, self.faults.befall(piece, &mut self.chance)));
        }
    }

    /// Receives the next piece; returns `None` when the connection has ended. Nothing is lost if the caller stops
    /// waiting.
    pub(super) async fn hear(&mut self) -> Option<Vec<u8>> {
        let mut bytes = [0; 1024];
        loop {
            let now = self.clock.since_start();
            if let Some(piece) = arrived(&mut self.heard, now) {
                return Some(piece);
            }
            self.writing = self.writing.take().or_else(|| arrived(&mut self.said, now).map(|piece| (piece, 0)));
            let due = [&self.heard, &self.said].into_iter().filter_map(|late| late.front().map(|(at, _)| *at)).min();
            let is_writing = self.writing.is_some();
            tokio::select! {
                biased;
                () = self.clock.reach(self.cut_at) => return None,
                read = self.reader.read(&mut bytes), if self.heard.len() < WAITING => match read {
                    Ok(count @ 1..) => {
                        let piece = self.faults.befall(&bytes[..count], &mut self.chance);
                        self.heard.push_back((self.clock.since_start() + self.faults.delay, piece));
                    }
                    Ok(0) | Err(_) => return None,
                },
                written = write(&mut self.writer, &mut self.writing), if is_writing => written.ok()?,
                () = self.clock.reach(due), if !is_writing => {}
            }
        }
    }
}

fn arrived(late: &mut Late, now: Duration) -> Option<Vec<u8>> {
    late.front().is_some_and(|(at, _)| *at <= now).then(|| late.pop_front()).flatten().map(|(_, piece)| piece)
}

async fn write(writer: &mut WriteHalf<Stream>, writing: &mut Option<(Vec<u8>, usize)>) -> std::io::Result<()> {
    let Some((piece, done)) = writing else { return Ok(()) };
    *done += writer.write(&piece[*done..]).await?;
    if *done == piece.len() {
        *writing = None;
    }
    Ok(())
}
