//! Archives. An archive has old missions of a journal in one file, which is itself a journal and includes the photos.
//! An archive holds a section of the chain:
//!
//! ```text
//!   journal   1 ─────────────── gone ─┬─ RESET, state snapshot ──┬─ last ──────────────► head
//!   archive   1 ──────────────────────┼───────────────────────── last
//!   next                              gone ───────────────────────────────── …
//! ```
//! Archive and journal both contain the page with which the last archived mission ends, since the state after it
//! follows from this page. So the state can be computed from each archive by itself. The next archive, or the
//! journal, continues from a page that the previous archive contains. Entries leave the journal only after the
//! archive is on disk, was read again, and has the same digests.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags, Transaction, TransactionBehavior, params};
use sha2::{Digest, Sha256};

use super::check::{Findings, check, check_entries};
use super::cut::{Bound, Cut, cuts};
use super::fault::{Fault, Then, count, whole};
use super::folder::{Folder, sync_parent};
use super::photos::{PICTURES, Pictures};
use super::{chain, connect, head, marker, pages, project, rows, schema};
use crate::api::journal::Picture;
use crate::runtime::archive::{Head, Unreadable, hex};
use crate::storage::{files, names};
use hallsweep_core::effect::Page;
use hallsweep_core::state::fact::{Entry, Fact, WrittenOut};
use hallsweep_core::units::{Seq, WallTime};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Archived {
    pub what: WrittenOut,
    /// Last entry of the archive, and the digest of its page.
    pub last: Head,
    pub photos: u64,
    /// Number of missions that are old enough but did not fit into this archive.
    pub left: u64,
}

/// Suffix of an archive's name while it is written.
const UNFINISHED: &str = "unfinished";

/// Moves all missions that were put away before `before` from the journal into `file`, oldest first and without a
/// gap. Returns `None`, and changes nothing, when there are no such missions.
pub fn write_out(data: &Path, before: WallTime, now: WallTime, file: &Path) -> Result<Option<Archived>, Unreadable> {
    write_out_within(data, before, now, Bound::NONE, |_| file.to_owned())
}

/// Like `write_out`, but into the folder `archives` of the data folder. The amount is limited, so that a start can
/// wait for it.
pub fn write_out_at_start(data: &Path, before: WallTime, now: WallTime) -> Result<Option<Archived>, Unreadable> {
    let archives = names::ARCHIVES.within(data);
    let made = files::make_folder_within(&archives).and_then(|()| files::sync_folder(data));
    made.and_then(|()| sweep(&archives)).map_err(|error| {
        Unreadable(format!("{} cannot be used ({error}): move it away, then start hallsweep again", archives.display()))
    })?;
    // The name follows from the contents, so that the same archive gets the same name again.
    write_out_within(data, before, now, Bound::OF_A_START, |Cut { missions: (first, latest), last, .. }| {
        names::ARCHIVE.of(data, &format!("missions-{first}-to-{latest}-{}", &last.hex()[..16]))
    })
}

/// Removes the unfinished files of killed programs from the folder `archives`, to which only this program writes. A
/// folder with such a name stays, which does no harm.
fn sweep(archives: &Path) -> std::io::Result<()> {
    for file in std::fs::read_dir(archives)? {
        let path = file?.path();
        if path.extension() == Some(UNFINISHED.as_ref()) {
            let _ = std::fs::remove_file(path);
        }
    }
    Ok(())
}

/// Moves as many missions as the bound allows into the file that `file` names. An existing file with exactly these
/// contents is used. Such a file was left by an earlier attempt, which was killed or found the journal locked before
/// it could change the journal.
pub(super) fn write_out_within(
    data: &Path,
    before: WallTime,
    now: WallTime,
    bound: Bound,
    file: impl Fn(&Cut) -> PathBuf,
) -> Result<Option<Archived>, Unreadable> {
    let folder = Folder::new(data);
    if folder.is_archive() {
        return Err(Unreadable(format!("{} is an archive already: name the folder of a journal with --data", data.display())));
    }
    let words = |fault: Fault| Unreadable(fault.words(data, Then::StartAgain));
    folder.check_journal().and_then(|()| folder.check_beside()).map_err(words)?;
    let _lock = folder.lock().map_err(words)?;
    let Some(reader) = connect::reader(&folder).map_err(words)? else { return Ok(None) };
    let cuts = cuts(&reader.connection, before).map_err(words)?;
    drop(reader);
    let Some(Cut { missions: (first, due), .. }) = cuts.last() else { return Ok(None) };
    let is_there = |cut: &&Cut| file(cut).symlink_metadata().is_ok();
    let Some(cut) = cuts.iter().rfind(is_there).or_else(|| cuts.iter().rfind(|cut| bound.takes(cut))) else {
        return Err(Unreadable(format!(
            "mission {first} is too large to be archived at a start: end hallsweep, and archive the mission with `hallsweep \
             journal archive`"
        )));
    };
    ready(&folder)?;
    let mut journal = connect::writer(&folder).map_err(words)?;
    let file = file(cut);
    if is_within(data, &file) {
        return Err(Unreadable(format!(
            "{} is inside a data folder, where hallsweep may overwrite it: choose a file in another folder",
            file.display()
        )));
    }
    let archived = Archived { left: due.0 - cut.missions.1.0, ..written(&folder, &journal, cut, &file)? };
    let gone = take_out(&folder, &mut journal, &archived, now).map_err(words)?;
    gone.iter().for_each(|picture| {
        // A photo that stays does no harm: no entry names it, and the archive has it too.
        let _ = std::fs::remove_file(folder.photo(picture));
    });
    // Gives the freed space back to the disk if possible. Otherwise the journal uses the space again.
    let _ = journal.execute_batch("VACUUM");
    Ok(Some(archived))
}

/// Whether `file` is inside this data folder, or inside another data folder. The folder `archives` does not count.
pub fn is_within(data: &Path, file: &Path) -> bool {
    let file = file.canonicalize().unwrap_or_else(|_| file.to_owned());
    let folder = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (Ok(folder), data) = (folder.canonicalize(), data.canonicalize().ok()) else { return false };
    let mut above = folder.ancestors().take_while(|above| !above.ends_with(names::ARCHIVES.written()));
    above.any(|above| data.as_deref() == Some(above) || names::JOURNAL.within(above).exists())
}

/// Fails unless the journal is sound, complete and of this version. Photos are checked later, when they are copied.
fn ready(folder: &Folder) -> Result<(), Unreadable> {
    let words = |fault: Fault| Unreadable(fault.words(folder.path(), Then::StartAgain));
    if marker::read(folder).map_err(words)?.is_some() {
        return Err(Unreadable(
            "the folder has a record of lost entries: start hallsweep once to process this record, then archive".to_owned(),
        ));
    }
    head::check(folder).map_err(words)?;
    let journal = sound_by(folder, check_entries)?;
    // The head file must be up to date: an old head file would name an entry that is about to leave the journal.
    chain::end(&journal).and_then(|end| head::write(folder, &end)).map_err(words)
}

/// Opens a journal or archive if it passes the check.
pub(super) fn sound(folder: &Folder) -> Result<Connection, Unreadable> {
    sound_by(folder, check)
}

fn sound_by(folder: &Folder, check: fn(&Connection, &Folder) -> Result<Findings, Fault>) -> Result<Connection, Unreadable> {
    let words = |fault: Fault| Unreadable(fault.words(folder.path(), Then::StartAgain));
    let none = || Unreadable(format!("there is no journal in {}: name its folder with --data", folder.path().display()));
    let connection = connect::reader(folder).map_err(words)?.ok_or_else(none)?.connection;
    let findings = check(&connection, folder).map_err(words)?;
    match findings.faults.first() {
        None => Ok(connection),
        Some(fault) => Err(Unreadable(format!(
            "{} has faults, and was not changed: {fault} (faults found: {})",
            folder.path().display(),
            findings.count
        ))),
    }
}

/// Returns the existing file, or writes a new one. A new file gets the name `file` only when it is complete on disk.
fn written(folder: &Folder, journal: &Connection, cut: &Cut, file: &Path) -> Result<Archived, Unreadable> {
    if file.symlink_metadata().is_ok() {
        let why = |Unreadable(why)| {
            Unreadable(format!("{} exists with other contents: move it away, or name another file ({why})", file.display()))
        };
        return checked(journal, cut, file).map_err(why);
    }
    let mut unfinished = file.as_os_str().to_owned();
    unfinished.push(format!(".{UNFINISHED}"));
    let unfinished = PathBuf::from(unfinished);
    files::create(&unfinished).map_err(|error| refused(file, &error.into()))?;
    let named = filled(folder, journal, cut.last.seq, &unfinished).and_then(|()| {
        std::fs::rename(&unfinished, file)?;
        Ok(sync_parent(file)?)
    });
    // The unfinished file can be removed, since the journal still has everything.
    let said = |fault: Fault| {
        if matches!(fault, Fault::Photo(_)) {
            Unreadable(format!("nothing was archived: {}", fault.words(folder.path(), Then::StartAgain)))
        } else {
            refused(file, &fault)
        }
    };
    let named = named.map_err(said).inspect_err(|_| drop(std::fs::remove_file(&unfinished)));
    named.and_then(|()| checked(journal, cut, file)).inspect_err(|_| drop(std::fs::remove_file(file)))
}

fn filled(folder: &Folder, journal: &Connection, last: Seq, file: &Path) -> Result<(), Fault> {
    copy(journal, file, Some(last), |archive| {
        archive.execute_batch(PICTURES)?;
        for (digest, media_type) in photos(archive)? {
            let photo = Pictures::Files(folder).read(archive, &Picture { digest, media_type })?;
            Pictures::Table.keep(archive, &photo)?;
        }
        Ok(())
    })?;
    Ok(File::open(file)?.sync_all()?)
}

/// Copies entries, pages and losses up to `last` into an empty file. Then rebuilds the other tables from them, and
/// runs `more`.
pub(super) fn copy<T>(
    from: &Connection,
    file: &Path,
    last: Option<Seq>,
    more: impl FnOnce(&Transaction<'_>) -> Result<T, Fault>,
) -> Result<T, Fault> {
    let mut to = Connection::open_with_flags(file, OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX)?;
    to.pragma_update(None, "synchronous", "FULL")?;
    // After an interruption the file is written anew, so it needs no rollback journal on disk.
    to.query_row("PRAGMA journal_mode = MEMORY", [], |_| Ok(()))?;
    schema::bring_up_to_date(&mut to)?;
    let last = last.map_or(Ok(i64::MAX), |last| whole(last.0))?;
    let transaction = to.transaction()?;
    for (table, columns, up_to) in [("events", 6, "seq <= ?1"), ("pages", 2, "last <= ?1"), ("losses", 2, "kept <= ?1")] {
        let mut statement = from.prepare(&format!("SELECT * FROM {table} WHERE {up_to}"))?;
        let mut rows = statement.query([last])?;
        let places = (1..=columns).map(|place| format!("?{place}")).collect::<Vec<_>>().join(", ");
        let mut insert = transaction.prepare(&format!("INSERT INTO {table} VALUES ({places})"))?;
        while let Some(row) = rows.next()? {
            let values: Vec<rusqlite::types::Value> = (0..columns).map(|column| row.get(column)).collect::<Result<_, _>>()?;
            insert.execute(rusqlite::params_from_iter(values))?;
        }
    }
    project::rebuild(&transaction)?;
    let more = more(&transaction)?;
    transaction.commit()?;
    to.close().map_err(|(_, error)| error)?;
    Ok(more)
}

/// Reads the archive again; returns its record when it is sound and begins and ends with the same pages as the journal.
pub(super) fn checked(journal: &Connection, cut: &Cut, file: &Path) -> Result<Archived, Unreadable> {
    let fault = |fault: Fault| refused(file, &fault);
    let archive = Folder::new(file);
    if !archive.is_archive() {
        return Err(Unreadable(format!("{} is not an archive", file.display())));
    }
    let archive = sound(&archive)?;
    let stretch = (chain::anchor(&archive).map_err(fault)?, chain::end(&archive).map_err(fault)?);
    if stretch != (chain::anchor(journal).map_err(fault)?, cut.last) {
        return Err(Unreadable(format!("{} differs from the journal", file.display())));
    }
    let photos: i64 =
        archive.query_row("SELECT count(*) FROM photos", [], |row| row.get(0)).map_err(|error| fault(error.into()))?;
    let digest = digest_of(file).map_err(|error| fault(error.into()))?;
    let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned();
    let what = WrittenOut { missions: cut.missions, until: cut.gone, file: name, digest };
    Ok(Archived { what, last: cut.last, photos: count(photos), left: 0 })
}

/// Deletes the archived entries and records that they were archived, in one transaction. Returns the photos that no
/// remaining entry names.
fn take_out(folder: &Folder, journal: &mut Connection, archived: &Archived, now: WallTime) -> Result<Vec<Picture>, Fault> {
    let before = photos(journal)?;
    let transaction = journal.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let last = rows::last_up_to(&transaction, None)?;
    let entry = Entry { wall: now, fact: Fact::WrittenOut(archived.what.clone()) };
    // The new entry belongs to no mission, even while a mission is under way.
    let page = Page { first: last.next(), entries: vec![entry], kept_back: None };
    pages::write(&transaction, Pictures::Files(folder), &page, None)?;
    let head = chain::close_page(&transaction)?;
    let gone = whole(archived.what.until.0)?;
    transaction.execute("DELETE FROM events WHERE seq <= ?1", params![gone])?;
    transaction.execute("DELETE FROM pages WHERE last < ?1", params![gone])?;
    transaction.execute("DELETE FROM losses WHERE kept < ?1", params![gone])?;
    project::rebuild(&transaction)?;
    let after = photos(&transaction)?;
    transaction.commit()?;
    // If this fails, the head file names an older entry, which the journal still has.
    let _ = head::write(folder, &head);
    Ok(before
        .difference(&after)
        .map(|(digest, media_type)| Picture { digest: digest.clone(), media_type: media_type.clone() })
        .collect())
}

pub(super) fn photos(connection: &Connection) -> Result<BTreeSet<(String, String)>, Fault> {
    let mut statement = connection.prepare("SELECT digest, media_type FROM photos")?;
    let photos = statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?;
    Ok(photos.collect::<Result<_, _>>()?)
}

pub(super) fn digest_of(file: &Path) -> std::io::Result<String> {
    let (mut file, mut hasher, mut buffer) = (File::open(file)?, Sha256::new(), vec![0; 64 * 1024]);
    loop {
        let read = file.read(&mut buffer)?;
        if read == 0 {
            return Ok(hex(&hasher.finalize()));
        }
        hasher.update(&buffer[..read]);
    }
}

pub(super) fn refused(file: &Path, fault: &Fault) -> Unreadable {
    if let Fault::File(error) = fault {
        return Unreadable(format!("{} cannot be used: {error}", file.display()));
    }
    Unreadable(format!("the archive {}: {}", file.display(), fault.words(file, Then::StartAgain)))
}
