//! The data folder: where the files of the journal are, who may read them, and the lock that allows only one
//! hallsweep at a time. The names are in `names`.

use std::fs::{File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::fault::Fault;
use crate::api::journal::Picture;
use crate::storage::files;
use crate::storage::names::{self, Name};
use crate::storage::small_file::SmallFile;

/// A data folder, which may not exist yet, or an archive. An archive is one file that is only read: see
/// `archive_file` and `unpack`.
#[derive(Clone, Debug)]
pub(super) struct Folder {
    path: PathBuf,
    is_archive: bool,
}

/// While this lock exists, no other hallsweep can write. The system releases the lock when the program ends, even
/// after a crash.
#[derive(Debug)]
pub(super) struct Lock {
    file: File,
    path: PathBuf,
}

/// Device and inode of a file, which distinguish it from all other existing files. On systems without inodes all
/// files look the same, but there an open file cannot be removed.
pub(super) type Identity = (u64, u64);

impl Lock {
    /// Whether the locked file is still in the folder, so that another hallsweep would lock the same file.
    pub(super) fn is_in_place(&self) -> bool {
        let held = self.file.metadata().map(|file| identity(&file));
        let there = std::fs::metadata(&self.path).map(|file| identity(&file));
        matches!((held, there), (Ok(held), Ok(there)) if held == there)
    }
}

impl Folder {
    pub(super) fn new(path: &Path) -> Folder {
        Folder { path: path.to_owned(), is_archive: path.is_file() }
    }

    pub(super) fn is_archive(&self) -> bool {
        self.is_archive
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    pub(super) fn journal(&self) -> PathBuf {
        if self.is_archive { self.path.clone() } else { names::JOURNAL.within(&self.path) }
    }

    pub(super) fn write_ahead_log(&self) -> PathBuf {
        names::LOG.within(&self.path)
    }

    pub(super) fn marker(&self) -> SmallFile {
        SmallFile::within(&self.path, names::LOST)
    }

    pub(super) fn kept_back(&self) -> SmallFile {
        SmallFile::within(&self.path, names::KEPT_BACK)
    }

    pub(super) fn head(&self) -> SmallFile {
        SmallFile::within(&self.path, names::HEAD)
    }

    /// Path of a photo, which may not exist.
    pub(super) fn photo(&self, picture: &Picture) -> PathBuf {
        let (first, rest) = picture.digest.split_at(2);
        self.photos().join(first).join(format!("{rest}.{}", extension(&picture.media_type)))
    }

    pub(super) fn photos(&self) -> PathBuf {
        names::PHOTOS.within(&self.path)
    }

    /// Whether there is a journal, that is, a file that is not empty. Fails if the file cannot be inspected.
    pub(super) fn has_journal(&self) -> Result<bool, Fault> {
        if !self.is_archive {
            self.check_rollback()?;
        }
        match std::fs::metadata(self.journal()) {
            Ok(file) if file.len() > 0 => Ok(true),
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error.into()),
            // In this case SQLite would begin a new journal and overwrite the log.
            Ok(_) | Err(_) if self.has_log() => Err(Fault::OnlyLog),
            Ok(_) | Err(_) => Ok(false),
        }
    }

    pub(super) fn has_log(&self) -> bool {
        std::fs::metadata(self.write_ahead_log()).is_ok_and(|file| file.len() > 0)
    }

    pub(super) fn has_photos(&self) -> bool {
        let shelves = std::fs::read_dir(self.photos()).into_iter().flatten().flatten();
        let mut files = shelves.filter_map(|shelf| std::fs::read_dir(shelf.path()).ok()).flatten().flatten();
        files.any(|file| file.path().extension() != Some("unfinished".as_ref()))
    }

    /// Fails when something has the name of a journal file but cannot be a journal file (safety R5). SQLite would
    /// block on a pipe, and would report a folder as a disk error.
    pub(super) fn check_journal(&self) -> Result<(), Fault> {
        self.check_plain(&[names::JOURNAL, names::LOG, names::LOG_INDEX])?;
        self.check_log()
    }

    /// Like `check_journal`, for the files beside the journal that are not needed for reading.
    pub(super) fn check_beside(&self) -> Result<(), Fault> {
        self.check_plain(&[names::LOCK, names::LOST, names::HEAD])?;
        files::check_folder(&self.photos()).map_err(|error| Fault::of_file(error, names::PHOTOS, self.photos()))
    }

    fn check_plain(&self, names: &[Name]) -> Result<(), Fault> {
        names.iter().try_for_each(|name| {
            let path = name.within(&self.path);
            files::check_plain(&path).map_err(|error| Fault::of_file(error, *name, path))
        })
    }

    /// Checks the rollback journal, a file that SQLite opens before it reads the journal. SQLite would block on a
    /// pipe, and would take garbage for an interrupted transaction.
    fn check_rollback(&self) -> Result<(), Fault> {
        const BEGINS: [u8; 8] = [0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7];
        self.check_plain(&[names::ROLLBACK])?;
        let bytes = files::read_if_there(&names::ROLLBACK.within(&self.path), BEGINS.len())?.unwrap_or_default();
        let begins = bytes.first().is_none_or(|first| *first == 0) || bytes.starts_with(&BEGINS);
        if begins { Ok(()) } else { Err(Fault::Unusable(names::ROLLBACK, "its first bytes are wrong".to_owned())) }
    }

    /// Checks the header of the write-ahead log. SQLite ignores a log with a wrong header, and would overwrite the
    /// entries in it.
    fn check_log(&self) -> Result<(), Fault> {
        const BEGINS: [[u8; 4]; 2] = [0x377f_0682_u32.to_be_bytes(), 0x377f_0683_u32.to_be_bytes()];
        let bytes = files::read_if_there(&self.write_ahead_log(), BEGINS[0].len())?.unwrap_or_default();
        let begins = bytes.is_empty() || BEGINS.iter().any(|begins| bytes.starts_with(begins));
        if begins { Ok(()) } else { Err(Fault::Unusable(names::LOG, "its first bytes are wrong".to_owned())) }
    }

    pub(super) fn journal_identity(&self) -> Result<Identity, Fault> {
        Ok(identity(&std::fs::metadata(self.journal())?))
    }

    /// Identity of the present lock file; `None` when there is no lock file.
    pub(super) fn lock_identity(&self) -> Option<Identity> {
        std::fs::metadata(names::LOCK.within(&self.path)).ok().map(|file| identity(&file))
    }

    /// Creates what is missing: the folder, private to its owner, and an empty journal file, with the rights that
    /// `files::open` gives. SQLite gives the files that it creates beside the journal the same mode.
    pub(super) fn create(&self) -> Result<(), Fault> {
        self.create_path()?;
        if !self.journal().exists() {
            files::open(&self.journal(), File::options().write(true).create_new(true))?.sync_all()?;
        }
        files::sync_folder(&self.path)?;
        Ok(())
    }

    pub(super) fn create_path(&self) -> Result<(), Fault> {
        if !self.path.is_dir() {
            files::make_folder(&self.path)?;
            sync_parent(&self.path)?;
        }
        Ok(())
    }

    /// Proves that `bytes` bytes can be written to the folder and flushed.
    pub(super) fn prove_room(&self, bytes: usize) -> Result<(), Fault> {
        let path = names::ROOM.within(&self.path);
        let written = files::create(&path).and_then(|mut file| {
            file.write_all(&vec![0; bytes])?;
            file.sync_all()
        });
        // The test file is removed whether or not it could be written.
        let removed = std::fs::remove_file(&path);
        Ok(written.and(removed)?)
    }

    /// Locks the folder for this program. Nothing may be written without the lock.
    pub(super) fn lock(&self) -> Result<Lock, Fault> {
        let path = names::LOCK.within(&self.path);
        files::check_plain(&path)?;
        let opened = files::open(&path, File::options().read(true).write(true).create(true).truncate(false));
        // On a read-only disk an existing lock file can still be locked.
        let file = opened.or_else(|error| File::open(&path).map_err(|_| error))?;
        match file.try_lock() {
            Ok(()) => Ok(Lock { file, path }),
            Err(TryLockError::WouldBlock) => Err(Fault::InUse),
            Err(TryLockError::Error(error)) => Err(error.into()),
        }
    }
}

#[cfg(unix)]
fn identity(file: &std::fs::Metadata) -> Identity {
    use std::os::unix::fs::MetadataExt;
    (file.dev(), file.ino())
}

#[cfg(not(unix))]
fn identity(_file: &std::fs::Metadata) -> Identity {
    (0, 0)
}

/// Extension of a photo's file name, for people who look into the folder. The program uses the recorded media type.
fn extension(media_type: &str) -> &'static str {
    match media_type {
        "image/png" => "png",
        "image/jpeg" => "jpg",
        _ => "photo",
    }
}

pub(super) fn sync_parent(path: &Path) -> io::Result<()> {
    files::sync_folder(path.parent().unwrap_or(Path::new(".")))
}
