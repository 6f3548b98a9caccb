//! The one way in which the small files of the data folder are read and written: what remembers a STOP, where the simulated robot
//! stands, what was said to be lost, the keys. Each says itself what stands in it and when it is written; how the files of the
//! folder are made and opened at all is said in `files`.
//!
//! ```text
//!   make        beside it, fsync, rename     whole or not at all, and it lasts: the first writing, and each of a private file
//!   swap        beside it, rename            whole or not at all, in the system's hands at once
//!   write_at    in place, nothing flushed    in the system's hands at once, so that it outlives `kill -9`; needs no room
//! ```

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use super::files;

#[derive(Debug)]
pub(crate) struct SmallFile {
    path: PathBuf,
    /// Opened for writing; `None` before the first writing and after one that failed.
    open: Option<File>,
    /// Whether it was said already that it cannot be written.
    is_failing: bool,
}

impl SmallFile {
    /// The file `name` in the folder `dir`. Nothing is opened or looked at.
    pub(crate) fn within(dir: &Path, name: &str) -> SmallFile {
        SmallFile { path: dir.join(name), open: None, is_failing: false }
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

    /// Makes it anew, whole or not at all, and waits for the disk: a power cut then leaves the old one or the new one. It is waited
    /// for whatever has the name of the unfinished one, so whoever must not wait looks at that before.
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

/// A file that its owner alone may read, whatever folder it stands in, and that is replaced as a whole at each writing.
#[derive(Clone, Debug)]
pub(crate) struct PrivateFile(PathBuf);

impl PrivateFile {
    pub(crate) fn within(dir: &Path, name: &str) -> PrivateFile {
        PrivateFile(dir.join(name))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// What stands in it up to `most` bytes, and who may read it as the mode of the file; `None` where there is no such file. Where
    /// there are no modes the folder of the user keeps others out, and its mode is 0.
    pub(crate) fn read(&self, most: u64) -> io::Result<Option<(Vec<u8>, u32)>> {
        files::check_plain(&self.0)?;
        let file = match File::open(&self.0) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            opened => opened?,
        };
        let mode = mode(&file.metadata()?);
        let mut bytes = Vec::new();
        file.take(most).read_to_end(&mut bytes)?;
        Ok(Some((bytes, mode)))
    }

    /// Replaces it, and is done when that has reached the disk. The folder is made when it is not there.
    pub(crate) fn replace(&self, bytes: &[u8]) -> io::Result<()> {
        let folder = self.0.parent().unwrap_or(Path::new("."));
        files::make_folder(folder)?;
        // Two programs may write it at once.
        let fresh = self.0.with_extension(format!("{}.new", std::process::id()));
        // One that a crash left behind may be anybody's: it is not written into.
        let _ = fs::remove_file(&fresh);
        let written = write_private(&fresh, bytes).and_then(|()| fs::rename(&fresh, &self.0));
        if written.is_err() {
            let _ = fs::remove_file(&fresh);
        }
        written.and_then(|()| files::sync_folder(folder))
    }
}

fn write_private(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut file = options.open(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

#[cfg(unix)]
fn mode(metadata: &fs::Metadata) -> u32 {
    std::os::unix::fs::PermissionsExt::mode(&metadata.permissions()) & 0o777
}

#[cfg(not(unix))]
fn mode(_: &fs::Metadata) -> u32 {
    0
}
