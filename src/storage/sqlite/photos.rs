//! Photos. A photo is named by the digest of its bytes, and the digest is checked when the photo is read. On disk
//! photos are files, written so that a name never stands for an incomplete photo (safety D3). In memory they are rows
//! of a table.

use std::io::{self, Write};
use std::sync::Arc;

use rusqlite::{Connection, OptionalExtension, params};
use sha2::{Digest, Sha256};

use super::fault::Fault;
use super::folder::Folder;
use crate::api::journal::Picture;
use crate::runtime::archive::hex;
use crate::storage::files;
use hallsweep_core::event::Photo;

const MEDIA_TYPES: [&str; 2] = ["image/png", "image/jpeg"];

/// Maximum size of a photo in bytes. This program writes no larger file.
const LARGEST: usize = 64 * 1024 * 1024;

/// Media type of photos whose type this version does not know.
const OTHER: &str = "application/octet-stream";

pub(super) const PICTURES: &str = "CREATE TABLE pictures (digest TEXT PRIMARY KEY, content BLOB NOT NULL) STRICT;";

#[derive(Clone, Copy, Debug)]
pub(super) enum Pictures<'a> {
    Files(&'a Folder),
    /// Rows in the table `pictures` of a journal in memory, or of an archive.
    Table,
}

impl Folder {
    pub(super) fn pictures(&self) -> Pictures<'_> {
        if self.is_archive() { Pictures::Table } else { Pictures::Files(self) }
    }
}

impl Pictures<'_> {
    /// Stores a photo before any entry names it. A photo on disk is durable when this returns.
    pub(super) fn keep(self, connection: &Connection, photo: &Photo) -> Result<Picture, Fault> {
        let picture = Picture { digest: digest(&photo.bytes), media_type: photo.media_type.to_owned() };
        match self {
            Pictures::Files(folder) => keep_file(folder, &picture, &photo.bytes)?,
            Pictures::Table => {
                let sql = "INSERT INTO pictures (digest, content) VALUES (?1, ?2) ON CONFLICT (digest) DO NOTHING";
                connection.prepare_cached(sql)?.execute(params![picture.digest, &photo.bytes[..]])?;
            }
        }
        Ok(picture)
    }

    pub(super) fn read(self, connection: &Connection, picture: &Picture) -> Result<Photo, Fault> {
        if !picture.is_sound() {
            return Err(Fault::Photo("a photo has no digest on record".to_owned()));
        }
        let spoilt = |what: &str| Fault::Photo(format!("the photo {} {what}", self.place(picture)));
        let bytes = match self {
            Pictures::Files(folder) => {
                let path = folder.photo(picture);
                files::read_if_there(&path, LARGEST).map_err(|error| {
                    let is_closed = error.kind() == io::ErrorKind::PermissionDenied;
                    if is_closed { Fault::Closed(path) } else { Fault::File(files::naming(&path)(error)) }
                })?
            }
            Pictures::Table => {
                let mut statement = connection.prepare_cached("SELECT content FROM pictures WHERE digest = ?1")?;
                statement.query_row([&picture.digest], |row| row.get(0)).optional()?
            }
        };
        let bytes: Vec<u8> = bytes.ok_or_else(|| spoilt("is missing"))?;
        if digest(&bytes) != picture.digest {
            return Err(spoilt("was changed"));
        }
        let media_type = MEDIA_TYPES.into_iter().find(|known| *known == picture.media_type).unwrap_or(OTHER);
        Ok(Photo { bytes: Arc::from(bytes), media_type })
    }

    fn place(self, picture: &Picture) -> String {
        match self {
            Pictures::Files(folder) => folder.photo(picture).display().to_string(),
            Pictures::Table => picture.digest.clone(),
        }
    }
}

/// Stores a photo in this order: temporary file, fsync, rename, fsync of the folders. So no name ever stands for an
/// incomplete photo (safety D3).
fn keep_file(folder: &Folder, picture: &Picture, bytes: &[u8]) -> Result<(), Fault> {
    let path = folder.photo(picture);
    let shelf = path.parent().expect("a photo is in a folder named by the first two letters of its digest");
    // A restart or an operator may take the same photo twice.
    let is_complete = files::read(&path, bytes.len()).is_ok_and(|there| there == bytes);
    if !is_complete {
        [&folder.photos(), shelf].into_iter().try_for_each(files::make_folder_within)?;
        let unfinished = path.with_extension("unfinished");
        let written = files::create(&unfinished).and_then(|mut file| {
            file.write_all(bytes)?;
            file.sync_all()
        });
        written.and_then(|()| std::fs::rename(&unfinished, &path).map_err(files::naming(&path))).inspect_err(|_| {
            // A file that stays does no harm, and the next photo of this name replaces it.
            let _ = std::fs::remove_file(&unfinished);
        })?;
    }
    // The folders are flushed for an existing photo too, since its writer may have failed at exactly this step.
    Ok([shelf, &folder.photos(), folder.path()].into_iter().try_for_each(files::sync_folder)?)
}

fn digest(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}
