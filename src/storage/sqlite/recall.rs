//! Reads the stored state at a start. The state is computed from the last state snapshot and the entries after it
//! (safety R1).

use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;

use rusqlite::{Connection, ErrorCode};

use super::connect;
use super::fault::Fault;
use super::folder::Folder;
use super::kept_back;
use super::rows::{self, EntryFilter, Kinds};
use crate::runtime::archive::Sound;
use hallsweep_core::command::Strategy;
use hallsweep_core::engine::{IDS, Recalled, RememberedLine};
use hallsweep_core::snapshot::log::Tone;
use hallsweep_core::snapshot::said::Said;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{MissionId, Seq};

/// Number of entries that a start reads for the log: as many as a console shows without much scrolling.
const LATEST: usize = 60;

/// Number of last entries in which the `LATEST` ones are searched. Between two entries for the log, a robot may have
/// made many steps.
const LATEST_AMONG: u64 = 10_000;

/// Maximum number of sentences about the damage of one mission. Further damage is only counted.
const DAMAGES: usize = 8;

/// Maximum time that a start waits for SQLite's own check. It is enough for some 500 MB on a common disk.
/// `hallsweep journal check` has no limit.
const CHECK_PATIENCE: Duration = Duration::from_secs(5);

/// Reads the stored state and changes nothing; `None` when there is no state. Entries after `lost_after` were
/// declared lost before a kill, so they are ignored even if they exist.
pub(super) fn recall(folder: &Folder, lost_after: Option<Seq>) -> Result<Option<Recalled>, Fault> {
    let Some(connect::JournalReader { connection, .. }) = connect::reader(folder)? else { return Ok(None) };
    check_quickly(&connection)?;
    let written = rows::last_up_to(&connection, lost_after)?;
    if written == Seq(0) {
        return Ok(None);
    }
    let state = state(&connection, written)?;
    let commands = repeatable(&connection, written)?;
    let latest = latest(&connection, written)?;
    Ok(Some(Recalled { state, written, commands, kept_back: kept_back::read(folder), latest }))
}

pub(super) fn latest(connection: &Connection, written: Seq) -> Result<Vec<RememberedLine>, Fault> {
    let latest = rows::latest(connection, Kinds::Told, written, LATEST, LATEST_AMONG)?;
    Ok(latest.iter().map(remembered).collect())
}

fn remembered(entry: &Entry) -> RememberedLine {
    let is_refused = matches!(entry.fact, Fact::Command { refused: Some(_), .. });
    let quiet = if is_refused { Tone::Warning } else { Tone::Info };
    let tone = if matches!(entry.fact, Fact::AlarmRaised(..)) { Tone::Alarm } else { quiet };
    RememberedLine { wall: entry.wall, tone, said: Said::fact(&entry.fact) }
}

fn state(connection: &Connection, written: Seq) -> Result<PersistentState, Fault> {
    let mut state = PersistentState::first(Strategy::default());
    let before = Some(written.next());
    let after = rows::last_standing(connection, before)?.map(|seq| Seq(seq.0.saturating_sub(1)));
    rows::each(connection, EntryFilter { after, before, ..EntryFilter::default() }, |_, line| {
        state.apply(&line?.entry);
        Ok(())
    })?;
    Ok(state)
}

/// The state of a mission when the entry `before` put it away; without `before`, its present state. It is computed
/// from the entries that can be read. `words` turns faults into sentences.
pub(super) fn standing_of(
    connection: &Connection,
    mission: MissionId,
    before: Option<Seq>,
    words: impl Fn(&Fault) -> String,
) -> Result<Sound<PersistentState>, Fault> {
    let first = Sound { of: PersistentState::first(Strategy::default()), damage: Vec::new() };
    let from = sound_standing(connection, before)?.map(|seq| Seq(seq.0.saturating_sub(1)));
    go_on(connection, mission, first, from, before, words)
}

/// Continues the state `from` of a mission with the entries between the two bounds, as far as these entries can be
/// read.
pub(super) fn go_on(
    connection: &Connection,
    mission: MissionId,
    from: Sound<PersistentState>,
    after: Option<Seq>,
    before: Option<Seq>,
    words: impl Fn(&Fault) -> String,
) -> Result<Sound<PersistentState>, Fault> {
    let Sound { of: mut state, damage } = from;
    let mut damage = Damage { words, said: damage, more: 0 };
    rows::each(connection, EntryFilter { after, before, ..EntryFilter::default() }, |_, line| {
        let line = match line {
            Ok(line) => line,
            // SQLite itself fails, so nothing after this entry is known either.
            Err(fault @ Fault::Sql(_)) => return Err(fault),
            Err(fault) => {
                damage.say(&fault);
                return Ok(());
            }
        };
        let begun = state.under_way && state.mission == mission;
        // The phase after a mission is recorded just before the mission's end.
        if !(begun && line.mission != Some(mission) && matches!(line.entry.fact, Fact::Phase(_))) {
            state.apply(&line.entry);
        }
        Ok(())
    })?;
    Ok(Sound { of: state, damage: damage.all() })
}

/// The last readable state snapshot before `before`. The state is computed from there, without the entries that
/// cannot be read.
fn sound_standing(connection: &Connection, before: Option<Seq>) -> Result<Option<Seq>, Fault> {
    let mut from = rows::last_standing(connection, before)?;
    while let Some(seq) = from {
        let mut is_sound = false;
        let one = EntryFilter { after: Some(Seq(seq.0.saturating_sub(1))), before: Some(seq.next()), ..EntryFilter::default() };
        rows::each(connection, one, |_, line| {
            is_sound = line.is_ok();
            Ok(())
        })?;
        if is_sound {
            break;
        }
        from = rows::last_standing(connection, from)?;
    }
    Ok(from)
}

struct Damage<W> {
    words: W,
    said: Vec<String>,
    more: usize,
}

impl<W: Fn(&Fault) -> String> Damage<W> {
    fn say(&mut self, fault: &Fault) {
        if self.said.len() < DAMAGES {
            self.said.push((self.words)(fault));
        } else {
            self.more += 1;
        }
    }

    fn all(mut self) -> Vec<String> {
        if self.more > 0 {
            self.said.push(format!("{} more entries cannot be understood: `hallsweep journal check` lists them", self.more));
        }
        self.said
    }
}

/// The latest commands with an id, oldest first. The core remembers a fixed number of them, however old they are.
fn repeatable(connection: &Connection, written: Seq) -> Result<Vec<Entry>, Fault> {
    let mut commands = Vec::new();
    let after = rows::before_the_last_named(connection, written, IDS as u64)?;
    let before = Some(written.next());
    rows::each(connection, EntryFilter { after, before, kinds: Kinds::Named, ..EntryFilter::default() }, |_, line| {
        commands.push(line?.entry);
        Ok(())
    })?;
    Ok(commands)
}

/// SQLite's own check of the file structure. It is stopped without a finding if the file is too large for a start to
/// wait.
fn check_quickly(connection: &Connection) -> Result<(), Fault> {
    let handle = connection.get_interrupt_handle();
    let (checked, waiting) = mpsc::channel::<()>();
    let watch = std::thread::Builder::new().name("journal-check".to_owned()).spawn(move || {
        if waiting.recv_timeout(CHECK_PATIENCE) == Err(RecvTimeoutError::Timeout) {
            handle.interrupt();
        }
    });
    let found: Result<String, _> = connection.query_row("PRAGMA quick_check(1)", [], |row| row.get(0));
    drop(checked);
    // The interrupt handle must be gone before the connection is used again, so this waits for the thread. A thread
    // that could not start has no handle.
    let _ = watch.map(std::thread::JoinHandle::join);
    match found {
        Ok(found) if found == "ok" => Ok(()),
        Ok(found) => Err(Fault::Damaged(found)),
        Err(error) if error.sqlite_error_code() == Some(ErrorCode::OperationInterrupted) => {
            tracing::warn!("the journal is too large to be checked at every start: run `hallsweep journal check` regularly");
            Ok(())
        }
        Err(error) => Err(error.into()),
    }
}
