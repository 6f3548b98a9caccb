//! The luggage records by number, in memory that snapshots share. A copy is cheap, and the changes between two states
//! are found without comparing everything. Indexes list four groups: the pieces that wait for a verdict, the waiting
//! pieces without a photo, the dangerous pieces still in the hall, and the secured pieces.

use std::collections::BTreeSet;
use std::ops::Index;
use std::sync::Arc;

use super::luggage::Luggage;
use crate::units::LuggageId;

/// Maximum number of records in a part. A change copies the pointers of one part, and one pointer for each part.
pub const PART: usize = 128;

type LuggagePart = Arc<Vec<Arc<Luggage>>>;

/// Luggage records in the order of their numbers. Each number occurs once.
#[derive(Clone, Debug, Default)]
pub struct LuggageRecords {
    /// The parts, in the order of their numbers. No part is empty.
    parts: Arc<Vec<LuggagePart>>,
    size: usize,
    pending: BTreeSet<LuggageId>,
    bombs_left: BTreeSet<LuggageId>,
    secured: BTreeSet<LuggageId>,
    photoless: BTreeSet<LuggageId>,
}

impl LuggageRecords {
    #[must_use]
    pub const fn len(&self) -> usize {
        self.size
    }

    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.size == 0
    }

    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Arc<Luggage>> {
        self.parts.iter().flat_map(|part| part.iter())
    }

    #[must_use]
    pub fn get(&self, id: LuggageId) -> Option<&Arc<Luggage>> {
        let part = self.parts.get(self.part_of(id)?)?;
        part.binary_search_by_key(&id, |record| record.id).ok().map(|place| &part[place])
    }

    #[must_use]
    pub fn last(&self) -> Option<&Arc<Luggage>> {
        self.parts.last()?.last()
    }

    /// Records that wait for their verdict, the oldest first.
    pub fn pending(&self) -> impl Iterator<Item = &Arc<Luggage>> {
        self.pending.iter().filter_map(|id| self.get(*id))
    }

    /// Records of dangerous pieces that are still in the hall, the oldest first.
    pub fn bombs_left(&self) -> impl Iterator<Item = &Arc<Luggage>> {
        self.bombs_left.iter().filter_map(|id| self.get(*id))
    }

    /// Records of pieces in the container, the oldest first.
    pub fn secured(&self) -> impl Iterator<Item = &Arc<Luggage>> {
        self.secured.iter().filter_map(|id| self.get(*id))
    }

    /// Records that wait for their verdict and have no photo, the oldest first.
    pub fn photoless(&self) -> impl Iterator<Item = &Arc<Luggage>> {
        self.photoless.iter().filter_map(|id| self.get(*id))
    }

    /// All records, part by part. No part has more than `PART` records.
    pub fn parts(&self) -> impl ExactSizeIterator<Item = &[Arc<Luggage>]> {
        self.parts.iter().map(|part| &part[..])
    }

    /// Returns the parts that do not share their memory with `older`, each with its index. `older` is an earlier
    /// state of these records.
    pub fn parts_changed_since<'a>(&'a self, older: &'a LuggageRecords) -> impl Iterator<Item = (usize, &'a [Arc<Luggage>])> {
        let is_shared = |n: usize, part: &LuggagePart| older.parts.get(n).is_some_and(|old| Arc::ptr_eq(old, part));
        let parts = self.parts.iter().enumerate().filter(move |(n, part)| !is_shared(*n, part));
        parts.map(|(n, part)| (n, &part[..]))
    }

    /// Returns the records that do not share their memory with `older`, an earlier state of these records.
    pub fn changed_since<'a>(&'a self, older: &'a LuggageRecords) -> impl Iterator<Item = &'a Arc<Luggage>> {
        let is_same = |record: &Arc<Luggage>| older.get(record.id).is_some_and(|old| Arc::ptr_eq(old, record));
        self.parts_changed_since(older).flat_map(|(_, part)| part).filter(move |record| !is_same(record))
    }

    pub fn insert(&mut self, record: Arc<Luggage>) {
        let id = record.id;
        let is_pending = record.is_pending();
        for (set, belongs) in [
            (&mut self.pending, is_pending),
            (&mut self.bombs_left, record.is_bomb_left()),
            (&mut self.secured, record.secured.is_some()),
            (&mut self.photoless, is_pending && !record.has_photo()),
        ] {
            if belongs {
                set.insert(id);
            } else {
                set.remove(&id);
            }
        }
        let known = self.part_of(id);
        let parts = Arc::make_mut(&mut self.parts);
        let Some(n) = known else {
            parts.insert(0, Arc::new(vec![record]));
            self.size += 1;
            return;
        };
        match parts[n].binary_search_by_key(&id, |record| record.id) {
            Ok(place) => Arc::make_mut(&mut parts[n])[place] = record,
            // Numbers grow, so a new record nearly always comes last.
            Err(PART) if n + 1 == parts.len() => {
                parts.push(Arc::new(vec![record]));
                self.size += 1;
            }
            Err(place) => {
                Arc::make_mut(&mut parts[n]).insert(place, record);
                self.size += 1;
            }
        }
    }

    pub fn change(&mut self, id: LuggageId, change: impl FnOnce(&mut Luggage)) {
        if let Some(record) = self.get(id) {
            let mut changed = Luggage::clone(record);
            change(&mut changed);
            self.insert(Arc::new(changed));
        }
    }

    /// Returns the index of the part to which a number belongs; `None` if the number is less than all stored numbers.
    fn part_of(&self, id: LuggageId) -> Option<usize> {
        self.parts.partition_point(|part| part[0].id <= id).checked_sub(1)
    }
}

/// Compares all records. If both sides are divided into parts alike, parts that both sides share are skipped.
impl PartialEq for LuggageRecords {
    fn eq(&self, other: &LuggageRecords) -> bool {
        if self.size != other.size || Arc::ptr_eq(&self.parts, &other.parts) {
            return self.size == other.size;
        }
        let is_same = |(a, b): (&Arc<Luggage>, &Arc<Luggage>)| Arc::ptr_eq(a, b) || a == b;
        let differing = || self.parts.iter().zip(other.parts.iter()).filter(|(a, b)| !Arc::ptr_eq(a, b));
        if self.parts.len() == other.parts.len() && differing().all(|(a, b)| a.len() == b.len()) {
            differing().all(|(a, b)| a.iter().zip(b.iter()).all(is_same))
        } else {
            self.iter().zip(other.iter()).all(is_same)
        }
    }
}

impl FromIterator<Arc<Luggage>> for LuggageRecords {
    fn from_iter<T: IntoIterator<Item = Arc<Luggage>>>(records: T) -> LuggageRecords {
        let mut all = LuggageRecords::default();
        records.into_iter().for_each(|record| all.insert(record));
        all
    }
}

impl<const N: usize> From<[Arc<Luggage>; N]> for LuggageRecords {
    fn from(records: [Arc<Luggage>; N]) -> LuggageRecords {
        records.into_iter().collect()
    }
}

/// Access by position. Position 0 has the oldest record.
impl Index<usize> for LuggageRecords {
    type Output = Arc<Luggage>;

    fn index(&self, place: usize) -> &Arc<Luggage> {
        self.iter().nth(place).expect("the index is below the number of records")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Verdict;
    use crate::units::{Cell, Pose, WallTime};
    use crate::world::luggage::{Decision, PhotoState};

    fn record(id: u64, verdict: Option<Verdict>) -> Arc<Luggage> {
        let decision = |verdict| Decision {
            verdict,
            who: Arc::from("somebody"),
            wall: WallTime::default(),
            note: None,
            hot: Default::default(),
        };
        Arc::new(Luggage {
            id: LuggageId(id),
            cell: Cell::HOME,
            pose: Pose::START,
            taken: WallTime::default(),
            first_taken: WallTime::default(),
            photo: PhotoState::Failed("dark".to_owned()),
            verdict: verdict.map(decision),
            seen_from: Vec::new(),
            unsure: Vec::new(),
            judged: Vec::new(),
            truth: None,
            piece: None,
            secured: None,
            clock_set_ms: 0,
        })
    }

    #[test]
    fn records_are_found_by_their_numbers_whatever_order_they_came_in() {
        let numbers: Vec<u64> = (1..1000).map(|n| n * 7919 % 1009).collect();
        let records: LuggageRecords = numbers.iter().map(|id| record(*id, None)).collect();
        let mut sorted = numbers.clone();
        sorted.sort_unstable();
        assert_eq!(records.iter().map(|record| record.id.0).collect::<Vec<_>>(), sorted);
        assert!(numbers.iter().all(|id| records.get(LuggageId(*id)).is_some_and(|record| record.id.0 == *id)));
        assert_eq!((records.len(), records.get(LuggageId(0)), records.get(LuggageId(5000))), (999, None, None));
    }

    #[test]
    fn what_waits_and_what_is_dangerous_is_at_hand_after_every_change() {
        let mut records: LuggageRecords = (1..=300).map(|id| record(id, Some(Verdict::Safe))).collect();
        records.insert(record(301, None));
        records.insert(record(200, Some(Verdict::Danger)));
        let ids = |found: Vec<&Arc<Luggage>>| found.iter().map(|record| record.id.0).collect::<Vec<_>>();
        assert_eq!(ids(records.pending().collect()), [301]);
        assert_eq!(ids(records.photoless().collect()), [301]);
        assert_eq!(ids(records.bombs_left().collect()), [200]);
        records.change(LuggageId(200), |bomb| bomb.secured = Some(WallTime::default()));
        records.insert(record(301, Some(Verdict::Safe)));
        assert_eq!(records.pending().count() + records.bombs_left().count() + records.photoless().count(), 0);
        assert_eq!(ids(records.secured().collect()), [200]);
    }

    #[test]
    fn a_change_is_found_without_what_is_shared() {
        let older: LuggageRecords = (1..=1000).map(|id| record(id, Some(Verdict::Safe))).collect();
        let mut newer = older.clone();
        assert_eq!(newer, older);
        newer.insert(record(400, Some(Verdict::Danger)));
        newer.insert(record(1001, None));
        let changed: Vec<u64> = newer.changed_since(&older).map(|record| record.id.0).collect();
        assert_eq!(changed, [400, 1001]);
        assert_ne!(newer, older);
    }
}
