//! A data folder that is made of an archive, whole or not at all: it is built beside its place and then renamed. It is a journal of its own from
//! there on, whose first own entry says from which archive all before it is, and where that begins.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::archive_file::{copy, digest_of, photos, refused, sound};
use super::fault::{Fault, Then, count};
use super::folder::{Folder, sync_parent};
use super::photos::Pictures;
use super::{chain, head, pages, rows};
use crate::api::journal::Picture;
use crate::runtime::archive::Unreadable;
use crate::storage::files;
use hallsweep_core::effect::{Entry, Fact, Page, Unpacked};
use hallsweep_core::units::WallTime;

/// Makes the folder `data` of the archive `file`; how many entries it has then.
pub fn unpack(file: &Path, data: &Path, now: WallTime) -> Result<u64, Unreadable> {
    let archive = Folder::new(file);
    if !archive.is_archive() {
        return Err(Unreadable(format!("there is no archive {}", file.display())));
    }
    let Some(build) = beside(data) else {
        return Err(Unreadable(format!("{} is not empty: name a folder that is not there yet with --data", data.display())));
    };
    let from = sound(&archive)?;
    let begins = chain::anchor(&from).map_err(|fault| refused(file, &fault))?;
    let record = Unpacked {
        file: file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned(),
        digest: digest_of(file).map_err(|error| refused(file, &error.into()))?,
        behind: begins.seq,
        page: begins.hex(),
    };
    built(&from, &Folder::new(&build), Entry { wall: now, fact: Fact::Unpacked(record) })
        .and_then(|entries| {
            fs::rename(&build, data)?;
            sync_parent(data)?;
            Ok(entries)
        })
        .map_err(|fault| Unreadable(fault.words(data, Then::StartAgain)))
}

/// Where the folder is built; nothing where there is something in its place already.
fn beside(data: &Path) -> Option<PathBuf> {
    let is_free = match fs::read_dir(data) {
        Ok(mut there) => there.next().is_none(),
        Err(error) => error.kind() == io::ErrorKind::NotFound,
    };
    let mut name = data.file_name().filter(|_| is_free)?.to_owned();
    name.push(".hallsweep-unpack");
    Some(data.with_file_name(name))
}

/// Builds it, photos first, up to an entry of its own; how many entries it has.
fn built(from: &rusqlite::Connection, folder: &Folder, own: Entry) -> Result<u64, Fault> {
    folder.create_path()?;
    let _lock = folder.lock()?;
    // What a kill left of an earlier one is begun anew.
    for left in [folder.journal(), folder.head().path().to_owned()] {
        remove(fs::remove_file(left))?;
    }
    remove(fs::remove_dir_all(folder.photos()))?;
    for (digest, media_type) in photos(from)? {
        let photo = Pictures::Table.read(from, &Picture { digest, media_type })?;
        Pictures::Files(folder).keep(from, &photo)?;
    }
    // It is made here, so that it is private.
    drop(files::open(&folder.journal(), fs::File::options().write(true).create_new(true))?);
    let (entries, end) = copy(from, &folder.journal(), None, |journal| {
        let page = Page { first: rows::last_up_to(journal, None)?.next(), entries: vec![own] };
        pages::write(journal, Pictures::Files(folder), &page, None)?;
        let entries: i64 = journal.query_row("SELECT count(*) FROM events", [], |row| row.get(0))?;
        Ok((count(entries), chain::close_page(journal)?))
    })?;
    head::write(folder, &end)?;
    files::sync_folder(folder.path())?;
    Ok(entries)
}

/// What is not there need not be removed.
fn remove(removed: io::Result<()>) -> io::Result<()> {
    removed.or_else(|error| if error.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(error) })
}
