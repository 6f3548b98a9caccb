//! Keeps what the simulated robot must not forget in one small file of the data folder, so that the hall is as it was left when
//! the program comes back. What is kept stands in `memory`, how it is written in `diary::page`; when, `link` decides.
//!
//! It plays physics, so it costs as little as it can: 1 KiB written in place for each order begun or ended. That is in the
//! system's hands at once and outlives `kill -9`; only a power cut may take the last seconds of it, as nothing is forced to the
//! disk. What must outlive that is in the journal.

use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::storage::files;
use hallsweep_sim::Hall;
use hallsweep_sim::SimMemory;

mod error;

pub use error::DiaryError;
use hallsweep_sim::page::{self, Page, Unread, Whose};

/// The name of the file in the data folder.
const FILE: &str = "simulated-robot.txt";

/// The memory of a simulated robot in a folder.
#[derive(Debug)]
pub struct Diary {
    path: PathBuf,
    whose: Whose,
    /// Counts the writings.
    turn: u64,
    /// The file, opened for writing; `None` before the first writing and after one that failed.
    file: Option<File>,
    /// Whether the file must be made anew.
    anew: bool,
    /// What could not be written and has still to be.
    owed: Option<SimMemory>,
}

impl Diary {
    /// The diary in the folder `dir` and what it remembers of this hall; nothing when there is no file yet. Nothing is written.
    ///
    /// # Errors
    /// A file that cannot be read or understood, or is of another hall. It stays as it is.
    pub fn open(dir: &Path, hall: &Hall) -> Result<(Diary, Option<SimMemory>), DiaryError> {
        let mut diary = Diary::begin_anew(dir, hall);
        let path = || diary.path.clone();
        let bytes = match files::read(&diary.path, page::SIZE) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let unfinished = unfinished(&diary.path);
                return match files::check_plain(&unfinished) {
                    Ok(()) => Ok((diary, None)),
                    Err(error) => Err(DiaryError::Unreadable { path: unfinished, error }),
                };
            }
            Err(error) => return Err(DiaryError::Unreadable { path: path(), error }),
        };
        let Page { whose, turn, memory } = page::read(&bytes).map_err(|unread| match unread {
            Unread::Version(found) => DiaryError::OtherVersion { path: path(), found },
            Unread::Damaged(fault) => DiaryError::Damaged { path: path(), fault },
        })?;
        if !whose.is_same(&diary.whose) {
            let (remembered, given) = (whose.hall, diary.whose.hall);
            return Err(DiaryError::OtherHall { path: diary.path, remembered, given });
        }
        if !memory.fits(hall) {
            let fault = "it says that the robot stands where it cannot be".to_owned();
            return Err(DiaryError::Damaged { path: path(), fault });
        }
        (diary.turn, diary.anew) = (turn, false);
        Ok((diary, Some(memory)))
    }

    /// A diary for a robot that is put down anew in this hall. The first writing takes the place of whatever file there is, so
    /// it is for a folder without one, or when the robot is meant to leave the hall it was in.
    #[must_use]
    pub fn begin_anew(dir: &Path, hall: &Hall) -> Diary {
        let path = dir.join(FILE);
        Diary { path, whose: Whose::of(hall), turn: 0, file: None, anew: true, owed: None }
    }

    /// Writes down a memory. When that fails, the simulation goes on all the same: the log says so once, and the memory stays
    /// owed until this, or a later one, is written.
    pub fn keep(&mut self, memory: SimMemory) {
        match self.write(&memory) {
            Ok(()) => {
                if self.owed.take().is_some() {
                    tracing::info!(file = %self.path.display(), "where the simulated robot stands is kept again");
                }
            }
            Err(error) => {
                // A file that somebody has taken away is made again.
                self.anew |= error.kind() == io::ErrorKind::NotFound;
                if self.owed.replace(memory).is_none() {
                    tracing::warn!(
                        file = %self.path.display(), %error,
                        "cannot keep where the simulated robot stands: make room, or the folder writable; it is tried again"
                    );
                }
            }
        }
    }

    /// What could not be written yet.
    #[must_use]
    pub const fn owed(&self) -> Option<SimMemory> {
        self.owed
    }

    fn write(&mut self, memory: &SimMemory) -> io::Result<()> {
        if self.anew {
            self.file = Some(create(&self.path, &page::whole(&self.whose, self.turn, memory))?);
            self.anew = false;
            return Ok(());
        }
        let turn = self.turn.wrapping_add(1);
        let mut file = match self.file.take() {
            Some(file) => file,
            None => files::open(&self.path, File::options().write(true))?,
        };
        file.seek(SeekFrom::Start(page::place(turn)))?;
        file.write_all(&page::slot(turn, memory))?;
        (self.turn, self.file) = (turn, Some(file));
        Ok(())
    }
}

/// Makes the file whole or not at all. It is made once a hall, so here the disk is waited for: a power cut then leaves a file
/// that can be read.
fn create(path: &Path, bytes: &[u8]) -> io::Result<File> {
    let unfinished = unfinished(path);
    let mut file = files::create(&unfinished)?;
    file.write_all(bytes)?;
    file.sync_all()?;
    fs::rename(&unfinished, path)?;
    Ok(file)
}

/// What the file is called until it is whole.
fn unfinished(path: &Path) -> PathBuf {
    path.with_extension("new")
}

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(super) use tests::Folder;
