//! The projections: tables of missions, luggage with its verdicts, and photos, which follow from the entries (safety
//! D2). They are written in the same transaction as the entries, and can be rebuilt from the entries at any time.

use rusqlite::{Connection, Params, params};

use super::fault::{Fault, count, whole};
use super::rows::{self, EntryFilter, Kinds};
use crate::api::journal::{self, Line, Picture};
use hallsweep_core::command::{Note, Strategy};
use hallsweep_core::state::fact::Fact;
use hallsweep_core::state::{PersistentState, Phase};
use hallsweep_core::units::{LuggageId, MissionId, Seq, WallTime};
use hallsweep_core::world::luggage::{Decision, Doubt, Luggage, PhotoState};

pub(super) fn project(connection: &Connection, line: &Line) -> Result<(), Fault> {
    let (seq, wall) = (line.seq, line.entry.wall);
    match &line.entry.fact {
        Fact::MissionBegan(mission, strategy) => began(connection, *mission, *strategy, wall),
        Fact::MissionArchived(mission, left) => archived(connection, *mission, left, wall, seq),
        Fact::Phase(phase) => line.mission.map_or(Ok(()), |mission| came_to(connection, mission, phase, wall)),
        Fact::Luggage { record, .. } => found(connection, line.mission, record, line.picture.as_ref()),
        Fact::Verdict { luggage, verdict, who, note, hot } => {
            let decision = Decision { verdict: *verdict, who: who.clone(), wall, note: note.clone(), hot: *hot };
            decided(connection, *luggage, &decision)
        }
        Fact::Judged(judgement) => {
            // An answer is listed once, even if the journal has it twice.
            let sql = "UPDATE luggage SET record = json_insert(record, '$.judged[#]', json(?2)) WHERE id = ?1
                       AND NOT EXISTS (SELECT 1 FROM json_each(record, '$.judged') WHERE json(value) = json(?2))";
            run(connection, sql, params![whole(judgement.luggage.0)?, journal::written_judgement(judgement)])
        }
        Fact::Unsure { luggage, who, note, hot } => {
            let doubt = Doubt { who: who.clone(), wall, note: note.clone(), hot: *hot };
            let sql = "UPDATE luggage SET record = json_insert(
                           iif(json_type(record, '$.unsure') IS NULL, json_set(record, '$.unsure', json('[]')), record),
                           '$.unsure[#]', json(?2)) WHERE id = ?1";
            run(connection, sql, params![whole(luggage.0)?, journal::written_doubt(&doubt)])?;
            let sql = "UPDATE luggage SET record = json_remove(record, '$.unsure[0]')
                       WHERE id = ?1 AND json_array_length(record, '$.unsure') > ?2";
            run(connection, sql, params![whole(luggage.0)?, whole(Luggage::MOST_REMEMBERED as u64)?])
        }
        Fact::Revealed { luggage, is_test } => {
            let sql = "UPDATE luggage SET record = json_set(record, '$.truth', json(?2)) WHERE id = ?1";
            run(connection, sql, params![whole(luggage.0)?, is_test.to_string()])
        }
        Fact::Secured(luggage) => {
            let sql = "UPDATE luggage SET record = json_set(record, '$.secured', json(?2)) WHERE id = ?1";
            run(connection, sql, params![whole(luggage.0)?, journal::moment(wall)])
        }
        Fact::State(state) => stands(connection, state, wall, seq),
        Fact::ProgramStarted(_)
        | Fact::Conditions(_)
        | Fact::ProgramEnded(_)
        | Fact::ClockSet(_)
        | Fact::WrittenOut(_)
        | Fact::Unpacked(_)
        | Fact::Command { .. }
        | Fact::Holds(_)
        | Fact::Epoch(_)
        | Fact::Goal(..)
        | Fact::Pose(_)
        | Fact::RobotPose(..)
        | Fact::Outside(..)
        | Fact::Retrieval(_)
        | Fact::MetAgain(..)
        | Fact::Led(_)
        | Fact::Obstacle(..)
        | Fact::Mark(..)
        | Fact::Closed(_)
        | Fact::HandedOver { .. }
        | Fact::SearchAgain(_)
        | Fact::AreasOrdered(_)
        | Fact::AreaClosed(..)
        | Fact::Temperature(..)
        | Fact::ThermometerSilent(_)
        | Fact::AlarmRaised(..)
        | Fact::AlarmAcknowledged(..)
        | Fact::Strategy(_)
        | Fact::MapEmptied(_) => Ok(()),
    }
}

/// Rebuilds all projections. Reads only the entries from which they follow; returns the number of entries read.
pub(super) fn rebuild(connection: &Connection) -> Result<u64, Fault> {
    connection.execute_batch("DELETE FROM takes; DELETE FROM luggage; DELETE FROM photos; DELETE FROM missions;")?;
    let mut entries = 0;
    rows::each(connection, EntryFilter { kinds: Kinds::Milestones, ..EntryFilter::default() }, |_, line| {
        entries += 1;
        project(connection, &line?)
    })?;
    Ok(entries)
}

pub(super) fn left_in_place(text: &str) -> Vec<LuggageId> {
    let numbers = text.trim_matches(['[', ']']).split(',');
    numbers.filter_map(|number| number.trim().parse().ok()).map(LuggageId).collect()
}

fn began(connection: &Connection, mission: MissionId, strategy: Strategy, wall: WallTime) -> Result<(), Fault> {
    let sql = "INSERT INTO missions (id, strategy, began_ms, began_offset_s, phase) VALUES (?1, ?2, ?3, ?4, 'idle')
               ON CONFLICT (id) DO UPDATE SET strategy = excluded.strategy";
    run(connection, sql, params![whole(mission.0)?, strategy.name(), wall.unix_ms, wall.offset_s])
}

fn archived(connection: &Connection, mission: MissionId, left: &[LuggageId], wall: WallTime, seq: Seq) -> Result<(), Fault> {
    let sql = "UPDATE missions SET archived_ms = ?2, archived_offset_s = ?3, archived_seq = ?4, left_in_place = ?5
               WHERE id = ?1 AND archived_seq IS NULL";
    let left: Vec<String> = left.iter().map(LuggageId::to_string).collect();
    let left = format!("[{}]", left.join(","));
    run(connection, sql, params![whole(mission.0)?, wall.unix_ms, wall.offset_s, whole(seq.0)?, left])
}

/// Records the phase of a mission. The first phase is recorded just before the mission's beginning, so this may also
/// add the mission. The entry of the beginning then adds the strategy.
fn came_to(connection: &Connection, mission: MissionId, phase: &Phase, wall: WallTime) -> Result<(), Fault> {
    let sql = "INSERT INTO missions (id, strategy, began_ms, began_offset_s, phase) VALUES (?1, ?2, ?3, ?4, ?5)
               ON CONFLICT (id) DO UPDATE SET phase = excluded.phase WHERE archived_seq IS NULL";
    let (strategy, phase) = (Strategy::default().name(), phase.name().name());
    run(connection, sql, params![whole(mission.0)?, strategy, wall.unix_ms, wall.offset_s, phase])
}

/// Records a piece of luggage, or another photo of it. Without a new photo the earlier photo stays.
fn found(connection: &Connection, mission: Option<MissionId>, record: &Luggage, picture: Option<&Picture>) -> Result<(), Fault> {
    if let (Some(picture), PhotoState::Taken { bytes, take }) = (picture, &record.photo) {
        let sql = "INSERT INTO photos (digest, media_type, bytes) VALUES (?1, ?2, ?3) ON CONFLICT (digest) DO NOTHING";
        run(connection, sql, params![picture.digest, picture.media_type, whole(*bytes as u64)?])?;
        let sql = "INSERT INTO takes (luggage, take, photo) VALUES (?1, ?2, ?3)
                   ON CONFLICT (luggage, take) DO UPDATE SET photo = excluded.photo";
        run(connection, sql, params![whole(record.id.0)?, take, picture.digest])?;
    }
    let sql = "INSERT INTO luggage (id, mission, record, photo) VALUES (?1, ?2, ?3, ?4) ON CONFLICT (id) DO UPDATE
               SET record = excluded.record, photo = coalesce(excluded.photo, photo)";
    let mission = mission.map(|mission| whole(mission.0)).transpose()?;
    let text = journal::record(&Luggage { verdict: None, clock_set_ms: 0, ..record.clone() });
    run(connection, sql, params![whole(record.id.0)?, mission, text, picture.map(|picture| &picture.digest)])
}

fn decided(connection: &Connection, luggage: LuggageId, decision: &Decision) -> Result<(), Fault> {
    let sql = "UPDATE luggage SET verdict = ?2, decided_by = ?3, decided_ms = ?4, decided_offset_s = ?5, note = ?6
               WHERE id = ?1";
    let Decision { verdict, who, wall, note, hot } = decision;
    let note = note.as_ref().map(Note::text);
    run(connection, sql, params![whole(luggage.0)?, verdict.name(), &**who, wall.unix_ms, wall.offset_s, note])?;
    if hot.is_empty() {
        return Ok(());
    }
    // The columns have no place for the answers to the three questions.
    let sql = "UPDATE luggage SET record = json_set(record, '$.verdict', json(?2)) WHERE id = ?1";
    run(connection, sql, params![whole(luggage.0)?, journal::written_decision(decision)])
}

/// Applies a state snapshot. A snapshot repeats facts whose own entries may have been lost in a failure of the store:
/// the beginning of a mission, the end of the previous mission, and luggage.
fn stands(connection: &Connection, state: &PersistentState, wall: WallTime, seq: Seq) -> Result<(), Fault> {
    let current = state.under_way.then_some(state.mission);
    let mut statement = connection.prepare_cached("SELECT id FROM missions WHERE archived_seq IS NULL")?;
    let ids = statement.query_map([], |row| row.get::<_, i64>(0))?.collect::<Result<Vec<_>, _>>()?;
    for open in ids.into_iter().map(|id| MissionId(count(id))).filter(|open| Some(*open) != current) {
        archived(connection, open, &[], wall, seq)?;
    }
    let Some(mission) = current else { return Ok(()) };
    began(connection, mission, state.strategy, wall)?;
    came_to(connection, mission, &state.phase, wall)?;
    for record in state.luggage.iter() {
        found(connection, current, record, None)?;
        record.verdict.as_ref().map_or(Ok(()), |decision| decided(connection, record.id, decision))?;
    }
    Ok(())
}

fn run(connection: &Connection, sql: &str, values: impl Params) -> Result<(), Fault> {
    connection.prepare_cached(sql)?.execute(values)?;
    Ok(())
}
