//! The chain of digests. The digest of each page includes the digest of the page before. So a change, a removal or an
//! exchange of entries changes all later digests. It also changes the head, the digest of the last page. A report
//! names the head, and `journal.head` stores it.
//!
//! ```text
//!   32 zero bytes ──► page 1 ──► page 2 ──► … ──► head
//!                      digest = SHA-256(previous digest ‖ one line for each entry of the page)
//!                      line   = [seq,mission,atMs,offsetS,"kind","body"]⏎     JSON without spaces, the columns of `events`
//! ```
//! A journal of an older format gets pages for all its entries when it is migrated. The digests cover the columns as
//! they are stored, so that every later version computes the same digests.

use rusqlite::{Connection, OptionalExtension, Row, params};
use sha2::{Digest, Sha256};

use super::fault::{Fault, count, whole};
use super::rows;
use crate::runtime::archive::Head;
use hallsweep_core::units::Seq;

/// The head before the first page.
pub(super) const NOTHING: Head = Head { seq: Seq(0), digest: [0; 32] };

/// Columns of an entry, in the order in which they are hashed.
const COLUMNS: &str = "seq, mission, at_ms, offset_s, kind, body";

/// Closes a page over all entries after the end of the chain, if there are any; returns the new end.
pub(super) fn close_page(connection: &Connection) -> Result<Head, Fault> {
    close_page_at(connection, i64::MAX)
}

/// Adds entries from before the chain existed to the chain. Each mission gets one page, and its end gets another
/// page, so that old missions can be archived.
pub(super) fn close_old_pages(connection: &Connection) -> Result<(), Fault> {
    let sql = "SELECT seq - 1 FROM events WHERE kind = 'missionArchived' UNION SELECT seq FROM events WHERE kind = 'standing' ORDER BY 1";
    let mut statement = connection.prepare(sql)?;
    let ends: Vec<i64> = statement.query_map([], |row| row.get(0))?.collect::<Result<_, _>>()?;
    ends.into_iter().chain([i64::MAX]).try_for_each(|end| close_page_at(connection, end).map(drop))
}

fn close_page_at(connection: &Connection, last: i64) -> Result<Head, Fault> {
    let end = end(connection)?;
    let sql = format!("SELECT {COLUMNS} FROM events WHERE seq > ?1 AND seq <= ?2 ORDER BY seq");
    let mut statement = connection.prepare_cached(&sql)?;
    let mut rows = statement.query([whole(end.seq.0)?, last])?;
    let mut page = OpenPage::after(&end);
    while let Some(row) = rows.next()? {
        page.take(row)?;
    }
    if page.last == end.seq {
        return Ok(end);
    }
    let head = page.close();
    let sql = "INSERT INTO pages (last, digest) VALUES (?1, ?2)";
    connection.prepare_cached(sql)?.execute(params![whole(head.seq.0)?, head.digest])?;
    Ok(head)
}

pub(super) fn end(connection: &Connection) -> Result<Head, Fault> {
    let sql = "SELECT last, digest FROM pages ORDER BY last DESC LIMIT 1";
    Ok(connection.prepare_cached(sql)?.query_row([], head).optional()?.unwrap_or(NOTHING))
}

/// The page that contains the entry `seq`, or would contain it if it existed.
pub(super) fn page_of(connection: &Connection, seq: Seq) -> Result<Option<Head>, Fault> {
    let sql = "SELECT last, digest FROM pages WHERE last >= ?1 ORDER BY last LIMIT 1";
    Ok(connection.prepare_cached(sql)?.query_row([whole(seq.0)?], head).optional()?)
}

pub(super) fn page_before(connection: &Connection, seq: Seq) -> Result<Option<Head>, Fault> {
    let sql = "SELECT last, digest FROM pages WHERE last < ?1 ORDER BY last DESC LIMIT 1";
    Ok(connection.prepare_cached(sql)?.query_row([whole(seq.0)?], head).optional()?)
}

/// The last page before the first entry of the journal, if entries have left the journal.
pub(super) fn anchor(connection: &Connection) -> Result<Head, Fault> {
    let first = rows::first(connection)?.unwrap_or(Seq(1));
    if first == Seq(1) { Ok(NOTHING) } else { Ok(page_before(connection, first)?.unwrap_or(NOTHING)) }
}

/// Deletes the digests of all pages that end after `kept`; `rows::take_back` deletes the entries.
pub(super) fn take_back(connection: &Connection, kept: Seq) -> Result<(), Fault> {
    connection.execute("DELETE FROM pages WHERE last > ?1", [whole(kept.0)?])?;
    Ok(())
}

pub(super) fn check(connection: &Connection, mut say: impl FnMut(String)) -> Result<(), Fault> {
    let mut statement = connection.prepare(&format!("SELECT {COLUMNS} FROM events ORDER BY seq"))?;
    let mut entries = statement.query([])?;
    let mut entry = entries.next()?;
    let mut statement = connection.prepare("SELECT last, digest FROM pages ORDER BY last")?;
    let mut pages = statement.query([])?;
    let mut before = anchor(connection)?;
    while let Some(kept) = pages.next()?.map(head).transpose()? {
        if kept.seq <= before.seq {
            continue;
        }
        let mut page = OpenPage::after(&before);
        while let Some(row) = entry
            && place(row) <= kept.seq
        {
            page.take(row)?;
            entry = entries.next()?;
        }
        let which = format!("entries {} to {}", before.seq.next(), kept.seq);
        if page.last != kept.seq {
            say(format!("{which}: the last entry is missing, although the chain of digests names it"));
        } else if page.close() != kept {
            say(format!("{which} were changed, or do not follow the entries before them: their digest differs"));
        }
        before = kept;
    }
    if let Some(row) = entry {
        say(format!("the entries from {} on are in no page of the chain of digests, so another program wrote them", place(row)));
    }
    Ok(())
}

struct OpenPage {
    last: Seq,
    hasher: Sha256,
}

impl OpenPage {
    fn after(before: &Head) -> OpenPage {
        OpenPage { last: before.seq, hasher: Sha256::new().chain_update(before.digest) }
    }

    fn take(&mut self, row: &Row<'_>) -> Result<(), Fault> {
        let (mission, at_ms, offset_s): (Option<i64>, i64, i64) = (row.get(1)?, row.get(2)?, row.get(3)?);
        self.last = place(row);
        // Bytes that are not text are hashed too. Reading the entry finds the fault.
        let text = |column| row.get_ref(column).map(|value| String::from_utf8_lossy(value.as_bytes().unwrap_or_default()));
        let line = serde_json::to_string(&(self.last.0, mission, at_ms, offset_s, text(4)?, text(5)?));
        self.hasher.update(line.expect("numbers and texts are JSON"));
        self.hasher.update(b"\n");
        Ok(())
    }

    fn close(self) -> Head {
        Head { seq: self.last, digest: self.hasher.finalize().into() }
    }
}

/// Place of the entry in a row. It is the key of the table, and so it is a number even when other columns are
/// damaged.
fn place(row: &Row<'_>) -> Seq {
    Seq(row.get(0).map_or(0, count))
}

/// The head in a row. If its digest has a wrong length, which the program never writes, it is replaced by a digest
/// that matches nothing.
fn head(row: &Row<'_>) -> rusqlite::Result<Head> {
    let digest = row.get_ref(1)?.as_bytes().ok().and_then(|bytes| bytes.try_into().ok()).unwrap_or([0; 32]);
    Ok(Head { seq: Seq(count(row.get(0)?)), digest })
}
