//! Data for the doors (HTTP, CoAP, MQTT): photos, luggage, past missions and their entries. Each query has its own
//! connection. So it does not wait for another query, for the writer, or for a disk that cannot be written.

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use rusqlite::{Connection, OptionalExtension, Params, Row, params};

use super::connect::JournalReader;
use super::fault::{Fault, Then, count};
use super::folder::Folder;
use super::memory::{self, MemoryJournal, MemoryStore};
use super::photos::Pictures;
use super::rows::{self, EntryFilter, Kinds};
use super::{chain, connect, marker, moments, project, recall};
use crate::api::journal::{self, Picture};
use crate::runtime::archive::{Archive, At, Happened, Head, MissionRecord, NoTake, PastMoment, Sound, Span, Unreadable};
use hallsweep_core::command::{Note, Verdict};
use hallsweep_core::event::Photo;
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::{LuggageId, MissionId, Seq, WallTime};
use hallsweep_core::world::luggage::{Decision, Luggage};

/// Maximum number of idle connections kept for later queries: as many as are used at once in a busy moment.
const IDLE: usize = 4;

/// Number of last entries that are searched for a retrieval. A retrieval is the last part of a mission and takes some
/// hundreds of entries. The search takes milliseconds.
const SEARCHED: u64 = 20_000;

/// Columns of a mission, in the order in which `record` reads them.
const MISSION: &str = "SELECT id, strategy, began_ms, began_offset_s, archived_ms, archived_offset_s, phase, left_in_place,
    (SELECT count(*) FROM luggage WHERE mission = missions.id),
    (SELECT count(*) FROM luggage WHERE mission = missions.id AND verdict = 'danger'),
    EXISTS (SELECT 1 FROM (SELECT kind, body FROM events WHERE events.mission = missions.id ORDER BY seq LIMIT 16)
            WHERE kind = 'conditions' AND json_valid(body) AND body ->> 'exercise') FROM missions";

#[derive(Debug)]
pub(super) enum SqliteArchive {
    Folder { folder: Folder, idle: Mutex<Vec<JournalReader>> },
    Memory(Arc<MemoryJournal>),
}

impl SqliteArchive {
    pub(super) fn new(folder: Folder) -> SqliteArchive {
        SqliteArchive::Folder { folder, idle: Mutex::default() }
    }

    /// Runs a query; returns the default value while there is no journal.
    fn ask<T: Default>(&self, question: impl FnOnce(&Connection) -> Result<T, Fault>) -> Result<T, Unreadable> {
        let answer = match self {
            SqliteArchive::Folder { folder, idle } => ask_folder(folder, idle, question),
            SqliteArchive::Memory(journal) => journal.ask(question),
        };
        answer.map_err(|fault| self.unreadable(&fault))
    }

    fn unreadable(&self, fault: &Fault) -> Unreadable {
        Unreadable(fault.words(self.path(), Then::StartAgain))
    }

    fn happened(&self, connection: &Connection, which: EntryFilter) -> Result<Vec<Happened>, Fault> {
        let mut entries = Vec::new();
        rows::each(connection, which, |seq, line| {
            let entry = line.map(|line| line.entry).map_err(|fault| Unreadable(fault.words_of_an_entry(self.path())));
            entries.push((seq, entry));
            Ok(())
        })?;
        Ok(entries)
    }

    fn picture(&self, connection: &Connection, sql: &str, which: impl Params) -> Result<Option<Photo>, Fault> {
        let picture = |row: &Row<'_>| Ok(Picture { digest: row.get(0)?, media_type: row.get(1)? });
        let picture = connection.prepare_cached(sql)?.query_row(which, picture).optional()?;
        picture.map(|picture| self.pictures().read(connection, &picture)).transpose()
    }

    fn pictures(&self) -> Pictures<'_> {
        match self {
            SqliteArchive::Folder { folder, .. } => folder.pictures(),
            SqliteArchive::Memory(_) => Pictures::Table,
        }
    }

    /// The folder, for messages to an operator.
    fn path(&self) -> &Path {
        match self {
            SqliteArchive::Folder { folder, .. } => folder.path(),
            SqliteArchive::Memory(_) => MemoryJournal::place(),
        }
    }
}

fn ask_folder<T: Default>(
    folder: &Folder,
    idle: &Mutex<Vec<JournalReader>>,
    question: impl FnOnce(&Connection) -> Result<T, Fault>,
) -> Result<T, Fault> {
    // Even after a panic, the list of connections is complete.
    let idle = || idle.lock().unwrap_or_else(PoisonError::into_inner);
    let ready = idle().pop();
    let opened = ready.map_or_else(|| connect::reader(folder), |reader| Ok(Some(reader)))?;
    let Some(reader) = opened else { return Ok(T::default()) };
    let answer = question(&reader.connection)?;
    let mut idle = idle();
    if idle.len() < IDLE && !reader.is_still {
        idle.push(reader);
    }
    Ok(answer)
}

impl MemoryStore {
    pub fn archive(&self) -> Arc<dyn Archive> {
        Arc::new(SqliteArchive::Memory(Arc::clone(&self.journal)))
    }
}

/// SQLite cannot store numbers above the largest `i64`, so nothing is found for such a number.
impl Archive for SqliteArchive {
    fn photo(&self, luggage: LuggageId) -> Result<Option<Photo>, Unreadable> {
        let Ok(id) = i64::try_from(luggage.0) else { return Ok(None) };
        self.ask(|connection| {
            let sql = "SELECT digest, media_type FROM luggage JOIN photos ON digest = photo WHERE id = ?1";
            self.picture(connection, sql, params![id])
        })
    }

    fn take(&self, luggage: LuggageId, take: u32) -> Result<Option<Photo>, NoTake> {
        let Ok(id) = i64::try_from(luggage.0) else { return Ok(None) };
        let taken = self.ask(|connection| {
            let sql = "SELECT digest, media_type FROM takes JOIN photos ON digest = photo WHERE luggage = ?1 AND take = ?2";
            match self.picture(connection, sql, params![id, take]) {
                Err(spoilt @ Fault::Photo(_)) => Ok(Some(Err(spoilt.words(self.path(), Then::StartAgain)))),
                found => Ok(found?.map(Ok)),
            }
        });
        taken?.transpose().map_err(NoTake::Spoilt)
    }

    fn luggage(&self, luggage: LuggageId) -> Result<Option<Luggage>, Unreadable> {
        let Ok(id) = i64::try_from(luggage.0) else { return Ok(None) };
        self.ask(|connection| {
            let sql = "SELECT record, verdict, decided_by, decided_ms, decided_offset_s, note FROM luggage WHERE id = ?1";
            let mut statement = connection.prepare_cached(sql)?;
            let mut rows = statement.query([id])?;
            rows.next()?.map(|row| luggage_of(luggage, row)).transpose()
        })
    }

    fn missions(&self, before: Option<MissionId>, most: usize) -> Result<Vec<MissionRecord>, Unreadable> {
        self.ask(|connection| {
            let sql = format!("{MISSION} WHERE id < ?1 ORDER BY id DESC LIMIT ?2");
            let before = before.map_or(i64::MAX, |mission| i64::try_from(mission.0).unwrap_or(i64::MAX));
            let mut statement = connection.prepare_cached(&sql)?;
            let mut rows = statement.query(params![before, i64::try_from(most).unwrap_or(i64::MAX)])?;
            let mut missions = Vec::new();
            while let Some(row) = rows.next()? {
                missions.push(record(row)?);
            }
            Ok(missions)
        })
    }

    fn mission(&self, mission: MissionId) -> Result<Option<MissionRecord>, Unreadable> {
        let Ok(id) = i64::try_from(mission.0) else { return Ok(None) };
        self.ask(|connection| {
            let mut statement = connection.prepare_cached(&format!("{MISSION} WHERE id = ?1"))?;
            let mut rows = statement.query([id])?;
            rows.next()?.map(record).transpose()
        })
    }

    fn state(&self, mission: MissionId) -> Result<Option<Sound<PersistentState>>, Unreadable> {
        let Ok(id) = i64::try_from(mission.0) else { return Ok(None) };
        self.ask(|connection| {
            let sql = "SELECT archived_seq FROM missions WHERE id = ?1";
            let found = connection.prepare_cached(sql)?.query_row([id], |row| row.get::<_, Option<i64>>(0));
            let Some(archived) = found.optional()? else { return Ok(None) };
            if let (SqliteArchive::Memory(_), Some(_)) = (self, archived)
                && let Some(stood) = memory::standing_at_the_end(connection, mission)?
            {
                return Ok(Some(stood));
            }
            let words = |fault: &Fault| fault.words_of_an_entry(self.path());
            recall::standing_of(connection, mission, archived.map(|seq| Seq(count(seq))), words).map(Some)
        })
    }

    fn moments(&self, mission: MissionId, at: &[At]) -> Result<Vec<PastMoment>, Unreadable> {
        if i64::try_from(mission.0).is_err() {
            return Ok(Vec::new());
        }
        self.ask(|connection| moments::moments(connection, mission, at, |fault| fault.words_of_an_entry(self.path())))
    }

    fn entries(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable> {
        let Some(which) = EntryFilter::of(mission, span, most) else { return Ok(Vec::new()) };
        self.ask(|connection| self.happened(connection, which))
    }

    fn lines(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<(Seq, String)>, Unreadable> {
        let Some(which) = EntryFilter::of(mission, span, most) else { return Ok(Vec::new()) };
        self.ask(|connection| {
            let mut lines = Vec::new();
            rows::each(connection, which, |seq, line| {
                let unreadable = |fault: Fault| journal::unreadable(seq, &fault.words_of_an_entry(self.path()));
                lines.push((seq, line.map_or_else(unreadable, |line| journal::line(&line))));
                Ok(())
            })?;
            Ok(lines)
        })
    }

    fn head(&self, mission: MissionId, until: Seq) -> Result<Option<Head>, Unreadable> {
        if i64::try_from(mission.0).is_err() {
            return Ok(None);
        }
        self.ask(|connection| {
            let last = rows::last_of(connection, mission, Seq(until.0.min(i64::MAX.unsigned_abs())))?;
            last.map_or(Ok(None), |(seq, _)| chain::page_of(connection, seq))
        })
    }

    fn timeline(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable> {
        let Some(which) = EntryFilter::of(mission, span, most) else { return Ok(Vec::new()) };
        self.ask(|connection| self.happened(connection, EntryFilter { kinds: Kinds::Timeline, ..which }))
    }

    fn hand_overs(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable> {
        let Some(which) = EntryFilter::of(mission, span, most) else { return Ok(Vec::new()) };
        self.ask(|connection| self.happened(connection, EntryFilter { kinds: Kinds::HandOvers, ..which }))
    }

    fn lost_after(&self) -> Result<Option<Seq>, Unreadable> {
        match self {
            SqliteArchive::Folder { folder, .. } if !folder.is_archive() => {
                marker::read(folder).map_err(|fault| self.unreadable(&fault))
            }
            SqliteArchive::Folder { .. } | SqliteArchive::Memory(_) => Ok(None),
        }
    }

    fn retrieval(&self, mission: MissionId, most: usize) -> Result<Vec<Happened>, Unreadable> {
        if i64::try_from(mission.0).is_err() {
            return Ok(Vec::new());
        }
        self.ask(|connection| {
            let (after, kinds) = (rows::before_the_last(connection, Some(mission), SEARCHED)?, Kinds::Retrieval);
            let which = EntryFilter { after, mission: Some(mission), kinds, most: Some(most), ..EntryFilter::default() };
            self.happened(connection, which)
        })
    }
}

fn record(row: &Row<'_>) -> Result<MissionRecord, Fault> {
    let (id, strategy): (i64, String) = (row.get(0)?, row.get(1)?);
    let archived: Option<i64> = row.get(4)?;
    let offset: Option<i32> = row.get(5)?;
    Ok(MissionRecord {
        id: MissionId(count(id)),
        strategy: Arc::from(strategy),
        began: WallTime { unix_ms: row.get(2)?, offset_s: row.get(3)? },
        archived: archived.map(|unix_ms| WallTime { unix_ms, offset_s: offset.unwrap_or(0) }),
        phase: Arc::from(row.get::<_, String>(6)?),
        luggage: count(row.get(8)?),
        dangerous: count(row.get(9)?),
        left: project::left_in_place(&row.get::<_, String>(7)?),
        is_exercise: row.get(10)?,
    })
}

fn luggage_of(id: LuggageId, row: &Row<'_>) -> Result<Luggage, Fault> {
    let broken = |what: &dyn std::fmt::Display| Fault::Damaged(format!("the record of luggage #{id} cannot be read: {what}"));
    let record = journal::read_record(&row.get::<_, String>(0)?).map_err(|why| broken(&why))?;
    let verdict: Option<String> = row.get(1)?;
    let verdict = verdict.map(|name| match name.as_str() {
        "safe" => Ok(Verdict::Safe),
        "danger" => Ok(Verdict::Danger),
        other => Err(broken(&format!("its verdict is {other}"))),
    });
    let decision = |verdict| -> Result<Decision, Fault> {
        let wall = WallTime { unix_ms: row.get(3)?, offset_s: row.get(4)? };
        let note: Option<String> = row.get(5)?;
        let hot = record.verdict.as_ref().map(|decision| decision.hot).unwrap_or_default();
        Ok(Decision { verdict, who: Arc::from(row.get::<_, String>(2)?), wall, note: note.as_deref().and_then(Note::new), hot })
    };
    let verdict = verdict.transpose()?.map(decision).transpose()?;
    Ok(Luggage { verdict, ..record })
}
