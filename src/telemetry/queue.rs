//! The queue between the threads that log and the stream that receives the lines (safety S11). A separate thread
//! writes to the stream. So no other thread waits when the stream blocks, or panics when it fails. Lines that find no
//! room or cannot be written are counted. The log reports their number as soon as the stream accepts lines again.

use std::io::{self, ErrorKind, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use crate::api::time::rfc3339;
use crate::runtime::clock::Clock;
use crate::runtime::figures::LOG_LINES_LOST;

/// Maximum size of the waiting text, in bytes. The writing thread may have the same amount again, so both together
/// have at most 1 MiB.
const ROOM: usize = 512 * 1024;

/// Pause before the next attempt on a non-blocking stream that is full.
const PAUSE: Duration = Duration::from_millis(50);

#[derive(Debug, Default)]
pub(super) struct Queue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    text: Vec<u8>,
    /// Number of lines dropped after `text`.
    dropped: u64,
    is_writing: bool,
}

impl Queue {
    pub(super) fn start(stream: impl Write + Send + 'static) -> io::Result<Arc<Queue>> {
        let queue = Arc::new(Queue::default());
        queue.state().text.reserve_exact(ROOM);
        let theirs = Arc::clone(&queue);
        thread::Builder::new().name("log".to_owned()).spawn(move || theirs.write(stream))?;
        Ok(queue)
    }

    /// Adds whole lines, or drops and counts them when there is no room.
    pub(super) fn put(&self, text: &[u8]) {
        let mut state = self.state();
        let was_idle = state.is_idle();
        if state.text.len() + text.len() > ROOM {
            state.dropped += lose(text);
        } else {
            state.text.extend_from_slice(text);
        }
        drop(state);
        if was_idle {
            self.changed.notify_all();
        }
    }

    pub(super) fn end(&self, patience: Duration) {
        let _ended = self.changed.wait_timeout_while(self.state(), patience, |state| !state.is_idle());
    }

    fn write(&self, mut stream: impl Write) {
        let mut text = Vec::with_capacity(ROOM);
        let mut lost = 0;
        loop {
            let mut state = self.state();
            state.is_writing = false;
            self.changed.notify_all();
            let idle = self.changed.wait_while(state, |state| state.is_idle());
            state = idle.unwrap_or_else(PoisonError::into_inner);
            std::mem::swap(&mut state.text, &mut text);
            let dropped = std::mem::take(&mut state.dropped);
            state.is_writing = true;
            drop(state);
            say_lost(&mut stream, &mut lost);
            lost += lose(unwritten(&mut stream, &text)) + dropped;
            say_lost(&mut stream, &mut lost);
            text.clear();
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn is_idle(&self) -> bool {
        self.text.is_empty() && self.dropped == 0 && !self.is_writing
    }
}

fn say_lost(stream: &mut impl Write, lost: &mut u64) {
    if *lost == 0 {
        return;
    }
    let now = rfc3339(Clock::default().now().wall);
    let line =
        format!("{now}  WARN hallsweep::telemetry: {lost} lines of the log were lost, because standard error was blocked\n");
    if unwritten(stream, line.as_bytes()).is_empty() {
        *lost = 0;
    }
}

/// Writes the text, and waits while a non-blocking stream is full. Returns the rest of the text when the stream
/// fails.
fn unwritten<'a>(stream: &mut impl Write, mut text: &'a [u8]) -> &'a [u8] {
    while !text.is_empty() {
        match stream.write(text) {
            Ok(0) => break,
            Ok(written) => text = &text[written..],
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) if error.kind() == ErrorKind::WouldBlock => thread::sleep(PAUSE),
            Err(_) => break,
        }
    }
    text
}

fn lose(text: &[u8]) -> u64 {
    let lines = text.iter().filter(|byte| **byte == b'\n').count() as u64;
    LOG_LINES_LOST.inc_by(lines);
    lines
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, Sender, channel};

    use super::*;

    /// A stream for tests. Each write does what the test says, and hangs until the test says it.
    struct Stream {
        turns: Receiver<Result<usize, ErrorKind>>,
        taken: Sender<Vec<u8>>,
    }

    impl Write for Stream {
        fn write(&mut self, text: &[u8]) -> io::Result<usize> {
            // After the end of the test everything is accepted.
            let most = self.turns.recv().unwrap_or(Ok(usize::MAX))?.min(text.len());
            let _ = self.taken.send(text[..most].to_vec());
            Ok(most)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    struct Bench {
        queue: Arc<Queue>,
        turn: Sender<Result<usize, ErrorKind>>,
        taken: Receiver<Vec<u8>>,
    }

    impl Bench {
        fn new() -> Bench {
            let ((turn, turns), (take, taken)) = (channel(), channel());
            Bench { queue: Queue::start(Stream { turns, taken: take }).unwrap(), turn, taken }
        }

        fn turns(&self, turns: &[Result<usize, ErrorKind>]) {
            turns.iter().for_each(|turn| self.turn.send(*turn).unwrap());
        }

        /// Lets all further writes succeed; returns everything that the stream received.
        fn taken(self) -> String {
            drop(self.turn);
            self.queue.end(Duration::from_secs(60));
            String::from_utf8(self.taken.try_iter().flatten().collect()).unwrap()
        }
    }

    /// Safety S11.
    #[test]
    fn what_finds_no_room_or_is_not_taken_is_counted_and_said_when_writing_works_again() {
        let before = LOG_LINES_LOST.get();
        let bench = Bench::new();
        bench.queue.put(b"first\n");
        while !bench.queue.state().is_writing {
            thread::yield_now();
        }
        let line = [&[b'x'; 1023][..], b"\n"].concat();
        (0..2048).for_each(|_| bench.queue.put(&line));
        bench.queue.end(Duration::ZERO);
        let state = bench.queue.state();
        assert_eq!((state.text.len(), state.dropped), (ROOM, 2048 - 512));
        drop(state);
        let taken = bench.taken();
        let (lines, said) = taken.strip_prefix("first\n").unwrap().split_at(ROOM);
        assert!(
            lines == String::from_utf8(line).unwrap().repeat(512) && said.contains(" 1536 lines of the log were lost"),
            "{said}"
        );

        let bench = Bench::new();
        // The stream accepts half a line, then nothing, not even the number of lost lines.
        bench.turns(&[Ok(6), Err(ErrorKind::StorageFull), Err(ErrorKind::StorageFull)]);
        bench.queue.put(b"kept\nhalf\nlost\n");
        bench.queue.end(Duration::from_secs(60));
        bench.queue.put(b"later\n");
        let taken = bench.taken();
        assert!(taken.starts_with("kept\nh") && taken.contains(" 2 lines of the log were lost"), "{taken}");
        assert!(taken.ends_with("\nlater\n") && taken.matches("lost").count() == 1, "{taken}");
        assert_eq!(LOG_LINES_LOST.get() - before, 1536 + 2);
    }

    #[test]
    fn a_stream_that_is_interrupted_or_does_not_wait_loses_nothing() {
        let bench = Bench::new();
        bench.turns(&[Err(ErrorKind::Interrupted), Ok(2), Err(ErrorKind::WouldBlock), Ok(1)]);
        bench.queue.put(b"one\ntwo\n");
        assert_eq!(bench.taken(), "one\ntwo\n");
    }
}
