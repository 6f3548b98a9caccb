//! How much of what doors refuse goes on record one by one (safety A5, A6): a sender who is refused without end, as somebody with a
//! viewer's key may be, fills neither the disk nor the queue of records in which a STOP waits. Beyond a burst his refusals share
//! an entry, which says how many they were. What the state refuses is not counted here: that is the operators' own.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use crate::core::command::{Door, Issuer, Refused};

/// So many refusals of one sender by one door are put on record one by one: more than a person presses in a minute,
const BURST: u32 = 60;

/// and after these one entry in so long.
const EVERY: Duration = Duration::from_secs(10);

/// So many senders are told apart: more than there are keys, at each of the doors.
const SENDERS: usize = 512;

/// The senders who were refused lately.
#[derive(Clone, Debug, Default)]
pub(super) struct Refusals(BTreeMap<(Arc<str>, Door), Sender>);

/// What is to be put on record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Note {
    pub(super) issuer: Issuer,
    /// What was asked for, and how much more was since the last note.
    pub(super) asked: String,
    pub(super) refused: Refused,
}

#[derive(Clone, Debug)]
struct Sender {
    /// So many more are written one by one.
    room: u32,
    /// When the last of these was added, or the last note written.
    since: Duration,
    /// What was not written since, and the last of it.
    unwritten: Option<(u64, Note)>,
}

impl Refusals {
    /// Takes what was refused just now, the last of so many; what is to be written at once.
    pub(super) fn come(&mut self, note: Note, count: u64, now: Duration) -> Vec<Note> {
        let key = (Arc::clone(&note.issuer.who), note.issuer.door);
        let mut due = if self.0.contains_key(&key) { Vec::new() } else { self.make_room() };
        let sender = self.0.entry(key).or_insert(Sender { room: BURST, since: now, unwritten: None });
        sender.refill(now);
        if let Some((unwritten, last)) = &mut sender.unwritten {
            (*unwritten, *last) = (unwritten.saturating_add(count), note);
        } else if sender.room > 0 && count == 1 {
            sender.room -= 1;
            due.push(note);
        } else {
            sender.unwritten = Some((count, note));
        }
        due
    }

    /// When something is to be written that was not written at once.
    pub(super) fn due(&self) -> Option<Duration> {
        self.0.values().filter(|sender| sender.unwritten.is_some()).map(|sender| sender.since + EVERY).min()
    }

    /// What is to be written by now.
    pub(super) fn fall_due(&mut self, now: Duration) -> Vec<Note> {
        let due = self.0.values_mut().filter(|sender| sender.since + EVERY <= now).filter_map(|sender| {
            let note = sender.take();
            sender.since = if note.is_some() { now } else { sender.since };
            note
        });
        due.collect()
    }

    /// Room for one more sender: who has been quiet for longest is forgotten, and what was not written of him is.
    fn make_room(&mut self) -> Vec<Note> {
        if self.0.len() < SENDERS {
            return Vec::new();
        }
        let oldest = self.0.iter().min_by_key(|(_, sender)| sender.since).map(|(key, _)| key.clone());
        let gone = oldest.and_then(|key| self.0.remove(&key));
        gone.and_then(|mut sender| sender.take()).into_iter().collect()
    }
}

impl Sender {
    fn refill(&mut self, now: Duration) {
        let earned = now.saturating_sub(self.since).as_secs() / EVERY.as_secs();
        if earned > 0 && self.unwritten.is_none() {
            self.room = self.room.saturating_add(u32::try_from(earned).unwrap_or(BURST)).min(BURST);
            self.since = now;
        }
    }

    fn take(&mut self) -> Option<Note> {
        let (count, last) = self.unwritten.take()?;
        let more = if count > 1 { format!(", and {} more that were refused", count - 1) } else { String::new() };
        Some(Note { asked: format!("{}{more}", last.asked), ..last })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn note(who: &str, asked: &str) -> Note {
        let issuer = Issuer { door: Door::Mqtt, who: who.into(), from: "192.0.2.7".into() };
        Note { issuer, asked: asked.to_owned(), refused: Refused::NotAllowed("lobby may only look".to_owned()) }
    }

    fn asked(notes: Vec<Note>) -> Vec<String> {
        notes.into_iter().map(|note| note.asked).collect()
    }

    const SECOND: Duration = Duration::from_secs(1);

    /// Safety A5, A6.
    #[test]
    fn a_flood_of_refusals_is_counted_and_every_one_of_them_is_in_an_entry() {
        let mut refusals = Refusals::default();
        let mut written = 0;
        for n in 0..3000_u32 {
            written += refusals.come(note("lobby", &format!("START {n}")), 1, SECOND * (n / 300)).len();
        }
        assert_eq!(written, BURST as usize);
        assert_eq!(refusals.due(), Some(EVERY));
        assert_eq!(refusals.fall_due(EVERY - SECOND), []);
        let more = 3000 - u64::from(BURST) - 1;
        assert_eq!(asked(refusals.fall_due(EVERY)), [format!("START 2999, and {more} more that were refused")]);
        assert_eq!((refusals.due(), refusals.fall_due(EVERY * 9)), (None, Vec::new()), "nothing twice");
    }

    /// Safety A6: the door counts while the queue of commands is full.
    #[test]
    fn what_comes_as_the_last_of_many_counts_as_many() {
        let mut refusals = Refusals::default();
        assert_eq!(refusals.come(note("lobby", "START 1"), 1000, SECOND), []);
        assert_eq!(refusals.come(note("lobby", "START 2"), 1, SECOND), []);
        assert_eq!(asked(refusals.fall_due(EVERY + SECOND)), ["START 2, and 1000 more that were refused"]);
    }

    #[test]
    fn whoever_is_refused_now_and_then_is_written_one_by_one_and_nobody_for_another() {
        let mut refusals = Refusals::default();
        (0..9 * BURST).for_each(|_| drop(refusals.come(note("lobby", "START"), 1, SECOND)));
        assert_eq!(asked(refusals.come(note("anna", "RESET"), 1, SECOND)), ["RESET"], "another sender has room of his own");
        assert_eq!(refusals.fall_due(EVERY + SECOND).len(), 1);
        assert!(refusals.come(note("lobby", "START"), 1, EVERY + SECOND).is_empty());
        assert_eq!(refusals.fall_due(EVERY * 3).len(), 1);
        for n in 4..400 {
            assert_eq!(refusals.come(note("lobby", "START"), 1, EVERY * n).len(), 1, "one in {EVERY:?} is written at once");
        }
    }

    #[test]
    fn exactly_so_many_senders_are_told_apart_and_nothing_of_who_is_forgotten_is_lost() {
        let mut refusals = Refusals::default();
        (0..=BURST).for_each(|_| drop(refusals.come(note("first", "START"), 1, Duration::ZERO)));
        for n in 1..SENDERS {
            assert_eq!(refusals.come(note(&format!("key-{n}"), "START"), 1, SECOND).len(), 1);
        }
        assert_eq!(refusals.0.len(), SENDERS);
        assert_eq!(asked(refusals.come(note("last", "RESET"), 1, SECOND)), ["START", "RESET"]);
        assert_eq!(refusals.0.len(), SENDERS);
    }
}
