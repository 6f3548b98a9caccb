//! Checks that archives and the journal fit together, and that they agree with the records of archiving.
//!
//! ```text
//!   first    1 ───── n            each part begins after a page of the part before it;
//!   second         n ──────── m   each archive is on record, as archived or as unpacked
//!   journal                 m ─────────► head
//! ```

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use rusqlite::Connection;

use super::archive_file::{digest_of, refused};
use super::check::check;
use super::fault::{Fault, Then};
use super::folder::Folder;
use super::of_archives::Records;
use super::schema::{self, Format};
use super::{chain, connect};
use crate::runtime::archive::{Head, Unreadable};
use hallsweep_core::units::Seq;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArchiveCheck {
    /// Number of archives; an archive that was named twice counts once.
    pub archives: usize,
    /// One sentence for each fault. It is empty when all archives are unchanged and follow each other from the first
    /// entry on.
    pub faults: Vec<String>,
}

/// A readable archive. `begins` is the page after which it begins, `ends` is its last page.
struct OpenArchive {
    shown: String,
    digest: String,
    begins: Head,
    ends: Head,
    connection: Connection,
}

pub(super) fn check_archives(journal: &Connection, folder: &Folder, files: &[PathBuf]) -> Result<ArchiveCheck, Unreadable> {
    let words = |fault: Fault| Unreadable(fault.words(folder.path(), Then::StartAgain));
    if let Format::Older(version) = schema::format(journal).map_err(words)? {
        return Err(words(Fault::Older(version)));
    }
    let mut faults = Vec::new();
    let archives = opened(files, &mut faults);
    // Every later archive has a record of the earlier archives.
    let mut records = Records::of(journal).map_err(words)?;
    let (mut begins, mut later) = (chain::anchor(journal).map_err(words)?, "the journal");
    for archive in archives.iter().rev() {
        let others = archives.iter().filter(|other| other.digest != archive.digest).map(|other| &other.connection);
        let fault = between(begins, later, archive, &records, others.chain([journal]));
        let added = fault.and_then(|fault| records.add(&archive.connection).map(|()| fault));
        faults.extend(added.map_err(|fault| refused(Path::new(&archive.shown), &fault))?);
        (begins, later) = (archive.begins, &archive.shown);
    }
    if begins.seq > Seq(0) && records.unpacked(begins).is_none() {
        let last =
            records.written_out(begins.seq).map(|last| format!("; the last archive is {} (SHA-256 {})", last.file, last.digest));
        let last = last.unwrap_or_default();
        faults.push(format!("entries 1 to {} are in archives that were not checked{last}", begins.seq));
    }
    Ok(ArchiveCheck { archives: archives.len(), faults })
}

/// Checks that `archive` and the next part of the chain fit together; returns a sentence if they do not. `later`
/// names the next part, which begins after the page `begins`. This page must be in the archive. For an archive from
/// which the journal was unpacked, the rule differs: both begin after the same page, and the journal or another
/// archive must contain the last page of the archive.
fn between<'a>(
    begins: Head,
    later: &str,
    archive: &OpenArchive,
    records: &Records,
    mut others: impl Iterator<Item = &'a Connection>,
) -> Result<Option<String>, Fault> {
    let OpenArchive { shown, digest, .. } = archive;
    let is_there = |connection, page: Head| chain::page_of(connection, page.seq).map(|there| there == Some(page));
    if records.unpacked.iter().any(|record| record.digest == *digest) {
        let why = "an archive between the two is missing, or one of the two was changed";
        if begins != archive.begins || records.unpacked(begins).is_none_or(|record| record.digest != *digest) {
            return Ok(Some(format!(
                "{later} does not begin where the archive {shown} begins, from which the journal was unpacked: {why}"
            )));
        }
        let goes_on = others.try_fold(false, |found, other| Ok::<_, Fault>(found || is_there(other, archive.ends)?))?;
        return Ok((!goes_on).then(|| format!("the journal differs from the archive {shown}, from which it was unpacked: {why}")));
    }
    if !is_there(&archive.connection, begins)? {
        return Ok(Some(format!("{later} does not continue {shown}: an archive between the two is missing")));
    }
    let is_on_record = records.written_out.iter().any(|record| record.digest == *digest);
    let words = || format!("{shown} is not an archive of this journal, or was changed: its SHA-256 is {digest}");
    Ok((!is_on_record).then(words))
}

/// Opens each archive once; returns the archives in the order in which they follow each other. Reports archives that
/// are unsound or unreadable.
fn opened(files: &[PathBuf], faults: &mut Vec<String>) -> Vec<OpenArchive> {
    let (mut archives, mut known) = (Vec::new(), BTreeSet::new());
    for file in files {
        match look_at(file, &mut known, faults) {
            Ok(archive) => archives.extend(archive),
            Err(Unreadable(why)) => faults.push(why),
        }
    }
    archives.sort_by_key(|archive| (archive.begins.seq, archive.ends.seq));
    archives
}

/// Opens an archive; `None` when an archive with this digest was opened before.
fn look_at(file: &Path, known: &mut BTreeSet<String>, faults: &mut Vec<String>) -> Result<Option<OpenArchive>, Unreadable> {
    let (archive, shown) = (Folder::new(file), file.display().to_string());
    if !archive.is_archive() {
        return Err(Unreadable(format!("there is no archive {shown}")));
    }
    let digest = digest_of(file).map_err(|error| refused(file, &error.into()))?;
    if !known.insert(digest.clone()) {
        return Ok(None);
    }
    let looked = || {
        let connection = connect::reader(&archive)?.ok_or(Fault::Foreign)?.connection;
        let found = check(&connection, &archive)?.faults;
        Ok((found, chain::anchor(&connection)?, chain::end(&connection)?, connection))
    };
    let (found, begins, ends, connection) = looked().map_err(|fault| refused(file, &fault))?;
    faults.extend(found.into_iter().map(|fault| format!("{shown}: {fault}")));
    Ok(Some(OpenArchive { shown, digest, begins, ends, connection }))
}
