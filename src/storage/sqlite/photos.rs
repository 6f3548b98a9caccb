//! Photos as files that are named by the digest of their bytes: written so that a name never stands for half a photo (safety
//! D3), and held against the digest when they are read.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;

use sha2::{Digest, Sha256};

use super::fault::Fault;
use super::folder::{Folder, sync_folder};
use crate::api::journal::Picture;
use crate::storage::files;
use hallsweep_core::event::Photo;

/// The media types that a photo can have, for those read back.
const MEDIA_TYPES: [&str; 2] = ["image/png", "image/jpeg"];

/// No photo is larger: what has more bytes is none of ours.
const LARGEST: usize = 64 * 1024 * 1024;

/// What a photo of a type that this version does not know is called.
const OTHER: &str = "application/octet-stream";

/// Writes a photo so that it lasts, before anything on record names it: a file of another name, fsync, rename, fsync the folder.
pub(super) fn keep(folder: &Folder, photo: &Photo) -> Result<Picture, Fault> {
    let picture = Picture { digest: digest(&photo.bytes), media_type: photo.media_type.to_owned() };
    let path = folder.photo(&picture);
    let shelf = path.parent().expect("a photo stands in a folder of its own two letters");
    if !holds(&path, &photo.bytes) {
        [&folder.photos(), shelf].into_iter().try_for_each(files::make_folder_within)?;
        let unfinished = path.with_extension("unfinished");
        write(&unfinished, &photo.bytes).and_then(|()| std::fs::rename(&unfinished, &path)).inspect_err(|_| {
            // What is left of it would be in nobody's way, and the next photo of this name replaces it.
            let _ = std::fs::remove_file(&unfinished);
        })?;
    }
    // Also for a photo that is there already: whoever put it there may have failed at just this.
    [shelf, &folder.photos(), folder.path()].into_iter().try_for_each(sync_folder)?;
    Ok(picture)
}

/// Reads a photo, and holds it against its digest.
pub(super) fn read(folder: &Folder, picture: &Picture) -> Result<Photo, Fault> {
    if !picture.is_sound() {
        return Err(Fault::Photo("has no digest on record"));
    }
    let bytes = files::read(&folder.photo(picture), LARGEST).map_err(|error| {
        let absent = error.kind() == io::ErrorKind::NotFound;
        if absent { Fault::Photo("is not there") } else { Fault::File(error) }
    })?;
    if digest(&bytes) != picture.digest {
        return Err(Fault::Photo("is not what it was"));
    }
    let media_type = MEDIA_TYPES.into_iter().find(|known| *known == picture.media_type).unwrap_or(OTHER);
    Ok(Photo { bytes: Arc::from(bytes), media_type })
}

fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = files::open(path, File::options().write(true).create(true).truncate(true))?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Whether the photo is there already, whole: an operator may have taken the same twice, or a restart may repeat it.
fn holds(path: &Path, bytes: &[u8]) -> bool {
    files::read(path, bytes.len()).is_ok_and(|there| there == bytes)
}

fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
