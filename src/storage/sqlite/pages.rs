//! The journal as the writer holds it: pages go in, many in one transaction, each whole or not at all; with them the projections.
//! When that is done, and what is said about it, is the business of `writer`.

use rusqlite::{Connection, Transaction, TransactionBehavior};

use super::fault::{Fault, whole};
use super::folder::{Folder, Identity, Lock};
use super::photos::Pictures;
use super::{chain, connect, marker, project, rows, schema};
use crate::api::journal::Line;
use crate::runtime::archive::Head;
use hallsweep_core::effect::{Entry, Fact, Page};
use hallsweep_core::units::{MissionId, Seq};

/// The one connection that writes, and the right to do so.
#[derive(Debug)]
pub(super) struct Pages {
    folder: Folder,
    connection: Connection,
    /// The mission to which the next entry belongs.
    under_way: Option<MissionId>,
    identity: Identity,
    lock: Lock,
}

impl Pages {
    /// Opens the journal for writing, and creates it where there is none. Its last entry must be `kept`.
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
        // Whether anything can be written shows when it is begun.
        connection.transaction_with_behavior(TransactionBehavior::Immediate)?.rollback()?;
        let mut pages = Pages { folder: folder.clone(), connection, under_way, identity, lock };
        // What a program that was killed had said to be lost is taken back for good before that is forgotten (safety V3).
        if let Some(lost_after) = lost_after {
            pages.go_on_after(lost_after)?;
        }
        marker::clear(folder)?;
        let end = chain::end(&pages.connection)?.seq;
        if end == kept { Ok(pages) } else { Err(Fault::Unchained(end)) }
    }

    /// Writes pages so that they last. `is_wanted` is asked before the last step; when it says no nothing is kept.
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

    /// The end of the chain.
    pub(super) fn head(&self) -> Result<Head, Fault> {
        chain::end(&self.connection)
    }

    /// Whether the files are still the ones that were opened: what is written to a file that was taken away nobody finds again,
    /// and without its lock a second hallsweep could write.
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

    /// Proves that something can be written: takes back whatever came after `kept`, because it was said to be lost, and puts that
    /// loss on record.
    pub(super) fn go_on_after(&mut self, kept: Seq) -> Result<(), Fault> {
        self.is_in_place()?;
        // On a small disk the log itself may be what takes the room. Where this fails the log only grows.
        let _ = self.connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
        let transaction = self.connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let sql = "INSERT INTO losses (kept, times) VALUES (?1, 1) ON CONFLICT (kept) DO UPDATE SET times = times + 1";
        transaction.execute(sql, [whole(kept.0)?])?;
        if rows::take_back(&transaction, kept)? > 0 {
            project::rebuild(&transaction)?;
            chain::take_back(&transaction, kept)?;
            // A page of before the chain may have been longer.
            chain::close_page(&transaction)?;
        }
        let under_way = open_mission(&transaction)?;
        transaction.commit()?;
        self.under_way = under_way;
        // A disk that is all but full must not be filled by the attempts themselves.
        let _ = self.connection.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
        Ok(())
    }
}

fn open_mission(transaction: &Transaction<'_>) -> Result<Option<MissionId>, Fault> {
    let sql = "SELECT max(id) FROM missions WHERE archived_seq IS NULL";
    let id: Option<i64> = transaction.query_row(sql, [], |row| row.get(0))?;
    Ok(id.map(|id| MissionId(super::fault::count(id))))
}

/// Writes a page, photos first; the mission that is under way behind it.
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

/// The mission an entry belongs to, and the one under way behind it. What leads to a mission's beginning belongs to it, as the
/// command that began it; the phase that follows on a mission does not, although it is on record before the mission's end.
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

/// The mission that is under way from this entry on, where it says so.
fn begun(entry: &Entry) -> Option<Option<MissionId>> {
    if let Fact::MissionBegan(mission, _) = &entry.fact {
        return Some(Some(*mission));
    }
    if let Fact::State(state) = &entry.fact { Some(state.under_way.then_some(state.mission)) } else { None }
}
