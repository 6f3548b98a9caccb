//! A store in memory: what it is given is kept at once, and gone with the program.
//! Nothing here is durable; it is bounded instead, so that a robot may search for weeks.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard};

use tokio::sync::watch;

use super::belonging::belongs;
use crate::runtime::archive::{Archive, Happened, MissionRecord, Sound, Unreadable};
use crate::runtime::store::{Store, StoreStatus};
use hallsweep_core::effect::{Entry, Fact, Page};
use hallsweep_core::event::Photo;
use hallsweep_core::explore::Strategy;
use hallsweep_core::mission::Phase;
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::{LuggageId, MissionId, Seq, WallTime};
use hallsweep_core::world::luggage::{Decision, Luggage};

/// How many entries are kept: some missions of a large hall, at about 100 bytes each.
pub const ENTRIES: usize = 16_384;

/// How many photos are kept: more pieces than a hall holds, at some 100 KB each.
pub const PHOTOS: usize = 256;

/// How many luggage records are kept: more than a busy year's, at about 200 bytes each.
pub const RECORDS: usize = 16_384;

/// How many missions are kept, the present one included: a year's on a quiet airport, at some 100 KB for the map of each.
pub const MISSIONS: usize = 256;

/// Journal and photos, shared by everyone who holds a clone.
#[derive(Clone, Debug)]
pub struct Memory {
    kept: Arc<Mutex<Kept>>,
    word: watch::Sender<StoreStatus>,
}

#[derive(Debug)]
struct Kept {
    standing: PersistentState,
    entries: VecDeque<(Seq, Option<MissionId>, Entry)>,
    missions: BTreeMap<MissionId, Mission>,
    under_way: Option<MissionId>,
    /// The phase before the page that is being kept.
    phase_before: Phase,
    photos: BTreeMap<LuggageId, Photo>,
    records: BTreeMap<LuggageId, Luggage>,
}

/// A mission, present or past.
#[derive(Debug)]
struct Mission {
    strategy: Strategy,
    began: WallTime,
    ended: Option<Ended>,
}

/// How a mission was put away.
#[derive(Debug)]
struct Ended {
    wall: WallTime,
    left: Vec<LuggageId>,
    standing: PersistentState,
}

impl Default for Memory {
    fn default() -> Memory {
        let kept = Kept {
            standing: PersistentState::first(Strategy::default()),
            entries: VecDeque::new(),
            missions: BTreeMap::new(),
            under_way: None,
            phase_before: Phase::Idle,
            photos: BTreeMap::new(),
            records: BTreeMap::new(),
        };
        Memory { kept: Arc::new(Mutex::new(kept)), word: watch::Sender::new(StoreStatus::default()) }
    }
}

impl Memory {
    /// An empty store.
    #[must_use]
    pub fn new() -> Memory {
        Memory::default()
    }

    /// The newest entries with their numbers, oldest first, at most `ENTRIES`. Photos are not in them: ask for those by number.
    #[must_use]
    pub fn entries(&self) -> Vec<(Seq, Entry)> {
        self.lock().entries.iter().map(|(seq, _, entry)| (*seq, entry.clone())).collect()
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        // Whoever panicked while holding the lock left whole values behind: every change below is a single insert or remove.
        self.kept.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Kept {
    fn keep_page(&mut self, page: &Page) {
        self.phase_before = self.standing.phase.clone();
        for place in 0..page.entries.len() {
            let mission;
            (mission, self.under_way) = belongs(page, place, self.under_way);
            self.keep_mission(page, place);
            self.keep(Seq(page.first.0 + place as u64), mission, page.entries[place].clone());
        }
    }

    fn keep(&mut self, seq: Seq, mission: Option<MissionId>, mut entry: Entry) {
        self.standing.apply(&entry);
        self.keep_record(&entry);
        if let Fact::Luggage { record, photo } = &mut entry.fact
            && let Some(photo) = photo.take()
        {
            // The pixels are bounded by the number of photos alone, so the journal must not hold on to them.
            self.keep_photo(record.id, photo);
        }
        if self.entries.len() == ENTRIES {
            self.entries.pop_front();
        }
        self.entries.push_back((seq, mission, entry));
    }

    /// Keeps the beginning and the end of a mission; the oldest mission gives way when there are too many.
    fn keep_mission(&mut self, page: &Page, place: usize) {
        let Entry { wall, fact } = &page.entries[place];
        if let Fact::MissionBegan(mission, strategy) = fact {
            self.missions.insert(*mission, Mission { strategy: *strategy, began: *wall, ended: None });
        }
        if let Fact::MissionArchived(mission, left) = fact
            && let Some(known) = self.missions.get_mut(mission)
        {
            // The phase that follows on the mission is on record just before its end.
            let phase = self.phase_before.clone();
            let standing = PersistentState { phase, ..self.standing.clone() };
            known.ended = Some(Ended { wall: *wall, left: left.clone(), standing });
        }
        if self.missions.len() > MISSIONS {
            self.missions.pop_first();
        }
    }

    fn record(&self, id: MissionId) -> Option<MissionRecord> {
        let Mission { strategy, began, ended } = self.missions.get(&id)?;
        let standing = ended.as_ref().map_or(&self.standing, |ended| &ended.standing);
        Some(MissionRecord {
            id,
            strategy: strategy.name().into(),
            began: *began,
            archived: ended.as_ref().map(|ended| ended.wall),
            phase: Arc::from(standing.phase.name().name()),
            luggage: standing.luggage.len() as u64,
            dangerous: standing.luggage.values().filter(|record| record.is_dangerous()).count() as u64,
            left: ended.as_ref().map(|ended| ended.left.clone()).unwrap_or_default(),
        })
    }

    /// Keeps what an entry says of a piece; the oldest gives way when there are too many.
    fn keep_record(&mut self, entry: &Entry) {
        if let Fact::Luggage { record, .. } = &entry.fact {
            let verdict = self.records.remove(&record.id).and_then(|before| before.verdict);
            self.records.insert(record.id, Luggage { verdict, ..Luggage::clone(record) });
        }
        if let Fact::Verdict { luggage, verdict, who } = &entry.fact
            && let Some(record) = self.records.get_mut(luggage)
        {
            record.verdict = Some(Decision { verdict: *verdict, who: Arc::clone(who), wall: entry.wall });
        }
        if self.records.len() > RECORDS {
            self.records.pop_first();
        }
    }

    /// An entry as it stands there: a safe that a danger overtook as what it was.
    fn as_it_was(&self, entry: Entry) -> Entry {
        let verdict_on = |id| self.records.get(&id)?.verdict.as_ref().map(|decision| decision.verdict);
        Entry { fact: entry.fact.as_it_was(verdict_on), ..entry }
    }

    /// Keeps a photo; that of the oldest piece gives way when there are too many.
    fn keep_photo(&mut self, luggage: LuggageId, photo: Photo) {
        self.photos.insert(luggage, photo);
        if self.photos.len() > PHOTOS {
            self.photos.pop_first();
        }
    }
}

impl Store for Memory {
    fn record(&mut self, page: Page, _losses: u64) {
        let last = page.last();
        self.lock().keep_page(&page);
        self.word.send_modify(|word| word.kept = last);
    }

    fn word(&self) -> watch::Receiver<StoreStatus> {
        self.word.subscribe()
    }
}

impl Archive for Memory {
    fn photo(&self, luggage: LuggageId) -> Result<Option<Photo>, Unreadable> {
        Ok(self.lock().photos.get(&luggage).cloned())
    }

    fn luggage(&self, luggage: LuggageId) -> Result<Option<Luggage>, Unreadable> {
        Ok(self.lock().records.get(&luggage).cloned())
    }

    fn missions(&self, before: Option<MissionId>, most: usize) -> Result<Vec<MissionRecord>, Unreadable> {
        let kept = self.lock();
        let older = kept.missions.keys().rev().filter(|id| before.is_none_or(|before| **id < before));
        Ok(older.take(most).filter_map(|id| kept.record(*id)).collect())
    }

    fn mission(&self, mission: MissionId) -> Result<Option<MissionRecord>, Unreadable> {
        Ok(self.lock().record(mission))
    }

    fn standing(&self, mission: MissionId) -> Result<Option<Sound<PersistentState>>, Unreadable> {
        let kept = self.lock();
        let known = kept.missions.get(&mission);
        let of = known.map(|known| known.ended.as_ref().map_or(&kept.standing, |ended| &ended.standing).clone());
        Ok(of.map(|of| Sound { of, damage: Vec::new() }))
    }

    fn entries(&self, mission: MissionId, after: Seq, most: usize) -> Result<Vec<Happened>, Unreadable> {
        let kept = self.lock();
        let of = kept.entries.iter().filter(|(seq, of, _)| *of == Some(mission) && *seq > after);
        Ok(of.take(most).map(|(seq, _, entry)| (*seq, Ok(kept.as_it_was(entry.clone())))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::command::Verdict;
    use hallsweep_core::units::{Cell, Pose};
    use hallsweep_core::world::luggage::PhotoState;

    fn phase() -> Entry {
        Entry { wall: WallTime::default(), fact: Fact::Phase(Phase::Exploring) }
    }

    fn luggage(id: u64, photo: Result<&str, &str>) -> Entry {
        let photo = photo.map(|text| Photo { bytes: text.as_bytes().into(), media_type: "image/png" }).map_err(str::to_owned);
        let (cell, pose, taken) = (Cell::new(0, 1), Pose::START, WallTime::default());
        let state = PhotoState::after(None, &photo);
        let record = Arc::new(Luggage { id: LuggageId(id), cell, pose, taken, photo: state, verdict: None, piece: None });
        Entry { wall: taken, fact: Fact::Luggage { record, photo: photo.ok() } }
    }

    fn kept(memory: &Memory) -> Seq {
        memory.word().borrow().kept
    }

    fn record(memory: &mut Memory, entries: impl IntoIterator<Item = Entry>) {
        for entry in entries {
            let next = kept(memory).next();
            memory.record(Page { first: next, entries: vec![entry] }, 0);
        }
    }

    #[test]
    fn what_is_recorded_is_kept_at_once() {
        let mut memory = Memory::new();
        assert_eq!(kept(&memory), Seq(0));
        record(&mut memory, [phase(), phase()]);
        assert_eq!(kept(&memory), Seq(2));
        assert_eq!(memory.entries(), [(Seq(1), phase()), (Seq(2), phase())]);
    }

    #[test]
    fn every_clone_sees_the_newest_photo_of_a_piece() {
        let mut memory = Memory::new();
        let archive: Box<dyn Archive> = Box::new(memory.clone());
        assert_eq!(archive.photo(LuggageId(1)), Ok(None));
        record(&mut memory, [luggage(1, Ok("first")), luggage(2, Err("dark")), luggage(1, Ok("again"))]);
        assert_eq!(archive.photo(LuggageId(1)).unwrap().map(|photo| photo.bytes), Some(b"again".as_slice().into()));
        assert_eq!(archive.photo(LuggageId(2)), Ok(None), "a failed photo is none");
    }

    #[test]
    fn a_piece_is_found_with_its_verdict_whatever_mission_it_was_of() {
        let mut memory = Memory::new();
        let verdict = Fact::Verdict { luggage: LuggageId(1), verdict: Verdict::Safe, who: "operator".into() };
        record(
            &mut memory,
            [luggage(1, Ok("first")), Entry { wall: WallTime::default(), fact: verdict }, luggage(2, Err("dark"))],
        );
        let first = memory.luggage(LuggageId(1)).unwrap().expect("the first piece is kept");
        assert_eq!((first.verdict_name(), first.has_photo()), ("safe", true));
        assert_eq!(memory.luggage(LuggageId(2)).unwrap().map(|record| record.has_photo()), Some(false));
        assert_eq!(memory.luggage(LuggageId(3)), Ok(None));
    }

    #[test]
    fn a_failed_retake_leaves_the_photo_there_was() {
        let mut memory = Memory::new();
        record(&mut memory, [luggage(1, Ok("first")), luggage(1, Err("dark"))]);
        assert!(memory.photo(LuggageId(1)).unwrap().is_some());
    }

    #[test]
    fn the_oldest_entries_and_photos_give_way() {
        let mut memory = Memory::new();
        let many = 2 * PHOTOS as u64;
        record(&mut memory, (1..=many).map(|id| luggage(id, Ok("photo"))));
        assert_eq!(memory.photo(LuggageId(many - PHOTOS as u64)), Ok(None));
        assert!(memory.photo(LuggageId(many - PHOTOS as u64 + 1)).unwrap().is_some());
        record(&mut memory, (0..ENTRIES).map(|_| phase()));
        let entries = memory.entries();
        assert_eq!(entries.len(), ENTRIES);
        assert_eq!(entries.first().map(|(seq, _)| *seq), Some(Seq(many + 1)));
    }

    #[test]
    fn the_journal_does_not_hold_on_to_pixels() {
        let mut memory = Memory::new();
        record(&mut memory, [luggage(1, Ok("photo"))]);
        assert!(matches!(&memory.entries()[..], [(Seq(1), Entry { fact: Fact::Luggage { photo: None, .. }, .. })]));
    }

    #[test]
    fn a_mission_that_is_over_is_read_as_it_ended() {
        let mut memory = Memory::new();
        let at = |fact| Entry { wall: WallTime::default(), fact };
        let mission = MissionId(1);
        let began = vec![phase(), at(Fact::MissionBegan(mission, Strategy::Snail)), luggage(1, Ok("first"))];
        memory.record(Page { first: Seq(1), entries: began }, 0);
        let archived = Fact::MissionArchived(mission, vec![LuggageId(1)]);
        memory.record(Page { first: Seq(4), entries: vec![at(Fact::Phase(Phase::Idle)), at(archived), phase()] }, 0);
        let record = memory.mission(mission).unwrap().expect("it was there");
        assert_eq!((&*record.phase, record.luggage, record.archived.is_some()), ("exploring", 1, true));
        assert_eq!(memory.missions(None, 9).unwrap(), [record]);
        assert_eq!(memory.missions(Some(mission), 9).unwrap(), []);
        let standing = memory.standing(mission).unwrap().expect("it was there").of;
        assert_eq!((standing.phase.clone(), standing.luggage.len()), (Phase::Exploring, 1));
        let places: Vec<u64> = Archive::entries(&memory, mission, Seq(1), 9).unwrap().iter().map(|(seq, _)| seq.0).collect();
        assert_eq!(places, [2, 3, 5]);
    }
}
