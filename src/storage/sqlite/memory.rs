//! The store in memory: the journal of `schema` in an SQLite database without a file. The same code works with this
//! journal and with the journal on disk. Pages are stored at once, and are lost when the program ends. The size is
//! bounded, so that a robot may search for weeks.

use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rusqlite::{Connection, OptionalExtension, params};
use tokio::sync::watch;

use super::fault::{Fault, Then, whole};
use super::photos::{PICTURES, Pictures};
use super::{connect, pages, recall, schema};
use crate::api::journal;
use crate::runtime::archive::Sound;
use crate::runtime::store::{Store, StoreStatus};
use hallsweep_core::effect::Page;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{MissionId, Seq};

/// Maximum number of stored entries: some missions of a hall. All entries since the last state snapshot are stored in
/// any case, because the state is computed from them. The core bounds their number in proportion to the state.
pub(super) const ENTRIES: u64 = 16_384;

/// Maximum number of pieces whose photo is stored: more than a hall has. A photo has some 100 KB.
pub(super) const PHOTOS: u64 = 256;

/// Maximum number of earlier photos, stored for pieces that were photographed again.
pub(super) const EARLIER: u64 = 64;

/// Maximum number of stored luggage records: more than in a busy year. A record has about 400 bytes.
const RECORDS: u64 = 16_384;

/// Maximum number of stored missions, including the present one: as many as in a year at a quiet airport. A mission's
/// map has some 100 KB.
const MISSIONS: u64 = 256;

/// Additional table and indices of a journal in memory. The table has the state at the end of each mission, because
/// the entries of the mission may be deleted.
const TABLES: &str = "
    CREATE TABLE ended (mission INTEGER PRIMARY KEY, standing TEXT NOT NULL) STRICT;
    CREATE INDEX photographed ON luggage (id, photo) WHERE photo IS NOT NULL;
    CREATE INDEX luggage_of_photo ON luggage (photo) WHERE photo IS NOT NULL;";

/// Deletes some entries beyond the bound. The number exceeds the entries that a page adds, but it is small: deleting
/// all at once would delay a page.
const ENTRIES_GIVE_WAY: &str = "DELETE FROM events WHERE seq IN (SELECT seq FROM events WHERE seq <= ?1 ORDER BY seq LIMIT 32)";

/// Deletes data beyond the bounds after new data was added. It uses the indices above and does not scan all luggage.
/// The numbers of pieces have no gaps.
const GIVES_WAY: &str = "
    UPDATE luggage SET photo = NULL WHERE id IN (SELECT id FROM luggage INDEXED BY photographed
        WHERE photo IS NOT NULL ORDER BY id DESC LIMIT -1 OFFSET {PHOTOS});
    DELETE FROM luggage WHERE id <= (SELECT max(id) FROM luggage) - {RECORDS};
    DELETE FROM takes WHERE luggage NOT IN (SELECT id FROM luggage INDEXED BY photographed WHERE photo IS NOT NULL);
    DELETE FROM takes WHERE rowid IN (SELECT rowid FROM takes AS earlier
        WHERE take < (SELECT max(take) FROM takes WHERE luggage = earlier.luggage) ORDER BY rowid DESC LIMIT -1 OFFSET {EARLIER});
    DELETE FROM photos WHERE digest NOT IN (SELECT photo FROM luggage INDEXED BY photographed WHERE photo IS NOT NULL)
        AND digest NOT IN (SELECT photo FROM takes);
    DELETE FROM pictures WHERE digest NOT IN (SELECT digest FROM photos);
    DELETE FROM missions WHERE id <= (SELECT id FROM missions ORDER BY id DESC LIMIT 1 OFFSET {MISSIONS});
    DELETE FROM ended WHERE mission NOT IN (SELECT id FROM missions);";

/// Journal and photos, shared by all clones.
#[derive(Clone, Debug)]
pub struct MemoryStore {
    pub(super) journal: Arc<MemoryJournal>,
    word: watch::Sender<StoreStatus>,
}

/// The only connection to a database without a file.
#[derive(Debug)]
pub(super) struct MemoryJournal {
    writing: Mutex<Writing>,
    /// Only readers hold this lock, one at a time, so that the writer waits for one reader at most.
    turn: Mutex<()>,
}

#[derive(Debug)]
struct Writing {
    connection: Connection,
    /// Mission of the next entry.
    under_way: Option<MissionId>,
    standing: Seq,
}

impl Default for MemoryStore {
    fn default() -> MemoryStore {
        let connection = empty().expect("tests create these tables in an empty database in memory");
        let writing = Mutex::new(Writing { connection, under_way: None, standing: Seq(0) });
        let journal = Arc::new(MemoryJournal { writing, turn: Mutex::default() });
        MemoryStore { journal, word: watch::Sender::new(StoreStatus::default()) }
    }
}

impl MemoryStore {
    pub fn new() -> MemoryStore {
        MemoryStore::default()
    }
}

impl Store for MemoryStore {
    fn record(&mut self, page: Page, _losses: u64) {
        if self.word.borrow().failure.is_some() {
            return;
        }
        // Answers that are kept back need no place here: the core has them until the program ends.
        let kept = if page.entries.is_empty() { Ok(()) } else { self.journal.writing().keep(&page) };
        self.word.send_modify(|word| match kept {
            Ok(()) => {
                word.kept = page.last();
                word.kept_back = page.kept_back.as_ref().map_or(word.kept_back, |list| list.number);
            }
            Err(fault) => {
                word.failure = Some(Arc::from(fault.words(MemoryJournal::place(), Then::StartAgain)));
                word.losses += 1;
            }
        });
    }

    fn word(&self) -> watch::Receiver<StoreStatus> {
        self.word.subscribe()
    }
}

impl MemoryJournal {
    pub(super) fn place() -> &'static Path {
        Path::new("memory")
    }

    pub(super) fn ask<T>(&self, question: impl FnOnce(&Connection) -> Result<T, Fault>) -> Result<T, Fault> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        question(&self.writing().connection)
    }

    fn writing(&self) -> MutexGuard<'_, Writing> {
        // If a panic interrupted a write, its transaction was rolled back.
        self.writing.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Writing {
    fn keep(&mut self, page: &Page) -> Result<(), Fault> {
        let transaction = self.connection.transaction()?;
        let under_way = pages::write(&transaction, Pictures::Table, page, self.under_way)?;
        let (mut is_more, mut seq, mut standing) = (false, page.first, self.standing);
        for entry in &page.entries {
            if matches!(entry.fact, Fact::State(_)) {
                standing = seq;
            }
            if let Fact::MissionArchived(mission, _) = &entry.fact {
                remember_end(&transaction, *mission, seq)?;
            }
            is_more |= matches!(entry.fact, Fact::Luggage { .. } | Fact::MissionBegan(..) | Fact::State(_));
            seq = seq.next();
        }
        let past = page.last().0.saturating_sub(ENTRIES).min(standing.0.saturating_sub(1));
        transaction.prepare_cached(ENTRIES_GIVE_WAY)?.execute([whole(past)?])?;
        if is_more {
            transaction.execute_batch(&gives_way())?;
        }
        transaction.commit()?;
        (self.under_way, self.standing) = (under_way, standing);
        Ok(())
    }
}

/// The state at the end of a mission whose entries may be deleted. `None` for a journal on disk, and for a mission
/// that has not ended.
pub(super) fn standing_at_the_end(connection: &Connection, mission: MissionId) -> Result<Option<Sound<PersistentState>>, Fault> {
    let sql = "SELECT standing FROM ended WHERE mission = ?1";
    let body: Option<String> = connection.prepare_cached(sql)?.query_row([whole(mission.0)?], |row| row.get(0)).optional()?;
    let fact = body.map(|body| journal::read_body(&body)).transpose();
    match fact.map_err(|why| Fault::Damaged(why.to_string()))? {
        Some((Fact::State(standing), _)) => Ok(Some(Sound { of: *standing, damage: Vec::new() })),
        _ => Ok(None),
    }
}

fn remember_end(connection: &Connection, mission: MissionId, before: Seq) -> Result<(), Fault> {
    let words = |fault: &Fault| fault.words_of_an_entry(MemoryJournal::place());
    let standing = recall::standing_of(connection, mission, Some(before), words)?.of;
    let body = journal::body(&Fact::State(Box::new(standing)), None);
    connection.execute("INSERT OR REPLACE INTO ended VALUES (?1, ?2)", params![whole(mission.0)?, body])?;
    Ok(())
}

pub(super) fn gives_way() -> String {
    let bounds = [("{PHOTOS}", PHOTOS), ("{EARLIER}", EARLIER), ("{RECORDS}", RECORDS), ("{MISSIONS}", MISSIONS)];
    bounds.into_iter().fold(GIVES_WAY.to_owned(), |sql, (name, bound)| sql.replace(name, &bound.to_string()))
}

fn empty() -> Result<Connection, Fault> {
    let mut connection = Connection::open_in_memory()?;
    connection.set_prepared_statement_cache_capacity(connect::STATEMENTS);
    // Sorting uses no temporary files, so that nothing is written to a disk.
    connection.pragma_update(None, "temp_store", "MEMORY")?;
    schema::bring_up_to_date(&mut connection)?;
    connection.execute_batch(PICTURES)?;
    connection.execute_batch(TABLES)?;
    Ok(connection)
}
