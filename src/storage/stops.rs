//! A second record of STOP (safety S4). A stop is answered before it is in the journal. So the epoch (a number that
//! each stop raises) is also written to a small file. In this file the epoch survives `kill -9`, even when the
//! journal cannot be written. `app` decides what a start does with the epoch. Only the journal records who stopped.
//!
//! ```text
//!   hallsweep stops 1 00000000000000000041 5d1c0a8e77f0b3c2     two such lines; the greater epoch counts, and the
//!   hallsweep stops 1 00000000000000000042 90b2f3a4c5d60718     other one is written next
//! ```
//! The file has its full size from the first start, so that a full disk has room for every later stop. Nothing is
//! flushed: the system has the written bytes at once, and only a power cut may lose the last seconds.

use std::fs;
use std::io;
use std::path::Path;
use std::time::Duration;

use crate::runtime::halt::Halter;
use crate::storage::small_file::{SmallFile, checksum};
use crate::storage::{files, names};
use hallsweep_core::units::Epoch;

/// How a line begins: the program's name and the version of the format.
const BEGINS: &str = "hallsweep stops 1 ";

/// Bytes of a line: its beginning, twenty digits, a space, sixteen digits of the checksum, and the end of the line.
const LINE: usize = BEGINS.len() + 20 + 1 + 16 + 1;

/// Bytes of the file. Both lines are in one sector.
const SIZE: usize = 2 * LINE;

/// Largest epoch that is accepted from the file. Nobody can press STOP often enough to exceed it.
const GREATEST: u64 = i64::MAX as u64;

/// A failed write is retried after this time, or at the next stop if that comes earlier.
const WRITTEN_AGAIN: Duration = Duration::from_secs(1);

#[derive(Debug)]
pub struct Stops {
    file: SmallFile,
    epoch: Epoch,
    turn: usize,
    /// Whether a line could not be read at the start, so that the last stop may be missing.
    was_damaged: bool,
    /// Whether the damaged contents were given the name `stops.damaged` before they were replaced.
    was_set_aside: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FoundStop {
    epoch: Epoch,
    /// The line that has the greater epoch.
    line: usize,
    /// Whether the other line is readable too. If not, that line may have named a later stop.
    is_sure: bool,
}

impl Stops {
    /// Why the file in the folder `dir` cannot be used at all, and what to do. `None` when it can be used, or does
    /// not exist yet. Changes nothing.
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

    /// Opens the file in the folder `dir`, or creates it with its full size. A fault is logged and is not an error;
    /// the next stop retries. A file with an unreadable line is set aside, and a new file replaces it.
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
                    // The damaged file gets a second name, so that it can be found even after a kill before the new
                    // file exists. On a volume without links it is overwritten, because a STOP must find its file.
                    let aside = names::STOPS_DAMAGED.within(dir);
                    let _ = fs::remove_file(&aside);
                    stops.was_set_aside = fs::hard_link(stops.file.path(), &aside).is_ok();
                }
            },
            Ok(None) => {}
            Err(error) => {
                tracing::warn!(file = %stops.file.path().display(), %error, "the record of STOP in this file cannot be read");
                return stops;
            }
        }
        let made = stops.make();
        stops.say(&made);
        stops
    }

    /// Epoch of the last stop in the file; 0 when the file has no stop.
    pub const fn epoch(&self) -> Epoch {
        self.epoch
    }

    /// Path of the file if its contents could not be read. In this case the last stop may be missing from the
    /// records. The second value says whether the contents were set aside.
    pub fn damaged(&self) -> Option<(&Path, bool)> {
        self.was_damaged.then_some((self.file.path(), self.was_set_aside))
    }

    /// Writes an epoch, unless a later one is stored. A failure is logged, and the write is retried later.
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
        let failing = "cannot store a STOP in this file: free disk space, or make the folder writable; hallsweep tries again";
        self.file.say(outcome, failing, "STOP is stored in this file again");
    }
}

/// Writes every stop to the file, and reports to the halter whether the stop is written. A separate thread does the
/// writing, so that a disk that hangs prevents no stop. Ends with the program.
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
            // The write failed: retry at the next halt or after the pause, whichever comes first.
            let _ = tokio::time::timeout(WRITTEN_AGAIN, halts.raised()).await;
        } else {
            halter.note(Some(stops.epoch()));
            halts.raised().await;
        }
    }
}

/// The greater epoch of the readable lines; `None` when neither line is readable, or when the bytes are not such a file.
fn understood(bytes: &[u8]) -> Option<FoundStop> {
    if bytes.len() != SIZE {
        return None;
    }
    let lines: Vec<(Epoch, usize)> =
        bytes.chunks(LINE).enumerate().filter_map(|(line, bytes)| Some((epoch_of(bytes)?, line))).collect();
    let (epoch, line) = lines.iter().copied().max_by_key(|(epoch, _)| *epoch)?;
    Some(FoundStop { epoch, line, is_sure: lines.len() == SIZE / LINE })
}

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
