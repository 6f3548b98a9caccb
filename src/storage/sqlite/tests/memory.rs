//! The store in memory: what it returns, and what it deletes when a bound is exceeded.

use std::sync::Arc;

use rusqlite::{Connection, StatementStatus};

use super::super::MemoryStore;
use super::super::memory::{EARLIER, ENTRIES, PHOTOS, gives_way};
use super::super::rows::{self, EntryFilter};
use super::testing::{photo, taken};
use crate::runtime::archive::{At, Span};
use crate::runtime::store::Store;
use hallsweep_core::command::{Strategy, Verdict};
use hallsweep_core::effect::Page;
use hallsweep_core::event::Photo;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::state::{PersistentState, Phase};
use hallsweep_core::units::{Cell, LuggageId, MissionId, Pose, Seq, WallTime};
use hallsweep_core::world::luggage::{Luggage, PhotoState};

fn phase() -> Entry {
    Entry { wall: WallTime::default(), fact: Fact::Phase(Phase::Exploring) }
}

fn standing() -> Entry {
    Entry { wall: WallTime::default(), fact: Fact::State(Box::new(PersistentState::first(Strategy::Snail))) }
}

fn luggage(id: u64, photo: Result<&str, &str>) -> Entry {
    let photo = photo.map(|text| Photo { bytes: text.as_bytes().into(), media_type: "image/png" }).map_err(str::to_owned);
    let (cell, pose, taken) = (Cell::new(0, 1), Pose::START, WallTime::default());
    let state = PhotoState::after(None, &photo);
    let record = Arc::new(Luggage {
        id: LuggageId(id),
        cell,
        pose,
        taken,
        first_taken: taken,
        photo: state,
        verdict: None,
        seen_from: Vec::new(),
        unsure: Vec::new(),
        judged: Vec::new(),
        truth: None,
        piece: None,
        secured: None,
        clock_set_ms: 0,
    });
    Entry { wall: taken, fact: Fact::Luggage { record, photo: photo.ok() } }
}

fn entries(memory: &MemoryStore) -> Vec<(Seq, Entry)> {
    let mut entries = Vec::new();
    let all = |connection: &Connection| {
        rows::each(connection, EntryFilter::default(), |seq, line| {
            entries.push((seq, line?.entry));
            Ok(())
        })
    };
    memory.journal.ask(all).expect("it is in memory");
    entries
}

fn kept(memory: &MemoryStore) -> Seq {
    memory.word().borrow().kept
}

fn record(memory: &mut MemoryStore, entries: impl IntoIterator<Item = Entry>) {
    for entry in entries {
        let next = kept(memory).next();
        memory.record(Page { first: next, entries: vec![entry], kept_back: None }, 0);
    }
}

#[test]
fn what_is_recorded_is_kept_at_once() {
    let mut memory = MemoryStore::new();
    assert_eq!(kept(&memory), Seq(0));
    record(&mut memory, [phase(), phase()]);
    assert_eq!(kept(&memory), Seq(2));
    assert_eq!(entries(&memory), [(Seq(1), phase()), (Seq(2), phase())]);
}

#[test]
fn every_clone_sees_the_newest_photo_of_a_piece() {
    let mut memory = MemoryStore::new();
    let archive = memory.archive();
    assert_eq!(archive.photo(LuggageId(1)), Ok(None));
    record(&mut memory, [luggage(1, Ok("first")), luggage(2, Err("dark")), luggage(1, Ok("again"))]);
    assert_eq!(archive.photo(LuggageId(1)).unwrap().map(|photo| photo.bytes), Some(b"again".as_slice().into()));
    assert_eq!(archive.photo(LuggageId(2)), Ok(None), "a failed photo is none");
}

#[test]
fn a_piece_is_found_with_its_verdict_whatever_mission_it_was_of() {
    let mut memory = MemoryStore::new();
    let verdict = Fact::Verdict {
        luggage: LuggageId(1),
        verdict: Verdict::Safe,
        who: "operator".into(),
        note: None,
        hot: Default::default(),
    };
    record(&mut memory, [luggage(1, Ok("first")), Entry { wall: WallTime::default(), fact: verdict }, luggage(2, Err("dark"))]);
    let first = memory.archive().luggage(LuggageId(1)).unwrap().expect("the first piece is kept");
    assert_eq!((first.verdict_name(), first.has_photo()), ("safe", true));
    assert_eq!(memory.archive().luggage(LuggageId(2)).unwrap().map(|record| record.has_photo()), Some(false));
    assert_eq!(memory.archive().luggage(LuggageId(3)), Ok(None));
}

#[test]
fn a_number_beyond_all_that_can_be_kept_is_that_of_nothing() {
    let mut memory = MemoryStore::new();
    record(&mut memory, [luggage(1, Ok("photo"))]);
    let (archive, beyond) = (memory.archive(), u64::MAX);
    assert_eq!((archive.luggage(LuggageId(beyond)), archive.photo(LuggageId(beyond))), (Ok(None), Ok(None)));
    assert_eq!(archive.mission(MissionId(beyond)), Ok(None));
    assert!(archive.state(MissionId(beyond)).is_ok_and(|state| state.is_none()));
    assert!(archive.missions(Some(MissionId(beyond)), 9).is_ok());
    assert_eq!(archive.entries(MissionId(beyond), Span::after(Seq(0)), 9), Ok(Vec::new()));
    assert_eq!(archive.entries(MissionId(1), Span::after(Seq(beyond)), 9), Ok(Vec::new()));
}

#[test]
fn a_failed_retake_leaves_the_photo_there_was() {
    let mut memory = MemoryStore::new();
    record(&mut memory, [luggage(1, Ok("first")), luggage(1, Err("dark"))]);
    assert!(memory.archive().photo(LuggageId(1)).unwrap().is_some());
}

#[test]
fn the_oldest_entries_and_photos_give_way() {
    let mut memory = MemoryStore::new();
    let many = 2 * PHOTOS;
    record(&mut memory, (1..=many).map(|id| luggage(id, Ok("photo"))));
    assert_eq!(memory.archive().photo(LuggageId(many - PHOTOS)), Ok(None));
    assert!(memory.archive().photo(LuggageId(many - PHOTOS + 1)).unwrap().is_some());
    record(&mut memory, (0..ENTRIES).map(|_| phase()));
    assert_eq!(entries(&memory).len() as u64, many + ENTRIES, "what stands could not be folded without the first of them");
    record(&mut memory, [standing(), phase()]);
    record(&mut memory, (0..many).map(|_| phase()));
    let entries = entries(&memory);
    assert_eq!(entries.len() as u64, ENTRIES);
    assert_eq!(entries.first().map(|(seq, _)| *seq), Some(Seq(2 * many + 3)));
}

#[test]
fn of_earlier_photos_the_oldest_give_way_and_the_newest_of_a_piece_never_for_them() {
    let mut memory = MemoryStore::new();
    let archive = memory.archive();
    let take = |n: u32| Entry { wall: WallTime::default(), fact: taken(1, n, photo(&format!("photo {n}"))) };
    let last = 2 * u32::try_from(EARLIER).unwrap();
    record(&mut memory, std::iter::once(luggage(2, Ok("of another"))).chain((1..=last).map(take)));
    let kept: Vec<u32> = (1..=last).filter(|n| archive.take(LuggageId(1), *n).unwrap().is_some()).collect();
    assert_eq!(kept, (last - u32::try_from(EARLIER).unwrap()..=last).collect::<Vec<_>>());
    assert_eq!(archive.take(LuggageId(2), 1).unwrap(), archive.photo(LuggageId(2)).unwrap());
    let files =
        |connection: &Connection| Ok(connection.query_row("SELECT count(*) FROM pictures", [], |row| row.get::<_, i64>(0))?);
    assert_eq!(memory.journal.ask(files).unwrap(), i64::try_from(EARLIER).unwrap() + 2, "nor are their pixels kept");
    record(&mut memory, (3..=PHOTOS + 3).map(|id| luggage(id, Ok("photo"))));
    assert_eq!(archive.take(LuggageId(1), last), Ok(None), "with the photo of a piece its earlier ones go");
}

/// Number of steps SQLite takes to delete what exceeds the bounds, when one more piece was added.
fn steps_of_giving_way(pieces: u64) -> i32 {
    let mut memory = MemoryStore::new();
    record(&mut memory, (1..=pieces).map(|id| luggage(id, Ok(&format!("photo {id}")))));
    let count = |connection: &Connection| {
        connection.execute_batch(
            "INSERT INTO photos VALUES ('new', 'image/png', 1);
             INSERT INTO luggage (id, record, photo) SELECT max(id) + 1, '{}', 'new' FROM luggage;",
        )?;
        let mut steps = 0;
        for sql in gives_way().split(';').filter(|sql| !sql.trim().is_empty()) {
            let mut statement = connection.prepare(sql)?;
            statement.execute([])?;
            steps += statement.get_status(StatementStatus::VmStep);
        }
        Ok(steps)
    };
    memory.journal.ask(count).expect("it is in memory")
}

#[test]
fn what_gives_way_is_found_without_a_look_at_all_luggage() {
    let (few, many) = (steps_of_giving_way(2 * PHOTOS), steps_of_giving_way(8 * PHOTOS));
    assert!(many < few + few / 10, "{few} steps, then {many}");
}

#[test]
fn the_journal_does_not_hold_on_to_pixels() {
    let mut memory = MemoryStore::new();
    record(&mut memory, [luggage(1, Ok("photo"))]);
    assert!(matches!(&entries(&memory)[..], [(Seq(1), Entry { fact: Fact::Luggage { photo: None, .. }, .. })]));
}

#[test]
fn a_mission_that_is_over_is_read_as_it_ended() {
    let mut memory = MemoryStore::new();
    let at = |fact| Entry { wall: WallTime::default(), fact };
    let mission = MissionId(1);
    let began = vec![phase(), at(Fact::MissionBegan(mission, Strategy::Snail)), luggage(1, Ok("first"))];
    memory.record(Page { first: Seq(1), entries: began, kept_back: None }, 0);
    let archived = Fact::MissionArchived(mission, vec![LuggageId(1)]);
    memory.record(Page { first: Seq(4), entries: vec![at(Fact::Phase(Phase::Idle)), at(archived), phase()], kept_back: None }, 0);
    let record = memory.archive().mission(mission).unwrap().expect("it was there");
    assert_eq!((&*record.phase, record.luggage, record.archived.is_some()), ("exploring", 1, true));
    assert_eq!(memory.archive().missions(None, 9).unwrap(), [record]);
    assert_eq!(memory.archive().missions(Some(mission), 9).unwrap(), []);
    let state = memory.archive().state(mission).unwrap().expect("it was there").of;
    assert_eq!((state.phase.clone(), state.luggage.len()), (Phase::Exploring, 1));
    let places: Vec<u64> =
        memory.archive().entries(mission, Span::after(Seq(1)), 9).unwrap().iter().map(|(seq, _)| seq.0).collect();
    assert_eq!(places, [2, 3, 5]);
}

#[test]
fn how_a_mission_ended_is_known_when_its_entries_have_given_way() {
    let mut memory = MemoryStore::new();
    let at = |fact| Entry { wall: WallTime::default(), fact };
    let mission = MissionId(1);
    record(&mut memory, [phase(), at(Fact::MissionBegan(mission, Strategy::Snail)), luggage(1, Ok("first"))]);
    let archived = at(Fact::MissionArchived(mission, Vec::new()));
    memory
        .record(Page { first: kept(&memory).next(), entries: vec![at(Fact::Phase(Phase::Idle)), archived], kept_back: None }, 0);
    record(&mut memory, (0..ENTRIES).map(|_| at(Fact::Phase(Phase::Idle))).chain([standing(), phase()]));
    assert_eq!(memory.archive().entries(mission, Span::after(Seq(0)), 9).unwrap(), []);
    let state = memory.archive().state(mission).unwrap().expect("it was there").of;
    assert_eq!((state.phase.clone(), state.luggage.len()), (Phase::Exploring, 1));
}

#[test]
fn a_moment_whose_past_has_given_way_is_not_guessed() {
    let mut memory = MemoryStore::new();
    let (archive, mission) = (memory.archive(), MissionId(1));
    record(&mut memory, [phase(), Entry { wall: WallTime::default(), fact: Fact::MissionBegan(mission, Strategy::Snail) }]);
    let moments = |seq| archive.moments(mission, &[At::Entry(seq)]).unwrap();
    assert_eq!(moments(Seq(2)).len(), 1);
    record(&mut memory, (0..ENTRIES).map(|_| phase()).chain([standing(), phase()]));
    record(&mut memory, (0..ENTRIES / 2).map(|_| phase()));
    let first = archive.entries(mission, Span::after(Seq(0)), 1).unwrap()[0].0;
    assert!(first > Seq(2), "the beginning is gone: {first}");
    assert_eq!(moments(first), []);
}
