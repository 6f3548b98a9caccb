//! Entries as rows of the table `events`: selects entries, and reads each as it was known when a given later entry
//! was written.

use rusqlite::types::Value;
use rusqlite::{Connection, OptionalExtension, Params, Row, params, params_from_iter};

use super::fault::{Fault, count, whole};
use crate::api::journal::{self, Line};
use crate::runtime::archive::Span;
use hallsweep_core::command::Verdict;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{LuggageId, MissionId, Seq, WallTime};

/// Columns of an entry, in the order in which `line` reads them.
const COLUMNS: &str = "seq, mission, at_ms, offset_s, kind, body";

/// Condition for commands with an id. It has exactly the words of the index, because SQLite would not use the index
/// with other words.
const NAMED: &str = "kind = 'command' AND iif(json_valid(body), body ->> 'id', NULL) IS NOT NULL";

/// Forces the use of the index: without it the query would scan every entry.
const BY_NAME: &str = "INDEXED BY named_commands";

/// Which entries to read; by default all. With the upper bound `before`, entries are read as they were known just
/// before this entry was written.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct EntryFilter {
    pub(super) after: Option<Seq>,
    pub(super) before: Option<Seq>,
    pub(super) mission: Option<MissionId>,
    pub(super) kinds: Kinds,
    pub(super) most: Option<usize>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kinds {
    #[default]
    All,
    Named,
    /// Entries from which the projections (the other tables) follow.
    Milestones,
    Verdicts,
    Retrieval,
    Timeline,
    /// Entries for the log that the console shows after a start, or for a past moment.
    Told,
    OfArchives,
    HandOvers,
    Temperatures,
    /// Entries that tell the path of the robot: its positions, and where a new path begins.
    Way,
}

impl Kinds {
    const fn condition(self) -> Option<&'static str> {
        match self {
            Kinds::All => None,
            Kinds::Named => Some(NAMED),
            Kinds::Milestones => {
                Some("kind IN ('standing', 'missionBegan', 'missionArchived', 'phase', 'luggage', 'verdict', 'unsure', 'judged', 'revealed', 'secured')")
            }
            Kinds::Verdicts => Some("kind IN ('verdict', 'standing')"),
            Kinds::Retrieval => Some("kind IN ('retrieval', 'holds', 'alarmRaised', 'alarmAcknowledged', 'secured', 'phase', 'clockSet')"),
            Kinds::Timeline => Some(
                "kind IN ('missionBegan', 'missionArchived', 'phase', 'holds', 'temperature', 'luggage', 'verdict', 'secured',
                 'alarmRaised', 'alarmAcknowledged', 'command', 'strategy', 'retrieval', 'programStarted', 'programEnded', 'conditions',
                 'clockSet', 'thermometerSilent')",
            ),
            Kinds::Told => Some(
                "kind IN ('command', 'missionBegan', 'missionArchived', 'phase', 'luggage', 'unsure', 'judged', 'revealed', 'verdict', 'alarmRaised',
                 'alarmAcknowledged', 'programEnded', 'clockSet')",
            ),
            Kinds::OfArchives => Some("kind IN ('writtenOut', 'unpacked')"),
            Kinds::HandOvers => Some("kind = 'handedOver'"),
            Kinds::Temperatures => Some("kind IN ('temperature', 'thermometerSilent', 'programStarted', 'clockSet')"),
            Kinds::Way => Some("kind IN ('pose', 'programStarted', 'missionBegan', 'mapEmptied', 'strategy')"),
        }
    }
}

/// Writes an entry; fails when its number exists already.
pub(super) fn insert(connection: &Connection, line: &Line) -> Result<(), Fault> {
    let sql = "INSERT INTO events (seq, mission, at_ms, offset_s, kind, body) VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
    let Line { seq, mission, entry: Entry { wall, fact }, picture } = line;
    let mission = mission.map(|mission| whole(mission.0)).transpose()?;
    let (kind, body) = (journal::kind(fact), journal::body(fact, picture.as_ref()));
    connection.prepare_cached(sql)?.execute(params![whole(seq.0)?, mission, wall.unix_ms, wall.offset_s, kind, body])?;
    Ok(())
}

pub(super) fn take_back(connection: &Connection, kept: Seq) -> Result<usize, Fault> {
    Ok(connection.execute("DELETE FROM events WHERE seq > ?1", [whole(kept.0)?])?)
}

/// The number of the last entry up to and including `most`; 0 when there is no such entry.
pub(super) fn last_up_to(connection: &Connection, most: Option<Seq>) -> Result<Seq, Fault> {
    let most = most.map_or(Ok(i64::MAX), |most| whole(most.0))?;
    let last: Option<i64> = connection.query_row("SELECT max(seq) FROM events WHERE seq <= ?1", [most], |row| row.get(0))?;
    Ok(Seq(count(last.unwrap_or(0))))
}

pub(super) fn first(connection: &Connection) -> Result<Option<Seq>, Fault> {
    let first: Option<i64> = connection.query_row("SELECT min(seq) FROM events", [], |row| row.get(0))?;
    Ok(first.map(|seq| Seq(count(seq))))
}

/// The last entry of a mission up to and including `most`.
pub(super) fn last_of(connection: &Connection, mission: MissionId, most: Seq) -> Result<Option<(Seq, WallTime)>, Fault> {
    one_of(connection, "mission = ?1 AND seq <= ?2 ORDER BY seq DESC", mission, most)
}

/// The first entry of a mission from `least` on, including `least`.
pub(super) fn first_of(connection: &Connection, mission: MissionId, least: Seq) -> Result<Option<(Seq, WallTime)>, Fault> {
    one_of(connection, "mission = ?1 AND seq >= ?2 ORDER BY seq", mission, least)
}

fn one_of(connection: &Connection, which: &str, mission: MissionId, bound: Seq) -> Result<Option<(Seq, WallTime)>, Fault> {
    let sql = format!("SELECT seq, at_ms, offset_s FROM events WHERE {which} LIMIT 1");
    let read = |row: &Row<'_>| Ok((Seq(count(row.get(0)?)), WallTime { unix_ms: row.get(1)?, offset_s: row.get(2)? }));
    let mut statement = connection.prepare_cached(&sql)?;
    Ok(statement.query_row([whole(mission.0)?, whole(bound.0)?], read).optional()?)
}

pub(super) fn last_standing(connection: &Connection, before: Option<Seq>) -> Result<Option<Seq>, Fault> {
    let sql = "SELECT seq FROM events WHERE kind = 'standing' AND seq < ?1 ORDER BY seq DESC LIMIT 1";
    let before = before.map_or(Ok(i64::MAX), |before| whole(before.0))?;
    place(connection, sql, [before])
}

/// The entry before the last `count` entries, of one mission or of all missions.
pub(super) fn before_the_last(connection: &Connection, mission: Option<MissionId>, count: u64) -> Result<Option<Seq>, Fault> {
    let sql = "SELECT seq FROM events WHERE mission = ?1 OR ?1 IS NULL ORDER BY seq DESC LIMIT 1 OFFSET ?2";
    let values = params![mission.map(|mission| whole(mission.0)).transpose()?, whole(count)?];
    place(connection, sql, values)
}

/// The latest entries of some kinds up to `written`, oldest first: at most `most` entries, searched among the last
/// `searched` entries.
pub(super) fn latest(
    connection: &Connection,
    kinds: Kinds,
    written: Seq,
    most: usize,
    searched: u64,
) -> Result<Vec<Entry>, Fault> {
    let wanted = kinds.condition().map(|condition| format!(" AND {condition}")).unwrap_or_default();
    let sql = format!("SELECT {COLUMNS} FROM events WHERE seq > ?1 AND seq <= ?2{wanted} ORDER BY seq DESC LIMIT {most}");
    let bounds = [whole(written.0.saturating_sub(searched))?, whole(written.0)?];
    let mut statement = connection.prepare_cached(&sql)?;
    let mut rows = statement.query(bounds)?;
    let mut latest = Vec::new();
    while let Some(row) = rows.next()? {
        // These entries are only shown, and nothing follows from them. So unreadable entries are skipped.
        latest.extend(line(connection, row, Some(written.next())).1.ok().map(|line| line.entry));
    }
    latest.reverse();
    Ok(latest)
}

/// The entry before the last `count` commands with an id, up to `written`; `None` when there are no more than `count`.
pub(super) fn before_the_last_named(connection: &Connection, written: Seq, count: u64) -> Result<Option<Seq>, Fault> {
    let sql = format!("SELECT seq FROM events {BY_NAME} WHERE {NAMED} AND seq <= ?1 ORDER BY seq DESC LIMIT 1 OFFSET ?2");
    place(connection, &sql, [whole(written.0)?, whole(count)?])
}

fn place(connection: &Connection, sql: &str, values: impl Params) -> Result<Option<Seq>, Fault> {
    let found: Option<i64> = connection.prepare_cached(sql)?.query_row(values, |row| row.get(0)).optional()?;
    Ok(found.map(|seq| Seq(count(seq))))
}

/// Visits entries, oldest first. For an entry that cannot be read, `visit` gets an error. Stops when `visit` fails.
pub(super) fn each(
    connection: &Connection,
    which: EntryFilter,
    mut visit: impl FnMut(Seq, Result<Line, Fault>) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let (sql, values) = which.query()?;
    let mut statement = connection.prepare_cached(&sql)?;
    let mut rows = statement.query(params_from_iter(values))?;
    while let Some(row) = rows.next()? {
        let (seq, line) = line(connection, row, which.before);
        visit(seq, line)?;
    }
    Ok(())
}

impl EntryFilter {
    /// Selects the entries of a mission; `None` when a number is too large for the store.
    pub(super) fn of(mission: MissionId, span: Span, most: usize) -> Option<EntryFilter> {
        i64::try_from(mission.0.max(span.after.0)).ok()?;
        let before = i64::try_from(span.until.0).is_ok().then(|| span.until.next());
        let (after, mission, most) = (Some(span.after), Some(mission), Some(most));
        Some(EntryFilter { after, before, mission, most, ..EntryFilter::default() })
    }

    fn query(self) -> Result<(String, Vec<Value>), Fault> {
        let bounds = [("seq > ?", self.after.map(|seq| seq.0)), ("seq < ?", self.before.map(|seq| seq.0))];
        let mission = [("mission = ?", self.mission.map(|mission| mission.0))];
        let given: Vec<_> = bounds.into_iter().chain(mission).filter_map(|(sql, number)| Some((sql, number?))).collect();
        let mut conditions: Vec<&str> = given.iter().map(|(sql, _)| *sql).collect();
        conditions.extend(self.kinds.condition());
        let filter = if conditions.is_empty() { String::new() } else { format!(" WHERE {}", conditions.join(" AND ")) };
        let limit = self.most.map(|most| format!(" LIMIT {most}")).unwrap_or_default();
        let values = given.iter().map(|(_, number)| whole(*number).map(Value::from)).collect::<Result<_, _>>()?;
        let index = if self.kinds == Kinds::Named { BY_NAME } else { "" };
        Ok((format!("SELECT {COLUMNS} FROM events {index}{filter} ORDER BY seq{limit}"), values))
    }
}

/// Reads the entry of a row, with its place. The entry is read as it was known before the entry `before`.
fn line(connection: &Connection, row: &Row<'_>, before: Option<Seq>) -> (Seq, Result<Line, Fault>) {
    // The place is the key of the table, which is a number even when other columns are damaged.
    let seq = Seq(row.get(0).map_or(0, count));
    (seq, understood(connection, row, seq, before))
}

fn understood(connection: &Connection, row: &Row<'_>, seq: Seq, before: Option<Seq>) -> Result<Line, Fault> {
    let mission: Option<i64> = row.get(1)?;
    let wall = WallTime { unix_ms: row.get(2)?, offset_s: row.get(3)? };
    let body = row.get_ref(5)?.as_str().map_err(|error| Fault::Damaged(format!("entry {seq} holds no text: {error}")))?;
    let (fact, picture) = journal::read_body(body).map_err(|why| Fault::Unparsed(seq, why))?;
    if row.get_ref(4)?.as_str().ok() != Some(journal::kind(&fact)) {
        return Err(Fault::Damaged(format!("entry {seq} has a wrong kind")));
    }
    // If the query fails, the entry is returned as it was written.
    let fact = fact.as_it_was(|luggage| was_dangerous(connection, luggage, seq, before).unwrap_or(false));
    Ok(Line { seq, mission: mission.map(|mission| MissionId(count(mission))), entry: Entry { wall, fact }, picture })
}

/// Whether a piece was found dangerous after the entry `after`. With `before`, only entries before this bound count.
fn was_dangerous(connection: &Connection, luggage: LuggageId, after: Seq, before: Option<Seq>) -> Result<bool, Fault> {
    let sql = "SELECT 1 FROM luggage WHERE id = ?1 AND verdict = 'danger'";
    let is_dangerous = connection.prepare_cached(sql)?.exists([whole(luggage.0)?])?;
    if !is_dangerous || before.is_none() {
        return Ok(is_dangerous);
    }
    // Only the entries tell when the piece was found dangerous. The entry comes within milliseconds of the verdict that it
    // overrides.
    let which = EntryFilter { after: Some(after), before, kinds: Kinds::Verdicts, ..EntryFilter::default() };
    let looked = each(connection, which, |_, line| {
        if line.is_ok_and(|line| says_danger(&line.entry.fact, luggage)) { Err(Fault::GivenUp) } else { Ok(()) }
    });
    match looked {
        Err(Fault::GivenUp) => Ok(true),
        looked => looked.map(|()| false),
    }
}

fn says_danger(fact: &Fact, of: LuggageId) -> bool {
    if let Fact::Verdict { luggage, verdict, .. } = fact {
        return *luggage == of && *verdict == Verdict::Danger;
    }
    matches!(fact, Fact::State(state) if state.luggage.iter().any(|piece| piece.id == of && piece.is_dangerous()))
}
