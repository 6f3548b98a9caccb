//! Makes a data folder from an archive, completely or not at all. The folder is built beside its destination, or
//! inside the destination if that exists. Then it is moved to its destination, the journal last. From then on the new
//! journal is independent of the archive. Its first own entry names the archive from which all earlier entries
//! came, and where that archive begins.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::archive_file::{copy, digest_of, photos, refused, sound};
use super::fault::{Fault, Then, count};
use super::folder::Folder;
use super::photos::Pictures;
use super::{chain, head, pages, rows};
use crate::api::journal::Picture;
use crate::runtime::archive::Unreadable;
use crate::storage::files;
use crate::storage::names::{self, Name};
use hallsweep_core::effect::Page;
use hallsweep_core::state::fact::{Entry, Fact, Unpacked};
use hallsweep_core::units::WallTime;

/// Makes the data folder `data` from the archive `file`. Returns the number of entries in the new folder. This
/// includes the last entry, which names the archive.
pub fn unpack(file: &Path, data: &Path, now: WallTime) -> Result<u64, Unreadable> {
    let archive = Folder::new(file);
    if !archive.is_archive() {
        return Err(Unreadable(format!("there is no archive {}", file.display())));
    }
    let place = UnpackTarget::of(data)?;
    let from = sound(&archive)?;
    let begins = chain::anchor(&from).map_err(|fault| refused(file, &fault))?;
    let record = Unpacked {
        file: file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned(),
        digest: digest_of(file).map_err(|error| refused(file, &error.into()))?,
        behind: begins.seq,
        page: begins.hex(),
    };
    place.check()?;
    let entries = built(&from, &Folder::new(&place.build), Entry { wall: now, fact: Fact::Unpacked(record) });
    let entries = entries.inspect_err(|_| drop(fs::remove_dir_all(&place.build)));
    let placed = entries.and_then(|entries| Ok(place.take().map(|()| entries)?));
    placed.map_err(|fault| Unreadable(fault.words(data, Then::StartAgain)))
}

/// The destination of the folder, and the place where it is built until it is complete.
struct UnpackTarget {
    data: PathBuf,
    build: PathBuf,
    /// Whether the destination exists, perhaps as a volume or as the target of a link. If so, it stays, and the
    /// result is moved into it.
    is_there: bool,
}

impl UnpackTarget {
    /// Checks that the destination is free: it is missing, or an empty folder, or it was left by an unpacking that
    /// was killed.
    fn of(data: &Path) -> Result<UnpackTarget, Unreadable> {
        let refused = |words: &dyn std::fmt::Display| Unreadable(format!("{} cannot be used: {words}", data.display()));
        let data = match data.canonicalize() {
            Ok(there) => there,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let Some(name) = data.file_name() else { return Err(refused(&error)) };
                let mut beside = name.to_owned();
                beside.push(format!(".{}", names::UNPACK.written()));
                return Ok(UnpackTarget { data: data.to_owned(), build: data.with_file_name(beside), is_there: false });
            }
            Err(error) => return Err(refused(&error)),
        };
        let there = fs::read_dir(&data).and_then(|files| files.map(|file| Ok(file?.file_name())).collect::<io::Result<Vec<_>>>());
        let there = there.map_err(|error| refused(&error))?;
        // Some volumes have this entry even when they are empty.
        let is_empty = there.iter().all(|name| name == "lost+found");
        let has = |wanted: Name| there.iter().any(|name| name == wanted.written());
        let was_begun = has(names::UNPACK) && !has(names::JOURNAL);
        if is_empty || was_begun {
            let build = names::UNPACK.within(&data);
            Ok(UnpackTarget { data, build, is_there: true })
        } else {
            Err(Unreadable(format!("{} is not empty: name another folder with --data", data.display())))
        }
    }

    /// Fails when the place of building has contents that were not left by an earlier unpacking.
    fn check(&self) -> Result<(), Unreadable> {
        const LEFT: [Name; 4] = [names::JOURNAL, names::HEAD, names::LOCK, names::PHOTOS];
        let is_ours = match fs::symlink_metadata(&self.build) {
            Ok(there) if there.is_dir() => fs::read_dir(&self.build).is_ok_and(|mut files| {
                files.all(|file| file.is_ok_and(|file| LEFT.iter().any(|name| file.file_name() == name.written())))
            }),
            Ok(_) => false,
            Err(error) => error.kind() == io::ErrorKind::NotFound,
        };
        let words = || Unreadable(format!("{} has other contents: move it away", self.build.display()));
        if is_ours { Ok(()) } else { Err(words()) }
    }

    /// Moves the result to its destination, in one step if the destination does not exist. Otherwise each file is
    /// moved, the journal last, since a folder without a journal is no data folder.
    fn take(&self) -> io::Result<()> {
        if !self.is_there {
            fs::rename(&self.build, &self.data)?;
            return files::sync_folder(self.data.parent().unwrap_or(Path::new(".")));
        }
        let mut parts = fs::read_dir(&self.build)?.map(|part| Ok(part?.file_name())).collect::<io::Result<Vec<_>>>()?;
        parts.sort_by_key(|part| part == names::JOURNAL.written());
        for part in parts {
            let to = self.data.join(&part);
            // A move that was killed may have left this part at the destination.
            remove(if to.is_dir() { fs::remove_dir_all(&to) } else { fs::remove_file(&to) })?;
            fs::rename(self.build.join(&part), to)?;
            files::sync_folder(&self.data)?;
        }
        fs::remove_dir(&self.build)?;
        files::sync_folder(&self.data)
    }
}

/// Builds the folder. Photos come first, so that no entry names a missing photo; `own` becomes the last entry.
/// Returns the number of entries.
fn built(from: &rusqlite::Connection, folder: &Folder, own: Entry) -> Result<u64, Fault> {
    folder.create_path()?;
    let _lock = folder.lock()?;
    // Removes what a killed unpacking left.
    for left in [folder.journal(), folder.head().path().to_owned()] {
        remove(fs::remove_file(left))?;
    }
    remove(fs::remove_dir_all(folder.photos()))?;
    for (digest, media_type) in photos(from)? {
        let photo = Pictures::Table.read(from, &Picture { digest, media_type })?;
        Pictures::Files(folder).keep(from, &photo)?;
    }
    // Creates the journal file here, so that it is private.
    drop(files::open(&folder.journal(), fs::File::options().write(true).create_new(true))?);
    let (entries, end) = copy(from, &folder.journal(), None, |journal| {
        let page = Page { first: rows::last_up_to(journal, None)?.next(), entries: vec![own], kept_back: None };
        pages::write(journal, Pictures::Files(folder), &page, None)?;
        let entries: i64 = journal.query_row("SELECT count(*) FROM events", [], |row| row.get(0))?;
        Ok((count(entries), chain::close_page(journal)?))
    })?;
    head::write(folder, &end)?;
    files::sync_folder(folder.path())?;
    Ok(entries)
}

/// A missing file counts as removed.
fn remove(removed: io::Result<()>) -> io::Result<()> {
    removed.or_else(|error| if error.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(error) })
}
