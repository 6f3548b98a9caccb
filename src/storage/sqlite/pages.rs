//! The journal as the writer uses it. Many pages are written in one transaction, together with the projections
//! (tables that follow from the entries). Each page is written completely or not at all. `writer` decides when to
//! write and what to report.

use rusqlite::{Connection, Transaction, TransactionBehavior};

use super::fault::{Fault, whole};
use super::folder::{Folder, Identity, Lock};
use super::photos::Pictures;
use super::{chain, connect, marker, project, rows, schema};
use crate::api::journal::Line;
use crate::runtime::archive::Head;
use hallsweep_core::effect::Page;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{MissionId, Seq};

/// The only connection that writes, and the lock that allows it.
#[derive(Debug)]
pub(super) struct Pages {
    folder: Folder,
    connection: Connection,
    /// Mission of the next entry.
    under_way: Option<MissionId>,
    identity: Identity,
    lock: Lock,
}

impl Pages {
    /// Opens the journal for writing, or creates a journal. The number of the last entry, without entries that were
    /// declared lost, must equal `kept`.
    pub(super) fn open(folder: &Folder, lock: Option<Lock>, kept: Seq, under_way: Option<MissionId>) -> Result<Pages, Fault> {
        folder.has_journal()?;
        folder.create()?;
        let lock = lock.map_or_else(|| folder.lock(), Ok)?;
        let identity = folder.journal_identity()?;
        let mut connection = connect::writer(folder)?;
        schema::bring_up_to_date(&mut connection)?;
        let lost_after = marker::read(folder)?;
        if rows::last_up_to(&connection, lost_after)? != kept {
            return Err(Fault::Changed);
        }
        // Beginning a transaction shows whether the file can be written.
        connection.transaction_with_behavior(TransactionBehavior::Immediate)?.rollback()?;
        let mut pages = Pages { folder: folder.clone(), connection, under_way, identity, lock };
        // Entries that a killed program had declared lost are deleted durably before the mark is cleared (safety V3).
        if let Some(lost_after) = lost_after {
            pages.go_on_after(lost_after)?;
        }
        marker::clear(folder)?;
        let end = chain::end(&pages.connection)?.seq;
        if end == kept { Ok(pages) } else { Err(Fault::Unchained(end)) }
    }

    /// Writes pages durably. Before the commit it calls `is_wanted`, and rolls back when this returns false.
    pub(super) fn keep(&mut self, pages: &[Page], is_wanted: impl FnOnce() -> bool) -> Result<(), Fault> {
        self.is_in_place()?;
        let mut under_way = self.under_way;
        let transaction = self.connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        for page in pages {
            under_way = write(&transaction, Pictures::Files(&self.folder), page, under_way)?;
            chain::close_page(&transaction)?;
        }
        if !is_wanted() {
            return Err(Fault::GivenUp);
        }
        transaction.commit()?;
        self.under_way = under_way;
        Ok(())
    }

    pub(super) fn head(&self) -> Result<Head, Fault> {
        chain::end(&self.connection)
    }

    /// Fails if the journal or the lock file was replaced or removed since it was opened. Data written to a removed
    /// file is lost, and without the lock file a second hallsweep could write.
    fn is_in_place(&self) -> Result<(), Fault> {
        let gone = |error: &std::io::Error| error.kind() == std::io::ErrorKind::NotFound;
        match self.folder.journal_identity() {
            Ok(identity) if identity != self.identity => return Err(Fault::TakenAway("journal.db")),
            Err(Fault::File(error)) if gone(&error) => return Err(Fault::TakenAway("journal.db")),
            other => {
                other?;
            }
        }
        if self.lock.is_in_place() { Ok(()) } else { Err(Fault::TakenAway("journal.lock")) }
    }

    /// Proves that the journal can be written. Deletes the entries after `kept`, which were declared lost, and
    /// records this loss.
    pub(super) fn go_on_after(&mut self, kept: Seq) -> Result<(), Fault> {
        self.is_in_place()?;
        // On a small disk the write-ahead log may use the space that this transaction needs, so the log is emptied first.
        // If that fails, the transaction is still tried.
        let _ = self.connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
        let transaction = self.connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let sql = "INSERT INTO losses (kept, times) VALUES (?1, 1) ON CONFLICT (kept) DO UPDATE SET times = times + 1";
        transaction.execute(sql, [whole(kept.0)?])?;
        if rows::take_back(&transaction, kept)? > 0 {
            project::rebuild(&transaction)?;
            chain::take_back(&transaction, kept)?;
            // A page of a migrated journal may extend beyond `kept`. Its remaining entries need a new page.
            chain::close_page(&transaction)?;
        }
        let sql = "SELECT max(id) FROM missions WHERE archived_seq IS NULL";
        let under_way: Option<i64> = transaction.query_row(sql, [], |row| row.get(0))?;
        transaction.commit()?;
        self.under_way = under_way.map(|id| MissionId(super::fault::count(id)));
        // Without this checkpoint, repeated attempts could fill a disk that is nearly full.
        let _ = self.connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
        Ok(())
    }
}

/// Writes a page, photos first; returns the mission that is under way after the page.
pub(super) fn write(
    transaction: &Transaction<'_>,
    pictures: Pictures<'_>,
    page: &Page,
    mut under_way: Option<MissionId>,
) -> Result<Option<MissionId>, Fault> {
    for (place, entry) in page.entries.iter().enumerate() {
        let mission;
        (mission, under_way) = belongs(page, place, under_way);
        let photo = if let Fact::Luggage { photo, .. } = &entry.fact { photo.as_ref() } else { None };
        let picture = photo.map(|photo| pictures.keep(transaction, photo)).transpose()?;
        let line = Line { seq: Seq(page.first.0 + place as u64), mission, entry: entry.clone(), picture };
        rows::insert(transaction, &line)?;
        project::project(transaction, &line)?;
    }
    Ok(under_way)
}

/// The mission of an entry, and the mission under way after the entry. Entries that lead to the beginning of a
/// mission belong to the mission, such as the command that began it. The phase that follows a mission does not belong
/// to the mission, although this phase is recorded before the mission's end.
fn belongs(page: &Page, place: usize, under_way: Option<MissionId>) -> (Option<MissionId>, Option<MissionId>) {
    let (entry, rest) = (&page.entries[place], &page.entries[place..]);
    if let Fact::MissionArchived(mission, _) = &entry.fact {
        return (Some(*mission), None);
    }
    if let Some(begun) = begun(entry) {
        return (begun, begun);
    }
    let ahead = rest.iter().find_map(begun).flatten();
    let ends = rest.iter().any(|entry| matches!(entry.fact, Fact::MissionArchived(..)));
    let follows = ends && matches!(entry.fact, Fact::Phase(_));
    (under_way.filter(|_| !follows).or(ahead), under_way)
}

/// The mission under way after this entry. The outer `None` means that the entry does not change the mission.
fn begun(entry: &Entry) -> Option<Option<MissionId>> {
    if let Fact::MissionBegan(mission, _) = &entry.fact {
        return Some(Some(*mission));
    }
    if let Fact::State(state) = &entry.fact { Some(state.under_way.then_some(state.mission)) } else { None }
}
