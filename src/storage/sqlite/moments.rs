//! How a mission stood at moments of its past: what follows from the entries up to each of them, and what else a page shows of it.

use rusqlite::{Connection, OptionalExtension};

use super::fault::{Fault, count, whole};
use super::recall;
use super::rows::{self, Kinds};
use crate::runtime::archive::{At, PastMoment, Sound};
use hallsweep_core::engine::{Past, way_behind};
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::{MissionId, Seq, WallTime};

/// A reading among so many entries is looked for, which takes milliseconds.
const NOT_LONG: u64 = 20_000;

/// As many readings as tell what of each source was read last, and whether it had cooled down.
const READINGS: usize = 128;

/// Poses among which the way behind the robot is found: it stands in one cell while it turns.
const POSES: usize = 192;

/// What stood after an entry.
type Stood = (Seq, Sound<PersistentState>);

/// Such moments, in their order. What is the same in two of them, they share, as far as one follows from the other.
pub(super) fn moments(
    connection: &Connection,
    mission: MissionId,
    at: &[At],
    words: impl Fn(&Fault) -> String,
) -> Result<Vec<PastMoment>, Fault> {
    // All of it is read of the same journal, though somebody writes on.
    let _unchanging = connection.unchecked_transaction()?;
    let end = end_of(connection, mission)?;
    let mut places = Vec::new();
    for at in at {
        let Some(place) = place(connection, mission, *at, end)? else { return Ok(Vec::new()) };
        places.push(place);
    }
    let mut oldest_first: Vec<usize> = (0..places.len()).collect();
    oldest_first.sort_by_key(|place| places[*place].0);
    let (mut moments, mut before): (Vec<(usize, PastMoment)>, Option<Stood>) = (Vec::new(), None);
    for place in oldest_first {
        let (seq, wall) = places[place];
        let Some(state) = stood(connection, mission, seq, before, &words)? else { return Ok(Vec::new()) };
        before = Some((seq, state.clone()));
        moments.push((place, moment(connection, mission, (seq, wall), state, end)?));
    }
    moments.sort_by_key(|(place, _)| *place);
    Ok(moments.into_iter().map(|(_, moment)| moment).collect())
}

/// The last entry that tells of a mission. RESET empties the hall: what stands after it is the beginning of the next mission.
fn end_of(connection: &Connection, mission: MissionId) -> Result<Seq, Fault> {
    let sql = "SELECT archived_seq - 1 FROM missions WHERE id = ?1 AND archived_seq IS NOT NULL";
    let end = connection.prepare_cached(sql)?.query_row([whole(mission.0)?], |row| row.get(0)).optional()?;
    Ok(Seq(end.map_or(i64::MAX.unsigned_abs(), count)))
}

fn place(connection: &Connection, mission: MissionId, at: At, end: Seq) -> Result<Option<(Seq, WallTime)>, Fault> {
    match at {
        At::Entry(seq) => rows::last_of(connection, mission, seq.min(end)),
        At::Time(unix_ms) => by_time(connection, mission, unix_ms, [Seq(0), end]),
        At::TimeAmong(unix_ms, [least, most]) => by_time(connection, mission, unix_ms, [least, most.min(end)]),
    }
}

/// The last of some entries of a mission that is not later than this; the first, if all are. They are in the order of their times.
fn by_time(
    connection: &Connection,
    mission: MissionId,
    unix_ms: i64,
    [least, most]: [Seq; 2],
) -> Result<Option<(Seq, WallTime)>, Fault> {
    let Some(mut found) = rows::first_of(connection, mission, least)? else { return Ok(None) };
    let Some((last, _)) = rows::last_of(connection, mission, most)? else { return Ok(None) };
    let mut most = last.0;
    while found.0.0 < most {
        let middle = most - (most - found.0.0) / 2;
        match rows::first_of(connection, mission, Seq(middle))? {
            Some((seq, wall)) if wall.unix_ms <= unix_ms => found = (seq, wall),
            Some(_) | None => most = middle - 1,
        }
    }
    Ok(Some(found))
}

/// What stood after an entry, from what stood after one before it if that is shorter; nothing where what it follows from is not kept.
fn stood(
    connection: &Connection,
    mission: MissionId,
    seq: Seq,
    before: Option<Stood>,
    words: impl Fn(&Fault) -> String,
) -> Result<Option<Sound<PersistentState>>, Fault> {
    let end = Some(seq.next());
    let standing = rows::last_standing(connection, end)?;
    if let Some((known, state)) = before
        && standing <= Some(known)
    {
        return recall::go_on(connection, mission, state, (Some(known), end), words).map(Some);
    }
    if standing.is_none() && rows::first(connection)? > Some(Seq(1)) {
        return Ok(None);
    }
    recall::standing_of(connection, mission, end, words).map(Some)
}

fn moment(
    connection: &Connection,
    mission: MissionId,
    (seq, wall): (Seq, WallTime),
    state: Sound<PersistentState>,
    end: Seq,
) -> Result<PastMoment, Fault> {
    let Sound { of: state, damage } = state;
    let temperatures = rows::latest(connection, Kinds::Temperatures, seq, READINGS, NOT_LONG)?;
    let way = rows::latest(connection, Kinds::Way, seq, POSES, NOT_LONG)?;
    let past = Past { seq, state, trail: way_behind(&way), temperatures, latest: recall::latest(connection, seq)? };
    Ok(PastMoment {
        past: Sound { of: past, damage },
        wall,
        earlier: rows::last_of(connection, mission, Seq(seq.0.saturating_sub(1)))?.map(|(seq, _)| seq),
        later: rows::first_of(connection, mission, seq.next())?.map(|(seq, _)| seq).filter(|later| *later <= end),
    })
}
