//! Journal entries that several items share (safety A5, A6). An item is a STOP or a refusal. A sender that repeats
//! the same kind of item endlessly can fill neither the disk nor the queue of records. The first items of a sender
//! get one entry each. Later items are counted, and from time to time one entry records their number. `refusals` and
//! `stops` decide what the entries say.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use crate::command::Door;

#[derive(Clone, Copy, Debug)]
pub(super) struct CoalescingLimits {
    /// Number of items for which a sender gets one entry each. Later items share entries.
    pub(super) burst: u32,
    /// Time after which a sender may again have one item with an entry of its own.
    pub(super) earned: Duration,
    /// Minimum time between two shared entries of a sender.
    pub(super) every: Duration,
    /// Maximum number of senders that are counted separately; further senders share one tally.
    pub(super) senders: usize,
}

/// The name or the address of a sender, and the interface that it uses.
pub(super) type Sender = (Arc<str>, Door);

#[derive(Clone, Debug)]
pub(super) struct CoalescedEntries<T> {
    limits: CoalescingLimits,
    senders: BTreeMap<Sender, Tally<T>>,
    /// Items of all senders beyond the limit `senders`.
    others: Tally<T>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct CoalescedEntry<T> {
    pub(super) last: T,
    pub(super) count: u64,
    /// Time from the first item to the last.
    pub(super) lasted: Duration,
}

#[derive(Clone, Debug)]
struct Tally<T> {
    /// Number of items that may still get an entry of their own.
    room: u32,
    /// When `room` last grew, or the last shared entry was written.
    since: Duration,
    /// The items that are not written yet, and the time of the first one.
    unwritten: Option<(CoalescedEntry<T>, Duration)>,
}

impl<T> CoalescedEntries<T> {
    pub(super) fn new(limits: CoalescingLimits) -> CoalescedEntries<T> {
        CoalescedEntries { limits, senders: BTreeMap::new(), others: Tally::new(limits, Duration::ZERO) }
    }

    /// Counts an item. Returns the item if it must be written at once; otherwise it waits for a shared entry.
    pub(super) fn come(&mut self, sender: Sender, note: T, count: u64, now: Duration) -> Option<CoalescedEntry<T>> {
        let limits = self.limits;
        let is_known = self.senders.contains_key(&sender);
        if !is_known && self.senders.len() >= limits.senders {
            // A sender is forgotten only if it has no unwritten items and its full burst is available again.
            self.senders.retain(|_, tally| {
                tally.earn(limits, now);
                tally.unwritten.is_some() || tally.room != limits.burst
            });
        }
        let tally = if is_known || self.senders.len() < limits.senders {
            self.senders.entry(sender).or_insert_with(|| Tally::new(limits, now))
        } else {
            &mut self.others
        };
        tally.come(note, count, limits, now)
    }

    pub(super) fn due(&self) -> Option<Duration> {
        let first = |tally: &Tally<T>| tally.unwritten.as_ref().map(|(_, first)| first.saturating_add(self.limits.every));
        self.senders.values().chain([&self.others]).filter_map(first).min()
    }

    pub(super) fn fall_due(&mut self, now: Duration) -> Vec<CoalescedEntry<T>> {
        let every = self.limits.every;
        let tallies = self.senders.values_mut().chain([&mut self.others]);
        tallies.filter_map(|tally| tally.take(|first| first.saturating_add(every) <= now, now)).collect()
    }

    pub(super) fn rest(&mut self, now: Duration) -> Vec<CoalescedEntry<T>> {
        self.senders.values_mut().chain([&mut self.others]).filter_map(|tally| tally.take(|_| true, now)).collect()
    }
}

impl<T> Tally<T> {
    fn new(limits: CoalescingLimits, now: Duration) -> Tally<T> {
        Tally { room: limits.burst, since: now, unwritten: None }
    }

    fn come(&mut self, note: T, count: u64, limits: CoalescingLimits, now: Duration) -> Option<CoalescedEntry<T>> {
        self.earn(limits, now);
        if let Some((shared, first)) = &mut self.unwritten {
            *shared = CoalescedEntry { last: note, count: shared.count + count, lasted: now.saturating_sub(*first) };
            return None;
        }
        let one = CoalescedEntry { last: note, count, lasted: Duration::ZERO };
        if self.room == 0 || count > 1 {
            self.unwritten = Some((one, now));
            return None;
        }
        self.room -= 1;
        Some(one)
    }

    fn earn(&mut self, limits: CoalescingLimits, now: Duration) {
        let earned = now.saturating_sub(self.since).as_nanos() / limits.earned.as_nanos().max(1);
        let earned = u32::try_from(earned).unwrap_or(u32::MAX);
        if earned > 0 && self.unwritten.is_none() {
            self.room = self.room.saturating_add(earned).min(limits.burst);
            self.since = self.since.saturating_add(limits.earned.saturating_mul(earned));
        }
    }

    fn take(&mut self, is_due: impl Fn(Duration) -> bool, now: Duration) -> Option<CoalescedEntry<T>> {
        let (shared, _) = self.unwritten.take_if(|(_, first)| is_due(*first))?;
        self.since = now;
        Some(shared)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    const LIMITS: CoalescingLimits =
        CoalescingLimits { burst: 20, earned: Duration::from_millis(200), every: SECOND, senders: 8 };

    fn sender(name: &str) -> Sender {
        (name.into(), Door("http"))
    }

    fn written(entries: &[CoalescedEntry<u32>]) -> (usize, u64) {
        (entries.len(), entries.iter().map(|entry| entry.count).sum())
    }

    /// Safety A5, A6.
    #[test]
    fn a_flood_shares_an_entry_a_second_and_every_piece_of_it_is_in_one() {
        let mut coalesced = CoalescedEntries::new(LIMITS);
        let mut entries = Vec::new();
        for n in 0..50_000_u32 {
            let now = Duration::from_micros(100) * n;
            entries.extend(coalesced.fall_due(now));
            entries.extend(coalesced.come(sender("lobby"), n, 1, now));
        }
        entries.extend(coalesced.rest(SECOND * 5));
        assert_eq!(written(&entries), (LIMITS.burst as usize + 5, 50_000));
        let shared = &entries[LIMITS.burst as usize];
        assert_eq!((shared.last, shared.count), (10_019, 10_000), "{shared:?}");
        assert_eq!(shared.lasted, Duration::from_micros(100) * 9999);
        assert_eq!((coalesced.due(), coalesced.fall_due(SECOND * 90)), (None, Vec::new()), "nothing twice");
    }

    #[test]
    fn whoever_sends_a_few_a_second_is_written_one_by_one_whatever_others_do() {
        let mut coalesced = CoalescedEntries::new(LIMITS);
        for n in 0..1000_u32 {
            let now = LIMITS.earned * n;
            let _flood = (0..100).filter_map(|_| coalesced.come(sender("lobby"), n, 1, now)).count();
            let _due = coalesced.fall_due(now);
            assert_eq!(coalesced.come(sender("anna"), n, 1, now).map(|entry| entry.last), Some(n));
            assert_eq!(
                coalesced.come((sender("lobby").0, Door("mqtt")), n, 1, now).map(|entry| entry.last),
                Some(n),
                "another door"
            );
        }
    }

    #[test]
    fn what_was_earned_in_part_counts_too() {
        let mut coalesced = CoalescedEntries::new(LIMITS);
        let step = LIMITS.earned - Duration::from_millis(1);
        let alone = (0..LIMITS.burst * 40).filter_map(|n| coalesced.come(sender("anna"), n, 1, step * n)).count();
        assert!(alone > LIMITS.burst as usize * 39, "{alone} one by one");
    }

    #[test]
    fn exactly_so_many_are_told_apart_and_the_rest_shares() {
        let mut coalesced = CoalescedEntries::new(LIMITS);
        let mut entries = Vec::new();
        for n in 0..1000_u32 {
            entries.extend(coalesced.come(sender(&format!("127.0.{n}.1")), n, 1, Duration::ZERO));
        }
        assert_eq!((coalesced.senders.len(), entries.len()), (LIMITS.senders, LIMITS.senders + LIMITS.burst as usize));
        assert_eq!(
            coalesced.come(sender("127.0.3.1"), 3, 1, Duration::ZERO).map(|entry| entry.count),
            Some(1),
            "it has its room"
        );
        let rest = coalesced.clone().rest(Duration::ZERO);
        assert_eq!(written(&rest), (1, 1000 - (LIMITS.senders + LIMITS.burst as usize) as u64), "at the end of the program");
        entries.extend(coalesced.fall_due(SECOND));
        assert_eq!(written(&entries), (LIMITS.senders + LIMITS.burst as usize + 1, 1000));
    }

    /// Safety A6: one call may report several items, which were counted outside the queue of commands.
    #[test]
    fn what_came_as_many_at_once_is_not_forgotten_for_a_newcomer() {
        let mut coalesced = CoalescedEntries::new(LIMITS);
        for n in 0..LIMITS.senders {
            assert_eq!(coalesced.come(sender(&format!("key-{n}")), 1, 1000, Duration::ZERO), None);
        }
        assert!(coalesced.come(sender("anna"), 7, 1, Duration::ZERO).is_some());
        assert_eq!(written(&coalesced.rest(Duration::ZERO)), (LIMITS.senders, 1000 * LIMITS.senders as u64));
    }

    #[test]
    fn whoever_has_rested_makes_room_and_nothing_of_who_has_not_is_lost() {
        let mut coalesced = CoalescedEntries::new(LIMITS);
        for n in 0..LIMITS.senders - 1 {
            assert!(coalesced.come(sender(&format!("key-{n}")), 1, 1, Duration::ZERO).is_some());
        }
        assert_eq!((0..100).filter_map(|n| coalesced.come(sender("lobby"), n, 1, Duration::ZERO)).count(), LIMITS.burst as usize);
        assert!(coalesced.come(sender("anna"), 7, 1, SECOND).is_some());
        assert_eq!(coalesced.senders.keys().map(|(name, _)| &**name).collect::<Vec<_>>(), ["anna", "lobby"]);
        assert_eq!(written(&coalesced.fall_due(SECOND)), (1, 100 - u64::from(LIMITS.burst)));
    }
}
