//! `hallsweep journal check`: checks that the file is sound, and that the entries are in order, readable and
//! unchanged. It also checks that the tables follow from the entries, and that every photo is there.

use rusqlite::Connection;
use rusqlite::types::Value;

use super::fault::{ALL, Fault, Then, count, one_line};
use super::folder::Folder;
use super::of_archives::Records;
use super::photos::PICTURES;
use super::rows::{self, EntryFilter};
use super::{chain, head, marker, project, recall, schema};
use crate::api::journal::Picture;
use crate::runtime::archive::Head;
use crate::storage::names;
use hallsweep_core::units::Seq;

/// Maximum number of listed findings. A journal with more findings needs a backup, not a longer list.
const LISTED: usize = 100;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// One sentence for each fault; at most the first 100.
    pub faults: Vec<String>,
    /// Number of faults, including faults that are not listed.
    pub count: u64,
    /// Observations that are not faults.
    pub notes: Vec<String>,
    pub entries: u64,
    pub photos: u64,
}

impl Findings {
    fn fault(&mut self, words: String) {
        self.count += 1;
        if self.faults.len() < LISTED {
            self.faults.push(words);
        }
    }
}

/// Checks everything in one read transaction, since a program may be writing to the journal.
pub(super) fn check(connection: &Connection, folder: &Folder) -> Result<Findings, Fault> {
    checked(connection, folder, pictures)
}

/// Checks everything except the photos, which may be many times larger than the entries.
pub(super) fn check_entries(connection: &Connection, folder: &Folder) -> Result<Findings, Fault> {
    checked(connection, folder, |_, _, _| Ok(()))
}

fn checked(
    connection: &Connection,
    folder: &Folder,
    pictures: fn(&Connection, &Folder, &mut Findings) -> Result<(), Fault>,
) -> Result<Findings, Fault> {
    let mut findings = Findings::default();
    // The head file is read before the journal. The journal may grow in between, but it is never behind its head
    // file.
    let head = if folder.is_archive() { None } else { Some(head::read(folder)) };
    let moment = connection.unchecked_transaction()?;
    structure(&moment, &mut findings)?;
    if findings.faults.is_empty() {
        as_made(&moment, folder, &mut findings)?;
        let (anew, unclear) = entries(&moment, folder, &mut findings)?;
        if unclear {
            findings.notes.push(advice(folder));
        } else {
            // The next start migrates the tables of an older format, so they are not compared.
            if schema::format(&moment)? == schema::Format::Current {
                projections(&moment, &anew, &mut findings)?;
            }
        }
        pictures(&moment, folder, &mut findings)?;
        if schema::format(&moment)? == schema::Format::Current {
            chain::check(&moment, |words| findings.fault(words))?;
            if let Some(head) = head {
                end(&moment, head, folder, &mut findings);
            }
        } else {
            findings.notes.push("the chain of digests begins when hallsweep is started with this journal".to_owned());
        }
    }
    Ok(findings)
}

/// Checks that the journal still has the entry that `journal.head` names.
fn end(connection: &Connection, head: Result<Option<Head>, Fault>, folder: &Folder, findings: &mut Findings) {
    let none = "the file journal.head is missing, so missing entries at the end cannot be detected; the next start makes the \
                file again";
    let lost = head.as_ref().map_or(Ok(()), |_| head::check(folder)).and_then(|()| marker::read(folder).map(drop));
    if let Err(fault @ Fault::Unusable(names::LOST, _)) = lost {
        findings.fault(fault.words(folder.path(), Then::StartAgain));
    }
    match head.and_then(|head| head.map(|head| head::is_held(connection, &head)).transpose()) {
        Ok(Some(())) => {}
        Ok(None) => findings.notes.push(none.to_owned()),
        Err(fault) => findings.fault(fault.words(folder.path(), Then::StartAgain)),
    }
}

fn structure(connection: &Connection, findings: &mut Findings) -> Result<(), Fault> {
    let mut statement = connection.prepare(&format!("PRAGMA integrity_check({LISTED})"))?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        let found: String = row.get(0)?;
        if found != "ok" {
            findings.fault(format!("the file is damaged: {}", one_line(&found)));
        }
    }
    Ok(())
}

fn as_made(connection: &Connection, folder: &Folder, findings: &mut Findings) -> Result<(), Fault> {
    if schema::format(connection)? == schema::Format::Current && tables(connection)? != tables(&expected(folder)?)? {
        findings.fault("the tables, indices or triggers differ from those that hallsweep makes".to_owned());
    }
    Ok(())
}

fn empty() -> Result<Connection, Fault> {
    let mut empty = Connection::open_in_memory()?;
    schema::bring_up_to_date(&mut empty)?;
    Ok(empty)
}

fn expected(folder: &Folder) -> Result<Connection, Fault> {
    let empty = empty()?;
    if folder.is_archive() {
        empty.execute_batch(PICTURES)?;
    }
    Ok(empty)
}

fn tables(connection: &Connection) -> Result<std::collections::BTreeSet<String>, Fault> {
    rows_of(connection, "(SELECT type, name, tbl_name, sql FROM sqlite_schema WHERE name NOT LIKE 'sqlite_%')")
}

/// Checks the order and contents of the entries. Returns the tables that follow from the entries, and whether some entries
/// cannot be read.
fn entries(connection: &Connection, folder: &Folder, findings: &mut Findings) -> Result<(Connection, bool), Fault> {
    let losses = losses(connection)?;
    let anew = empty()?;
    let (mut before, mut unclear) = (begins_behind(connection, folder, findings)?, false);
    rows::each(connection, EntryFilter::default(), |_, line| {
        findings.entries += 1;
        let line = match line {
            Ok(line) => line,
            Err(fault) => {
                unclear = true;
                findings.fault(fault.words_of_an_entry(folder.path()));
                before = before.next();
                return Ok(());
            }
        };
        if line.seq != before.next() {
            gap(before, line.seq, &losses, findings);
        }
        before = line.seq;
        project::project(&anew, &line)
    })?;
    Ok((anew, unclear))
}

fn begins_behind(connection: &Connection, folder: &Folder, findings: &mut Findings) -> Result<Seq, Fault> {
    if schema::format(connection)? != schema::Format::Current {
        return Ok(Seq(0));
    }
    let anchor = chain::anchor(connection)?;
    if anchor.seq == Seq(0) || rows::first(connection)? != Some(anchor.seq.next()) {
        return Ok(Seq(0));
    }
    let (digest, records) = (anchor.hex(), Records::of(connection)?);
    if folder.is_archive() {
        findings.notes.push(format!("the journal begins after entry {}, whose page has the digest {digest}", anchor.seq));
    } else if let Some(record) = records.unpacked(anchor) {
        findings.notes.push(format!(
            "the journal was unpacked from the archive {} (SHA-256 {}), and begins after entry {}, whose page has the digest \
             {digest}: `hallsweep journal check --archive FILE` compares the archive with the journal",
            record.file, record.digest, anchor.seq
        ));
    } else if let Some(record) = records.written_out(anchor.seq) {
        findings.notes.push(format!(
            "entries 1 to {} are in archives; the last archive is {} (SHA-256 {}), and its last page has the digest {digest}: \
             `hallsweep journal check --archive FILE` compares an archive with the journal",
            anchor.seq, record.file, record.digest
        ));
    } else {
        // No record explains why the first entries are missing, so they are reported as missing.
        return Ok(Seq(0));
    }
    Ok(anchor.seq)
}

/// Advice for a journal with unreadable entries. Who follows the advice loses no readable entry. The tables of such a
/// journal are not compared with the entries. The tables were built when all entries could be read, so they contain
/// more.
fn advice(folder: &Folder) -> String {
    let goes_on = marker::read(folder).and_then(|lost_after| recall::recall(folder, lost_after)).is_ok();
    let then = if goes_on {
        "hallsweep continues without these entries, so you need to do nothing".to_owned()
    } else {
        format!(
            "hallsweep cannot continue after these entries: end hallsweep, copy the whole folder {}, then replace the journal by \
             a backup, or move {ALL} away together to begin with an empty journal",
            folder.path().display()
        )
    };
    format!(
        "some entries cannot be understood, all others are sound (`hallsweep journal export` prints the sound entries): {then}; \
         do not run `hallsweep journal rebuild`, because the tables still have the data of these entries"
    )
}

fn gap(before: Seq, after: Seq, losses: &[Seq], findings: &mut Findings) {
    let which = format!("entries {} to {}", before.next(), after.0.saturating_sub(1));
    if losses.contains(&before) {
        findings.notes.push(format!("{which} were lost while the store could not write, and the loss was reported"));
    } else {
        findings.fault(format!("{which} are missing, and no recorded failure of the store explains the gap"));
    }
}

fn losses(connection: &Connection) -> Result<Vec<Seq>, Fault> {
    let mut statement = connection.prepare("SELECT kept FROM losses")?;
    let kept = statement.query_map([], |row| row.get::<_, i64>(0))?;
    Ok(kept.map(|kept| kept.map(|kept| Seq(count(kept)))).collect::<Result<_, _>>()?)
}

fn projections(connection: &Connection, anew: &Connection, findings: &mut Findings) -> Result<(), Fault> {
    for table in ["missions", "photos", "luggage", "takes"] {
        let (there, expected) = (rows_of(connection, table)?, rows_of(anew, table)?);
        let differing = there.iter().filter(|row| !expected.contains(*row)).count();
        let missing = expected.iter().filter(|row| !there.contains(*row)).count();
        if differing + missing > 0 {
            findings.fault(format!(
                "the table {table} does not match the entries of the journal ({differing} rows differ, {missing} are missing): \
                 end hallsweep and run `hallsweep journal rebuild`"
            ));
        }
    }
    Ok(())
}

fn rows_of(connection: &Connection, table: &str) -> Result<std::collections::BTreeSet<String>, Fault> {
    let mut statement = connection.prepare(&format!("SELECT * FROM {table}"))?;
    let columns = statement.column_count();
    let rows = statement.query_map([], |row| {
        let values: Vec<Value> = (0..columns).map(|column| row.get(column)).collect::<Result<_, _>>()?;
        Ok(format!("{values:?}"))
    })?;
    Ok(rows.collect::<Result<_, _>>()?)
}

fn pictures(connection: &Connection, folder: &Folder, findings: &mut Findings) -> Result<(), Fault> {
    let mut statement = connection.prepare("SELECT digest, media_type FROM photos")?;
    let pictures = statement.query_map([], |row| Ok(Picture { digest: row.get(0)?, media_type: row.get(1)? }))?;
    let kept = folder.pictures();
    for picture in pictures {
        let picture = picture?;
        findings.photos += 1;
        if let Err(fault) = kept.read(connection, &picture) {
            findings.fault(format!("photo {}: {}", picture.digest, fault.words(folder.path(), Then::StartAgain)));
        }
    }
    Ok(())
}
