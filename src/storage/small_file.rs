//! The one way in which the small files of the data folder are read and written: what remembers a STOP, where the simulated robot
//! stands, what was said to be lost. Each says itself what stands in it and when it is written; how the files of the folder are made
//! and opened at all is said in `files`, and how secrets are kept in `private_file`.
//!
//! ```text
//!   make        beside it, fsync, rename     whole or not at all, and it lasts: the first writing
//!   swap        beside it, rename            whole or not at all, in the system's hands at once
//!   write_at    in place, nothing flushed    in the system's hands at once, so that it outlives `kill -9`; needs no room
//! ```

use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::files;
use super::names::Name;
use crate::runtime::archive::hex;

/// By which a damaged text differs from what was written.
pub(crate) fn checksum(text: &str) -> String {
    hex(&Sha256::digest(text)[..8])
}

#[derive(Debug)]
pub(crate) struct SmallFile {
    path: PathBuf,
    /// Opened for writing; `None` before the first writing and after one that failed.
    open: Option<File>,
    /// Whether it was said already that it cannot be written.
    is_failing: bool,
}

impl SmallFile {
    /// The file `name` in the data folder. Nothing is opened or looked at.
    pub(crate) fn within(data: &Path, name: Name) -> SmallFile {
        SmallFile::of(data, name, "")
    }

    /// One of several files of a kind: `part` tells it from the others.
    pub(crate) fn of(data: &Path, name: Name, part: &str) -> SmallFile {
        SmallFile { path: name.of(data, part), open: None, is_failing: false }
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// What stands in it, and one byte more than `most` when it has more than that; `None` where there is no such file.
    pub(crate) fn read(&self, most: usize) -> io::Result<Option<Vec<u8>>> {
        files::read_if_there(&self.path, most)
    }

    /// What the file is called until it is whole.
    pub(crate) fn unfinished(&self) -> PathBuf {
        self.path.with_extension("new")
    }

    /// Makes it anew, whole or not at all, and waits for the disk: a power cut then leaves the old one or the new one.
    pub(crate) fn make(&mut self, bytes: &[u8]) -> io::Result<()> {
        let unfinished = self.unfinished();
        let mut file = files::create(&unfinished)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&unfinished, &self.path)?;
        self.open = Some(file);
        Ok(())
    }

    /// Replaces it, whole or not at all, and flushes nothing: what was handed over outlives `kill -9`.
    pub(crate) fn swap(&mut self, bytes: &[u8]) -> io::Result<()> {
        let unfinished = self.unfinished();
        files::create(&unfinished)?.write_all(bytes)?;
        fs::rename(&unfinished, &self.path)
    }

    /// Writes over what stands at `place` of a file that is there.
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

    /// Writes over its beginning, also where there is none yet; what is given back can be flushed.
    pub(crate) fn write_over(&self, bytes: &[u8]) -> io::Result<File> {
        let mut file = files::open(&self.path, File::options().write(true).create(true).truncate(false))?;
        file.write_all(bytes)?;
        Ok(file)
    }

    /// Says in the log when it begins to fail, and when it is well again; not each time.
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
