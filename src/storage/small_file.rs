//! Reads and writes the small files of the data folder: the STOP file, the position of the simulated robot, the mark
//! of lost entries. The module that owns a file decides its contents and when it is written. `files` creates and
//! opens the files; secrets are in `private_file`.
//!
//! ```text
//!   make        new file, fsync, rename      all or nothing, and durable: the first write
//!   swap        new file, rename             all or nothing, handed to the system at once
//!   write_at    in place, not flushed        handed to the system at once, so that it outlives `kill -9`; needs no free space
//! ```

use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::files;
use super::names::Name;
use crate::runtime::archive::hex;

/// Detects damage of a text: returns the first 8 bytes of its SHA-256.
pub(crate) fn checksum(text: &str) -> String {
    hex(&Sha256::digest(text)[..8])
}

#[derive(Debug)]
pub(crate) struct SmallFile {
    path: PathBuf,
    /// Opened for writing; `None` before the first write and after a failed write.
    open: Option<File>,
    /// Whether the log already reports the failure.
    is_failing: bool,
}

impl SmallFile {
    /// Names the file. Does not touch the disk.
    pub(crate) fn within(data: &Path, name: Name) -> SmallFile {
        SmallFile::of(data, name, "")
    }

    /// Like `within`, for a name with `*`, which `part` replaces.
    pub(crate) fn of(data: &Path, name: Name, part: &str) -> SmallFile {
        SmallFile { path: name.of(data, part), open: None, is_failing: false }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Reads at most `most` + 1 bytes, so that the caller can detect a file that is too large; `None` when there is
    /// no such file.
    pub(crate) fn read(&self, most: usize) -> io::Result<Option<Vec<u8>>> {
        files::read_if_there(&self.path, most)
    }

    pub(crate) fn unfinished(&self) -> PathBuf {
        self.path.with_extension("new")
    }

    /// Replaces the file and waits for the disk. After a power cut the file has the old contents or the new ones.
    pub(crate) fn make(&mut self, bytes: &[u8]) -> io::Result<()> {
        let unfinished = self.unfinished();
        let mut file = files::create(&unfinished)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&unfinished, &self.path)?;
        self.open = Some(file);
        Ok(())
    }

    /// Replaces the file without a flush. The new contents survive `kill -9`, but not a power cut.
    pub(crate) fn swap(&mut self, bytes: &[u8]) -> io::Result<()> {
        let unfinished = self.unfinished();
        files::create(&unfinished)?.write_all(bytes)?;
        fs::rename(&unfinished, &self.path)
    }

    pub(crate) fn write_at(&mut self, place: u64, bytes: &[u8]) -> io::Result<()> {
        let mut file = match self.open.take() {
            Some(file) => file,
            None => files::open(&self.path, File::options().write(true))?,
        };
        file.seek(SeekFrom::Start(place))?;
        file.write_all(bytes)?;
        self.open = Some(file);
        Ok(())
    }

    /// Overwrites the beginning of the file, and creates the file if it does not exist. The returned file can be
    /// flushed.
    pub(crate) fn write_over(&self, bytes: &[u8]) -> io::Result<File> {
        let mut file = files::open(&self.path, File::options().write(true).create(true).truncate(false))?;
        file.write_all(bytes)?;
        Ok(file)
    }

    /// Logs when writing starts to fail and when it works again, but not each attempt.
    pub(crate) fn say(&mut self, outcome: &io::Result<()>, failing: &str, well_again: &str) {
        match outcome {
            Ok(()) if std::mem::take(&mut self.is_failing) => tracing::info!(file = %self.path.display(), "{well_again}"),
            Err(error) if !std::mem::replace(&mut self.is_failing, true) => {
                tracing::warn!(file = %self.path.display(), %error, "{failing}");
            }
            Ok(()) | Err(_) => {}
        }
    }
}
