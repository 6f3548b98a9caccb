//! A second rope for STOP (safety S4): a stop is answered before its record, so its epoch also goes into a tiny file of its own,
//! in place, where it outlives `kill -9` also when the journal cannot be written. What follows from it at the next start is the
//! app's business, and who stopped is on record in the journal alone.
//!
//! ```text
//!   hallsweep stops 1 00000000000000000041 5d1c0a8e77f0b3c2     two lines like this; the greater one counts, and the
//!   hallsweep stops 1 00000000000000000042 90b2f3a4c5d60718     other one is written next
//! ```
//! The file has its full size from the first start, so that a full disk has room for every later stop. Nothing is flushed: what is
//! written is in the system's hands at once, and only a power cut may take the last seconds of it.

use std::fs;
use std::io;
use std::path::Path;
use std::time::Duration;

use crate::runtime::halt::Halter;
use crate::storage::small_file::{SmallFile, checksum};
use crate::storage::{files, names};
use hallsweep_core::units::Epoch;

/// How a line begins: whose it is, and its version.
const BEGINS: &str = "hallsweep stops 1 ";

/// The bytes of a line: its beginning, twenty digits, a space, sixteen of checksum, the end of the line.
const LINE: usize = BEGINS.len() + 20 + 1 + 16 + 1;

/// The bytes of the file. Both lines lie in one sector.
const SIZE: usize = 2 * LINE;

/// A greater epoch was never reached by pressing a button: nobody wrote that.
const GREATEST: u64 = i64::MAX as u64;

/// So long after the file could not be written it is tried again, when nobody stops before.
const WRITTEN_AGAIN: Duration = Duration::from_secs(1);

#[derive(Debug)]
pub struct Stops {
    file: SmallFile,
    epoch: Epoch,
    /// The line that is written next.
    turn: usize,
    /// Whether what stood there could not be understood.
    was_damaged: bool,
    /// Whether that stands beside it under another name.
    was_set_aside: bool,
}

/// What the bytes of a file come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FoundStop {
    epoch: Epoch,
    /// Which line says so.
    line: usize,
    /// Whether the other line is whole too. If not, it may have named a later stop.
    is_sure: bool,
}

impl Stops {
    /// Why the file in the folder `dir` cannot be had at all, in words that end with what to do; `None` where it can, or where
    /// there is none yet. Nothing is changed.
    pub fn unusable(dir: &Path) -> Option<String> {
        let file = SmallFile::within(dir, names::STOPS);
        let unusable = |path: &Path, error: &io::Error| {
            format!("{} cannot be used ({error}): move it away, then start hallsweep again", path.display())
        };
        match file.read(SIZE) {
            Ok(Some(_)) => None,
            Ok(None) => files::check_no_folder(&file.unfinished()).err().map(|error| unusable(&file.unfinished(), &error)),
            Err(error) => Some(unusable(file.path(), &error)),
        }
    }

    /// The file in the folder `dir`, made with its full size when there is none. No fault of it is an error: the log says it, and
    /// it is tried again with the next stop. One of which a line cannot be understood is set aside and begun anew.
    pub fn open(dir: &Path) -> Stops {
        let mut stops = Stops {
            file: SmallFile::within(dir, names::STOPS),
            epoch: Epoch(0),
            turn: 0,
            was_damaged: false,
            was_set_aside: false,
        };
        match stops.file.read(SIZE) {
            Ok(Some(bytes)) => match understood(&bytes) {
                Some(FoundStop { epoch, line, is_sure: true }) => {
                    (stops.epoch, stops.turn) = (epoch, 1 - line);
                    return stops;
                }
                found => {
                    stops.was_damaged = true;
                    stops.epoch = found.map_or(Epoch(0), |found| found.epoch);
                    // A second name for it, since a kill before the new one is there must find it still. Where the volume has none, it
                    // is written over all the same: a STOP must find its file.
                    let aside = names::STOPS_DAMAGED.within(dir);
                    let _ = fs::remove_file(&aside);
                    stops.was_set_aside = fs::hard_link(stops.file.path(), &aside).is_ok();
                }
            },
            Ok(None) => {}
            Err(error) => {
                tracing::warn!(file = %stops.file.path().display(), %error, "what this file remembers of STOP cannot be read");
                return stops;
            }
        }
        let made = stops.make();
        stops.say(&made);
        stops
    }

    /// The epoch of the last stop that was written down; 0 when none was.
    pub const fn epoch(&self) -> Epoch {
        self.epoch
    }

    /// Where the file is, if what stood there could not be understood: nobody knows then whether the last stop is on record.
    /// Says also whether what stood there was set aside.
    pub fn damaged(&self) -> Option<(&Path, bool)> {
        self.was_damaged.then_some((self.file.path(), self.was_set_aside))
    }

    /// Writes an epoch down, unless a later one stands there already. When that fails the log says so, and it stays to be done.
    fn keep(&mut self, epoch: Epoch) {
        if epoch > self.epoch {
            let kept = self.write(epoch);
            self.say(&kept);
        }
    }

    fn write(&mut self, epoch: Epoch) -> io::Result<()> {
        let line = line(epoch);
        match self.file.write_at(place(self.turn), line.as_bytes()) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                self.make()?;
                self.file.write_at(place(self.turn), line.as_bytes())?;
            }
            written => written?,
        }
        (self.epoch, self.turn) = (epoch, 1 - self.turn);
        Ok(())
    }

    fn make(&mut self) -> io::Result<()> {
        self.file.make(line(self.epoch).repeat(2).as_bytes())?;
        self.turn = 0;
        Ok(())
    }

    fn say(&mut self, outcome: &io::Result<()>) {
        let failing = "a STOP cannot be written down beside the journal: make room, or the folder writable; it is tried again";
        self.file.say(outcome, failing, "STOP is remembered again");
    }
}

/// Writes down every stop and says so to the halter, on a thread where blocking is allowed: a disk that hangs keeps nobody from
/// stopping. Ends with the program.
pub async fn follow(mut stops: Stops, halter: Halter) {
    let mut halts = halter.watch();
    halter.note(Some(stops.epoch()));
    loop {
        let epoch = halts.now().epoch;
        if epoch > stops.epoch() {
            let writing = tokio::task::spawn_blocking(move || {
                stops.keep(epoch);
                stops
            });
            let Ok(written) = writing.await else { return halter.note(None) };
            stops = written;
        }
        if epoch > stops.epoch() {
            halter.note(None);
            // It could not be written: the next halt or the time to try again, whichever comes first.
            let _ = tokio::time::timeout(WRITTEN_AGAIN, halts.raised()).await;
        } else {
            halter.note(Some(stops.epoch()));
            halts.raised().await;
        }
    }
}

/// The greater epoch of those lines that are whole; `None` when none is, or when it is some other file.
fn understood(bytes: &[u8]) -> Option<FoundStop> {
    if bytes.len() != SIZE {
        return None;
    }
    let lines: Vec<(Epoch, usize)> =
        bytes.chunks(LINE).enumerate().filter_map(|(line, bytes)| Some((epoch_of(bytes)?, line))).collect();
    let (epoch, line) = lines.iter().copied().max_by_key(|(epoch, _)| *epoch)?;
    Some(FoundStop { epoch, line, is_sure: lines.len() == SIZE / LINE })
}

/// The epoch of a line, if it is one that `line` made.
fn epoch_of(bytes: &[u8]) -> Option<Epoch> {
    let digits = std::str::from_utf8(bytes).ok()?.strip_prefix(BEGINS)?.get(..20)?;
    let epoch = digits.parse().ok().filter(|epoch| *epoch <= GREATEST).map(Epoch)?;
    (line(epoch).as_bytes() == bytes).then_some(epoch)
}

const fn place(line: usize) -> u64 {
    (line * LINE) as u64
}

fn line(Epoch(epoch): Epoch) -> String {
    let said = format!("{BEGINS}{epoch:020}");
    format!("{said} {}\n", checksum(&said))
}

#[cfg(test)]
#[path = "stops_tests.rs"]
mod tests;
