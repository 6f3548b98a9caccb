//! Limits the number of journal entries for refusals by the interfaces (safety A5, A6). A sender that is refused
//! endlessly, perhaps with a viewer's key, must not fill the disk or the queue of records, because STOPs need this
//! queue too. After a burst, the refusals of a sender share an entry, which has their number. Refusals by the core
//! are not counted here, because they answer operators' own commands.

use std::time::Duration;

use super::Engine;
use super::coalesced_entries::{CoalescedEntry, CoalescingLimits, Sender};
use crate::asked::Asked;
use crate::command::Issuer;
use crate::refused::Refused;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::units::{Now, Seq};

/// The burst is larger than the number of commands that a person sends in a minute. After the burst, a sender gets
/// one entry every 10 s. The limit `senders` is higher than the number of keys of all interfaces.
pub(super) const LIMITS: CoalescingLimits =
    CoalescingLimits { burst: 60, earned: Duration::from_secs(10), every: Duration::from_secs(10), senders: 512 };

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Note {
    pub(super) issuer: Issuer,
    /// The latest request, and the number of further requests since the last entry.
    pub(super) asked: Asked,
    pub(super) refused: Refused,
}

impl Engine {
    /// Notes `count` commands of one sender that an interface refused (safety A6). `asked` is the last one, as far as
    /// the interface knows it. Returns the number of the journal entry; `None` if the commands will share an entry
    /// with others.
    pub fn note_refused(&mut self, issuer: Issuer, asked: Asked, refused: &Refused, count: u64, now: Now) -> Option<Seq> {
        self.begin(now);
        if !matches!(refused, Refused::NotAllowed(_)) && self.may_be_answer(&asked, refused) {
            return None;
        }
        let note = Note { issuer, asked, refused: refused.clone() };
        let due = self.refusals.come(note.sender(), note, count, now.since_start);
        let is_written = due.is_some();
        self.write_refusals(due);
        is_written.then(|| self.outbox.written())
    }

    pub(super) fn write_refusals(&mut self, due: impl IntoIterator<Item = CoalescedEntry<Note>>) {
        for Note { issuer, asked, refused } in due.into_iter().map(Note::of) {
            let refused = Some(refused);
            let said = Said::Asked { asked: asked.clone(), meant: None, issuer: issuer.clone(), refused: refused.clone() };
            self.world.write(self.now.wall, Tone::Warning, said);
            let fact = Fact::Command { issuer, id: None, asked, epoch: None, luggage: None, refused };
            self.outbox.record_command(self.now.wall, fact, None);
        }
    }
}

impl Note {
    fn sender(&self) -> Sender {
        (self.issuer.key(), self.issuer.door)
    }

    fn of(CoalescedEntry { last, count, .. }: CoalescedEntry<Note>) -> Note {
        if count <= 1 {
            return last;
        }
        // Several people may share a key, so only the name of the key is written.
        let issuer = Issuer { who: last.issuer.key(), ..last.issuer };
        Note { issuer, asked: Asked::Many { last: Box::new(last.asked), more: count - 1 }, ..last }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Door;
    use crate::engine::coalesced_entries::CoalescedEntries;

    fn note(who: &str, asked: &str) -> Note {
        let issuer = Issuer { door: Door("mqtt"), who: who.into(), from: "192.0.2.7".into() };
        Note { issuer, asked: Asked::Words(asked.to_owned()), refused: Refused::NotAllowed("lobby may only look".to_owned()) }
    }

    fn come(refusals: &mut CoalescedEntries<Note>, note: Note, count: u64, now: Duration) -> Option<CoalescedEntry<Note>> {
        refusals.come(note.sender(), note, count, now)
    }

    fn asked(due: impl IntoIterator<Item = CoalescedEntry<Note>>) -> Vec<String> {
        due.into_iter().map(|shared| Note::of(shared).asked.to_string()).collect()
    }

    const SECOND: Duration = Duration::from_secs(1);

    const BURST: u32 = LIMITS.burst;

    const EVERY: Duration = LIMITS.every;

    /// Safety A5, A6.
    #[test]
    fn a_flood_of_refusals_is_counted_and_every_one_of_them_is_in_an_entry() {
        let mut refusals = CoalescedEntries::new(LIMITS);
        let mut written = 0;
        for n in 0..3000_u32 {
            written += usize::from(come(&mut refusals, note("lobby", &format!("START {n}")), 1, SECOND * (n / 300)).is_some());
        }
        assert_eq!(written, BURST as usize);
        assert_eq!(refusals.due(), Some(EVERY));
        assert_eq!(refusals.fall_due(EVERY - SECOND), []);
        let more = 3000 - u64::from(BURST) - 1;
        assert_eq!(asked(refusals.fall_due(EVERY)), [format!("START 2999, and {more} more that were refused")]);
        assert_eq!((refusals.due(), refusals.fall_due(EVERY * 9)), (None, Vec::new()), "nothing twice");
    }

    /// Safety A6: an interface counts refusals while the queue of commands is full.
    #[test]
    fn what_comes_as_the_last_of_many_counts_as_many() {
        let mut refusals = CoalescedEntries::new(LIMITS);
        assert_eq!(come(&mut refusals, note("lobby", "START 1"), 1000, SECOND), None);
        assert_eq!(come(&mut refusals, note("lobby", "START 2"), 1, SECOND), None);
        assert_eq!(asked(refusals.fall_due(EVERY + SECOND)), ["START 2, and 1000 more that were refused"]);
    }

    #[test]
    fn whoever_is_refused_now_and_then_is_written_one_by_one_and_nobody_for_another() {
        let mut refusals = CoalescedEntries::new(LIMITS);
        (0..9 * BURST).for_each(|_| drop(come(&mut refusals, note("lobby", "START"), 1, SECOND)));
        assert_eq!(asked(come(&mut refusals, note("anna", "RESET"), 1, SECOND)), ["RESET"], "another sender has room of his own");
        assert_eq!(refusals.fall_due(EVERY + SECOND).len(), 1);
        assert_eq!(come(&mut refusals, note("lobby", "START"), 1, EVERY + SECOND), None);
        assert_eq!(refusals.fall_due(EVERY * 3).len(), 1);
        for n in 4..400 {
            assert!(come(&mut refusals, note("lobby", "START"), 1, EVERY * n).is_some(), "one in {EVERY:?} is written at once");
        }
    }

    #[test]
    fn exactly_so_many_senders_are_told_apart_and_nothing_of_others_is_lost() {
        let mut refusals = CoalescedEntries::new(LIMITS);
        (0..=BURST).for_each(|_| drop(come(&mut refusals, note("first", "START"), 1, Duration::ZERO)));
        for n in 1..LIMITS.senders {
            assert!(come(&mut refusals, note(&format!("key-{n}"), "START"), 1, Duration::ZERO).is_some());
        }
        let others = (0..=BURST).filter_map(|n| come(&mut refusals, note(&format!("late-{n}"), "RESET"), 1, Duration::ZERO));
        assert_eq!(others.count(), BURST as usize, "they share one room");
        assert_eq!(asked(refusals.fall_due(EVERY)), ["START", "RESET"]);
    }
}
