//! The state of a mission at moments in its past, computed from the entries up to each moment. A moment also has the
//! other data that a page of the console shows, such as temperatures.

use rusqlite::{Connection, OptionalExtension};

use super::fault::{Fault, count, whole};
use super::recall;
use super::rows::{self, Kinds};
use crate::runtime::archive::{At, PastMoment, Sound};
use hallsweep_core::engine::{Past, way_behind};
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::{MissionId, Seq, WallTime};

/// Number of last entries searched for a temperature reading; the search takes milliseconds.
const NOT_LONG: u64 = 20_000;

/// Number of readings that is enough to know the latest reading of each source, and whether the hall had cooled down.
const READINGS: usize = 128;

/// Number of last poses from which the path of the robot is computed. A cell has several poses when the robot turns
/// in it.
const POSES: usize = 192;

type Stood = (Seq, Sound<PersistentState>);

/// The states at the given moments, in order. If one state follows from another, the two share their equal parts.
pub(super) fn moments(
    connection: &Connection,
    mission: MissionId,
    at: &[At],
    words: impl Fn(&Fault) -> String,
) -> Result<Vec<PastMoment>, Fault> {
    // One transaction, so that all queries see the same journal while somebody writes to it.
    let _unchanging = connection.unchecked_transaction()?;
    // The last entry of the mission. RESET empties the hall, so the state after it belongs to the next mission.
    let sql = "SELECT archived_seq - 1 FROM missions WHERE id = ?1 AND archived_seq IS NOT NULL";
    let end = connection.prepare_cached(sql)?.query_row([whole(mission.0)?], |row| row.get(0)).optional()?;
    let end = Seq(end.map_or(i64::MAX.unsigned_abs(), count));
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
        moments.push((place, moment(connection, mission, seq, wall, state, end)?));
    }
    moments.sort_by_key(|(place, _)| *place);
    Ok(moments.into_iter().map(|(_, moment)| moment).collect())
}

fn place(connection: &Connection, mission: MissionId, at: At, end: Seq) -> Result<Option<(Seq, WallTime)>, Fault> {
    match at {
        At::Entry(seq) => rows::last_of(connection, mission, seq.min(end)),
        At::Time(unix_ms) => by_time(connection, mission, unix_ms, [Seq(0), end]),
        At::TimeAmong(unix_ms, [least, most]) => by_time(connection, mission, unix_ms, [least, most.min(end)]),
    }
}

/// The last entry of a mission that is not later than the given time; the first entry if all are later. Entries are ordered by
/// time.
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

/// The state after the entry `seq`. It is computed from the earlier state `before`, unless a state snapshot came
/// between the two. `None` when the needed entries are deleted.
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
        return recall::go_on(connection, mission, state, Some(known), end, words).map(Some);
    }
    if standing.is_none() && rows::first(connection)? > Some(Seq(1)) {
        return Ok(None);
    }
    recall::standing_of(connection, mission, end, words).map(Some)
}

fn moment(
    connection: &Connection,
    mission: MissionId,
    seq: Seq,
    wall: WallTime,
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
