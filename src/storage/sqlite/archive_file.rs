//! Archives: old missions of a journal in one file, a journal of its own with the photos in it. What is in one is a stretch of the chain:
//!
//! ```text
//!   journal   1 ─────────────── gone ─┬─ RESET, all that stands ─┬─ last ──────────────► head
//!   archive   1 ──────────────────────┼───────────────────────── last
//!   next                              gone ───────────────────────────────── …
//! ```
//! The page with which the last of its missions ends stands in both, since what stands afterwards follows from it; so each archive can be
//! folded by itself, and the next, or the journal, begins behind a page that is in the one before. Nothing leaves the journal before the archive is
//! on the disk, was read again and found sound, with the same digests.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use rusqlite::{Connection, OpenFlags, TransactionBehavior, params};
use sha2::{Digest, Sha256};

use super::check::check;
use super::fault::{Fault, Then, count, whole};
use super::folder::{Folder, sync_parent};
use super::photos::{PICTURES, Pictures};
use super::rows::{self, EntryFilter};
use super::{chain, connect, head, marker, pages, project, schema};
use crate::api::journal::{Line, Picture};
use crate::api::time::rfc3339;
use crate::runtime::archive::{Head, Unreadable, hex};
use crate::storage::files;
use hallsweep_core::effect::{Entry, Fact, Page, WrittenOut};
use hallsweep_core::units::{MissionId, Seq, WallTime};

/// What was written out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Archived {
    pub what: WrittenOut,
    /// The last entry in it, and the digest of its page.
    pub last: Head,
    pub photos: u64,
}

/// What goes into an archive.
pub(super) struct Plan {
    pub(super) missions: (MissionId, MissionId),
    /// The last entry that leaves the journal, and the last that is written out.
    pub(super) gone: Seq,
    pub(super) last: Seq,
}

/// Writes out all missions that were put away before `before`, oldest first and without a gap, into a new file, and takes them out of the journal.
/// The file is `file`, of the first and the last of them. `None` where there is none; nothing is changed then.
pub fn write_out(
    data: &Path,
    before: WallTime,
    now: WallTime,
    file: impl FnOnce(MissionId, MissionId) -> PathBuf,
) -> Result<Option<Archived>, Unreadable> {
    let folder = Folder::new(data);
    let words = |fault: Fault| Unreadable(fault.words(data, Then::StartAgain));
    folder.check_journal().and_then(|()| folder.check_beside()).map_err(words)?;
    let _lock = folder.lock().map_err(words)?;
    let Some(reader) = connect::reader(&folder).map_err(words)? else { return Ok(None) };
    let Some(plan) = plan(&reader.connection, before).map_err(words)? else { return Ok(None) };
    drop(reader);
    ready(&folder)?;
    let mut journal = connect::writer(&folder).map_err(words)?;
    let file = file(plan.missions.0, plan.missions.1);
    if is_within(data, &file) {
        return Err(Unreadable(format!(
            "{} would lie among the files of the data folder, some of which are written over: name one elsewhere",
            file.display()
        )));
    }
    let archived = written(&folder, &journal, &plan, &file)?;
    let gone = take_out(&folder, &mut journal, &archived, now).map_err(words)?;
    gone.iter().for_each(|picture| {
        // Whoever finds it later finds a photo that nothing names, and that is in the archive.
        let _ = std::fs::remove_file(folder.photo(picture));
    });
    // The room that is free now is given back where that can be done; else the journal takes it again.
    let _ = journal.execute_batch("VACUUM");
    Ok(Some(archived))
}

/// Whether a file lies in this folder itself, whose files have names and meanings.
pub fn is_within(data: &Path, file: &Path) -> bool {
    let file = file.canonicalize().unwrap_or_else(|_| file.to_owned());
    let folder = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    matches!((folder.canonicalize(), data.canonicalize()), (Ok(folder), Ok(data)) if folder == data)
}

/// The same into the folder `archives` of the data folder, with the missions and the moment in the name of the file.
pub fn write_out_within(data: &Path, before: WallTime, now: WallTime) -> Result<Option<Archived>, Unreadable> {
    let archives = data.join("archives");
    let moment: String = rfc3339(now).chars().take("2026-01-31T10:05:12".len()).filter(|sign| *sign != ':').collect();
    let name = |first, last| {
        // Where it cannot be made the file cannot either, and that is said.
        let _ = files::make_folder_within(&archives);
        archives.join(format!("missions-{first}-to-{last}-{moment}.hallsweep"))
    };
    write_out(data, before, now, name)
}

/// Makes a data folder of an archive, so that it can be served; it is a journal of its own from there on.
pub fn unpack(file: &Path, data: &Path) -> Result<u64, Unreadable> {
    let (archive, folder) = (Folder::new(file), Folder::new(data));
    let words = |fault: Fault| Unreadable(fault.words(data, Then::StartAgain));
    if !archive.is_archive() {
        return Err(Unreadable(format!("there is no archive {}", file.display())));
    }
    let is_left = [folder.head(), folder.marker()].iter().any(|file| file.path().exists());
    if folder.is_archive() || folder.has_journal().map_err(words)? || folder.has_photos() || is_left {
        return Err(Unreadable(format!("{} is not empty: name a folder that is not there yet with --data", data.display())));
    }
    let from = sound(&archive)?;
    let copied = || {
        folder.create_path()?;
        let _lock = folder.lock()?;
        for (digest, media_type) in photos(&from)? {
            let photo = Pictures::Table.read(&from, &Picture { digest, media_type })?;
            Pictures::Files(&folder).keep(&from, &photo)?;
        }
        let unfinished = folder.journal().with_extension("unfinished");
        // One that a kill left behind is none of anybody's; it is made here, so that it is private.
        let _ = std::fs::remove_file(&unfinished);
        drop(files::open(&unfinished, File::options().write(true).create_new(true))?);
        let entries = copy(&from, &unfinished, None, |_| Ok(()))?;
        std::fs::rename(&unfinished, folder.journal())?;
        files::sync_folder(folder.path())?;
        head::write(&folder, &chain::end(&from)?)?;
        Ok(entries)
    };
    copied().map_err(words)
}

/// Whether these archives and the journal hold one another: each has the page behind which the next begins, and is as it was written out.
/// What is wrong, a sentence each.
pub(super) fn held_together(journal: &Connection, archives: &[PathBuf]) -> Result<Vec<String>, Unreadable> {
    let words = |fault: Fault| Unreadable(fault.words(Path::new("the journal"), Then::StartAgain));
    let mut faults = Vec::new();
    let mut opened = Vec::new();
    for file in archives {
        match looked_at(file, &mut faults) {
            Ok(archive) => opened.push(archive),
            Err(Unreadable(why)) => faults.push(why),
        }
    }
    opened.sort_by_key(|archive| archive.begins.seq);
    // What was written out first is on record in what was written out later.
    let mut known = records(journal).map_err(words)?;
    let mut later = (chain::anchor(journal).map_err(words)?, "the journal".to_owned());
    for OpenArchive { begins, file, connection } in opened.into_iter().rev() {
        let shown = file.display().to_string();
        let digest = digest_of(file).map_err(|error| refused(file, &error.into()))?;
        let there = chain::page_of(&connection, later.0.seq).map_err(|fault| refused(file, &fault))?;
        if there != Some(later.0) {
            faults.push(format!("{} does not begin with what {shown} ends with: another archive stands between them", later.1));
        } else if !known.iter().any(|record| record.digest == digest) {
            faults.push(format!("{shown} was not written out of this journal, or was changed since: its SHA-256 is {digest}"));
        }
        known.extend(records(&connection).map_err(|fault| refused(file, &fault))?);
        later = (begins, shown);
    }
    Ok(faults)
}

/// An archive that can be read, and the page behind which it begins.
struct OpenArchive<'f> {
    begins: Head,
    file: &'f Path,
    connection: Connection,
}

/// Opens an archive, and says what is not sound in it.
fn looked_at<'f>(file: &'f Path, faults: &mut Vec<String>) -> Result<OpenArchive<'f>, Unreadable> {
    let archive = Folder::new(file);
    if !archive.is_archive() {
        return Err(Unreadable(format!("there is no archive {}", file.display())));
    }
    let looked = || {
        let reader = connect::reader(&archive)?.ok_or(Fault::Foreign)?;
        let found = check(&reader.connection, &archive)?.faults;
        Ok((found, chain::anchor(&reader.connection)?, reader.connection))
    };
    let (found, begins, connection) = looked().map_err(|fault| refused(file, &fault))?;
    faults.extend(found.into_iter().map(|fault| format!("{}: {fault}", file.display())));
    Ok(OpenArchive { begins, file, connection })
}

/// The stretch up to `seq` is in an archive, if that is on record: which.
pub(super) fn record_of(connection: &Connection, gone: Seq) -> Result<Option<WrittenOut>, Fault> {
    Ok(records(connection)?.into_iter().find(|record| record.until == gone))
}

fn records(connection: &Connection) -> Result<Vec<WrittenOut>, Fault> {
    let mut records = Vec::new();
    rows::each(connection, EntryFilter { kinds: rows::Kinds::WrittenOut, ..EntryFilter::default() }, |_, line| {
        if let Ok(Line { entry: Entry { fact: Fact::WrittenOut(record), .. }, .. }) = line {
            records.push(record);
        }
        Ok(())
    })?;
    Ok(records)
}

/// Fails unless the journal is sound, whole and of this version.
fn ready(folder: &Folder) -> Result<(), Unreadable> {
    let words = |fault: Fault| Unreadable(fault.words(folder.path(), Then::StartAgain));
    if marker::read(folder).map_err(words)?.is_some() {
        return Err(Unreadable(
            "something was said to be lost: start hallsweep once, so that it is taken back, then archive".to_owned(),
        ));
    }
    head::check(folder).map_err(words)?;
    let journal = sound(folder)?;
    // One that has stayed behind would name what goes now.
    chain::end(&journal).and_then(|end| head::write(folder, &end)).map_err(words)
}

/// A connection to a journal or archive that is sound.
fn sound(folder: &Folder) -> Result<Connection, Unreadable> {
    let words = |fault: Fault| Unreadable(fault.words(folder.path(), Then::StartAgain));
    let none = || Unreadable(format!("there is no journal in {}: name its folder with --data", folder.path().display()));
    let connection = connect::reader(folder).map_err(words)?.ok_or_else(none)?.connection;
    let findings = check(&connection, folder).map_err(words)?;
    match findings.faults.first() {
        None => Ok(connection),
        Some(fault) => Err(Unreadable(format!(
            "{} is not sound, and stays as it is: {fault} (faults found: {})",
            folder.path().display(),
            findings.count
        ))),
    }
}

/// What may go: up to the page with which the last of the old missions ends, as long as everything that stands follows on it.
pub(super) fn plan(journal: &Connection, before: WallTime) -> Result<Option<Plan>, Fault> {
    let sql = "SELECT id, archived_seq FROM missions ORDER BY id";
    let mut statement = journal.prepare(sql)?;
    let missions = statement.query_map([], |row| Ok((row.get::<_, i64>(0)?, row.get::<_, Option<i64>>(1)?)))?;
    let (mut first, mut found) = (None, None);
    for mission in missions {
        let (id, archived) = mission?;
        let Some(archived) = archived.map(|seq| Seq(count(seq))) else { break };
        let at: i64 = journal.query_row("SELECT at_ms FROM events WHERE seq = ?1", [whole(archived.0)?], |row| row.get(0))?;
        if at >= before.unix_ms {
            break;
        }
        let mission = MissionId(count(id));
        let first = *first.get_or_insert(mission);
        // Everything that stands goes on record with the emptied map, in the page with which a mission ends.
        let Some(page) = chain::page_of(journal, archived)? else { break };
        let standing = rows::last_standing(journal, Some(page.seq.next()))?;
        let gone = chain::page_before(journal, archived)?;
        if let (Some(gone), true) = (gone, standing > Some(archived)) {
            found = Some(Plan { missions: (first, mission), gone: gone.seq, last: page.seq });
        }
    }
    Ok(found)
}

/// Writes the file, which must not be there yet, and reads it again.
fn written(folder: &Folder, journal: &Connection, plan: &Plan, file: &Path) -> Result<Archived, Unreadable> {
    // It is made here, so that nobody else's is ever written into.
    let made = files::open(file, File::options().write(true).create_new(true));
    made.map_err(|error| refused(file, &error.into()))?;
    let written = filled(folder, journal, plan.last, file).map_err(|fault| refused(file, &fault));
    written.and_then(|()| checked(journal, plan, file)).inspect_err(|_| {
        // It is of no use to anybody, and the journal has all of it.
        let _ = std::fs::remove_file(file);
    })
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
    File::open(file)?.sync_all()?;
    Ok(sync_parent(file)?)
}

/// Copies entries, pages and losses into an empty or new file, up to `last`, and makes the other tables of them; how many entries.
fn copy(
    from: &Connection,
    file: &Path,
    last: Option<Seq>,
    more: impl FnOnce(&Connection) -> Result<(), Fault>,
) -> Result<u64, Fault> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_CREATE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let mut to = Connection::open_with_flags(file, flags)?;
    to.pragma_update(None, "synchronous", "FULL")?;
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
    more(&transaction)?;
    let entries: i64 = transaction.query_row("SELECT count(*) FROM events", [], |row| row.get(0))?;
    transaction.commit()?;
    to.close().map_err(|(_, error)| error)?;
    Ok(count(entries))
}

/// Reads the file again; what is on record of it when it is sound and ends with the page that the journal has there.
pub(super) fn checked(journal: &Connection, plan: &Plan, file: &Path) -> Result<Archived, Unreadable> {
    let archive = sound(&Folder::new(file))?;
    let of = |connection: &Connection| chain::page_of(connection, plan.last).map_err(|fault| refused(file, &fault));
    let (last, there) = (of(journal)?, of(&archive)?);
    let (Some(last), true) = (last, last == there) else {
        return Err(Unreadable(format!("{} does not hold what the journal does", file.display())));
    };
    let photos: i64 =
        archive.query_row("SELECT count(*) FROM photos", [], |row| row.get(0)).map_err(|error| refused(file, &error.into()))?;
    let digest = digest_of(file).map_err(|error| refused(file, &error.into()))?;
    let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned();
    let what = WrittenOut { missions: plan.missions, until: plan.gone, file: name, digest };
    Ok(Archived { what, last, photos: count(photos) })
}

/// Takes out what has left, and puts that on record, in one transaction; the photos that nothing names any more.
fn take_out(folder: &Folder, journal: &mut Connection, archived: &Archived, now: WallTime) -> Result<Vec<Picture>, Fault> {
    let before = photos(journal)?;
    let transaction = journal.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let last = rows::last_up_to(&transaction, None)?;
    let entry = Entry { wall: now, fact: Fact::WrittenOut(archived.what.clone()) };
    // It belongs to no mission, also where one is under way.
    let page = Page { first: last.next(), entries: vec![entry] };
    pages::write(&transaction, Pictures::Files(folder), &page, None)?;
    let head = chain::close_page(&transaction)?;
    let gone = whole(archived.what.until.0)?;
    transaction.execute("DELETE FROM events WHERE seq <= ?1", params![gone])?;
    transaction.execute("DELETE FROM pages WHERE last < ?1", params![gone])?;
    transaction.execute("DELETE FROM losses WHERE kept < ?1", params![gone])?;
    project::rebuild(&transaction)?;
    let after = photos(&transaction)?;
    transaction.commit()?;
    // Where this fails the file names what was there before, and still is.
    let _ = head::write(folder, &head);
    Ok(before
        .difference(&after)
        .map(|(digest, media_type)| Picture { digest: digest.clone(), media_type: media_type.clone() })
        .collect())
}

fn photos(connection: &Connection) -> Result<BTreeSet<(String, String)>, Fault> {
    let mut statement = connection.prepare("SELECT digest, media_type FROM photos")?;
    let photos = statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?;
    Ok(photos.collect::<Result<_, _>>()?)
}

fn digest_of(file: &Path) -> std::io::Result<String> {
    let (mut file, mut hasher, mut buffer) = (File::open(file)?, Sha256::new(), vec![0; 64 * 1024]);
    loop {
        let read = file.read(&mut buffer)?;
        if read == 0 {
            return Ok(hex(&hasher.finalize()));
        }
        hasher.update(&buffer[..read]);
    }
}

fn refused(file: &Path, fault: &Fault) -> Unreadable {
    if let Fault::File(error) = fault {
        return Unreadable(format!("{} cannot be used: {error}", file.display()));
    }
    Unreadable(format!("the archive {}: {}", file.display(), fault.words(file, Then::StartAgain)))
}
