//! A store in memory: what it is given is kept at once, and gone with the program.
//! Nothing here is durable; it is bounded instead, so that a robot may search for weeks.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard};

use tokio::sync::watch;

use crate::core::effect::{Entry, Fact};
use crate::core::event::Photo;
use crate::core::units::{LuggageId, Seq};
use crate::core::world::luggage::{Decision, Luggage, PhotoState};
use crate::runtime::archive::Archive;
use crate::runtime::store::{Store, StoreWord};

/// How many entries are kept: some missions of a large hall, at about 100 bytes each.
pub const ENTRIES: usize = 16_384;

/// How many photos are kept: more pieces than a hall holds, at some 100 KB each.
pub const PHOTOS: usize = 256;

/// How many luggage records are kept: more than a busy year's, at about 200 bytes each.
pub const RECORDS: usize = 16_384;

/// Journal and photos, shared by everyone who holds a clone.
#[derive(Clone, Debug)]
pub struct Memory {
    kept: Arc<Mutex<Kept>>,
    word: watch::Sender<StoreWord>,
}

#[derive(Debug, Default)]
struct Kept {
    entries: VecDeque<(Seq, Entry)>,
    photos: BTreeMap<LuggageId, Photo>,
    records: BTreeMap<LuggageId, Luggage>,
}

impl Default for Memory {
    fn default() -> Memory {
        Memory { kept: Arc::default(), word: watch::Sender::new(Ok(Seq(0))) }
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
        self.lock().entries.iter().cloned().collect()
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        // Whoever panicked while holding the lock left whole values behind: every change below is a single insert or remove.
        self.kept.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Kept {
    fn keep(&mut self, seq: Seq, entry: &Entry) {
        self.keep_record(entry);
        let mut entry = entry.clone();
        if let Fact::Luggage { id, photo: Ok(photo), .. } = &mut entry.fact {
            // The pixels are bounded by the number of photos alone, so the journal must not hold on to them.
            let pixels = std::mem::replace(&mut photo.bytes, Arc::from([]));
            self.keep_photo(*id, Photo { bytes: pixels, media_type: photo.media_type });
        }
        if self.entries.len() == ENTRIES {
            self.entries.pop_front();
        }
        self.entries.push_back((seq, entry));
    }

    /// Keeps what an entry says of a piece; the oldest gives way when there are too many.
    fn keep_record(&mut self, entry: &Entry) {
        if let Fact::Luggage { id, cell, pose, photo } = &entry.fact {
            let before = self.records.remove(id);
            let photo = PhotoState::after(before.as_ref().map(|record| &record.photo), photo);
            let verdict = before.and_then(|record| record.verdict);
            let record = Luggage { id: *id, cell: *cell, pose: *pose, taken: entry.wall, photo, verdict, piece: None };
            self.records.insert(*id, record);
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

    /// Keeps a photo; that of the oldest piece gives way when there are too many.
    fn keep_photo(&mut self, luggage: LuggageId, photo: Photo) {
        self.photos.insert(luggage, photo);
        if self.photos.len() > PHOTOS {
            self.photos.pop_first();
        }
    }
}

impl Store for Memory {
    fn record(&mut self, seq: Seq, entry: &Entry) {
        self.lock().keep(seq, entry);
        // Only the newest word counts; whoever listens has its own receiver.
        drop(self.word.send_replace(Ok(seq)));
    }

    fn word(&self) -> watch::Receiver<StoreWord> {
        self.word.subscribe()
    }
}

impl Archive for Memory {
    fn photo(&self, luggage: LuggageId) -> Option<Photo> {
        self.lock().photos.get(&luggage).cloned()
    }

    fn luggage(&self, luggage: LuggageId) -> Option<Luggage> {
        self.lock().records.get(&luggage).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::command::Verdict;
    use crate::core::mission::PhaseName;
    use crate::core::units::{Cell, Pose, Wall};

    fn phase() -> Entry {
        Entry { wall: Wall::default(), fact: Fact::Phase(PhaseName::Exploring, None) }
    }

    fn luggage(id: u64, photo: Result<&str, &str>) -> Entry {
        let photo = photo.map(|text| Photo { bytes: text.as_bytes().into(), media_type: "image/png" }).map_err(str::to_owned);
        let fact = Fact::Luggage { id: LuggageId(id), cell: Cell::new(0, 1), pose: Pose::START, photo };
        Entry { wall: Wall::default(), fact }
    }

    fn kept(memory: &Memory) -> Seq {
        memory.word().borrow().clone().expect("memory always keeps")
    }

    fn record(memory: &mut Memory, entries: impl IntoIterator<Item = Entry>) {
        for entry in entries {
            let next = kept(memory).next();
            memory.record(next, &entry);
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
        assert_eq!(archive.photo(LuggageId(1)), None);
        record(&mut memory, [luggage(1, Ok("first")), luggage(2, Err("dark")), luggage(1, Ok("again"))]);
        assert_eq!(archive.photo(LuggageId(1)).map(|photo| photo.bytes), Some(b"again".as_slice().into()));
        assert_eq!(archive.photo(LuggageId(2)), None, "a failed photo is none");
    }

    #[test]
    fn a_piece_is_found_with_its_verdict_whatever_mission_it_was_of() {
        let mut memory = Memory::new();
        let verdict = Fact::Verdict { luggage: LuggageId(1), verdict: Verdict::Safe, who: "operator".into() };
        record(&mut memory, [luggage(1, Ok("first")), Entry { wall: Wall::default(), fact: verdict }, luggage(2, Err("dark"))]);
        let first = memory.luggage(LuggageId(1)).expect("the first piece is kept");
        assert_eq!((first.verdict_name(), first.has_photo()), ("safe", true));
        assert_eq!(memory.luggage(LuggageId(2)).map(|record| record.has_photo()), Some(false));
        assert_eq!(memory.luggage(LuggageId(3)), None);
    }

    #[test]
    fn a_failed_retake_leaves_the_photo_there_was() {
        let mut memory = Memory::new();
        record(&mut memory, [luggage(1, Ok("first")), luggage(1, Err("dark"))]);
        assert!(memory.photo(LuggageId(1)).is_some());
    }

    #[test]
    fn the_oldest_entries_and_photos_give_way() {
        let mut memory = Memory::new();
        let many = 2 * PHOTOS as u64;
        record(&mut memory, (1..=many).map(|id| luggage(id, Ok("photo"))));
        assert_eq!(memory.photo(LuggageId(many - PHOTOS as u64)), None);
        assert!(memory.photo(LuggageId(many - PHOTOS as u64 + 1)).is_some());
        record(&mut memory, (0..ENTRIES).map(|_| phase()));
        let entries = memory.entries();
        assert_eq!(entries.len(), ENTRIES);
        assert_eq!(entries.first().map(|(seq, _)| *seq), Some(Seq(many + 1)));
    }

    #[test]
    fn the_journal_does_not_hold_on_to_pixels() {
        let mut memory = Memory::new();
        record(&mut memory, [luggage(1, Ok("photo"))]);
        assert_eq!(memory.entries(), [(Seq(1), luggage(1, Ok("")))]);
    }
}
