//! The outputs of the core: effects in order, entries of the journal with their numbers, and the answers that wait
//! for a record.

use std::collections::VecDeque;
use std::time::Duration;

use crate::effect::{Effect, KeptBack, Order, Page};
use crate::refused::Refused;
use crate::robot::RobotId;
use crate::state::fact::{Entry, Fact};
use crate::units::{LuggageId, Now, Seq, Ticket, WallTime};

/// Number of entries after which the whole state is recorded, so that the next start reads few entries. For a large
/// state, the number is larger (`TIMES_ITS_SIZE`).
const SUM_UP_AFTER: u64 = 10_000;

/// Minimum number of entries between two records of the whole state, as a multiple of the size of the state
/// (`PersistentState::size_in_entries`). These records therefore add at most a quarter to the cost of a move in a
/// large hall. At a start, the program reads a quarter of a million entries per second.
const TIMES_ITS_SIZE: u64 = 4;

/// Maximum time that the epoch of a stop waits for the next entry. After this time, it gets an entry of its own.
const SOON: Duration = Duration::from_secs(1);

/// Maximum number of commands that are recorded again after the store has failed. A person who clicks fast needs
/// about an hour to send this number of commands.
const COMMANDS: usize = 1024;

#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    effects: VecDeque<Effect>,
    page: Vec<Entry>,
    /// The answers of judges that the next page stores.
    kept_back: Option<KeptBack>,
    /// A fact that waits for the next entry, and the time at which it stops waiting and is recorded alone.
    soon: Option<(Entry, Duration)>,
    /// Whether the page must end with the whole state.
    sums_up: bool,
    since_summed_up: u64,
    written: Seq,
    /// The last entry that must be stored before the robot moves on. Commands and readings do not count, because they
    /// may arrive at any time while the robot moves.
    barrier: Seq,
    kept: Seq,
    tickets: Ticket,
    waiting: Vec<WaitingAnswer>,
    /// The commands that are not stored yet. Each command must reach the journal, even if the store fails
    /// (safety A6).
    commands: VecDeque<Unkept>,
    /// The last entry that was written before the store failed. This entry and earlier ones are lost if they were not
    /// stored.
    lost: Seq,
}

#[derive(Clone, Debug)]
struct Unkept {
    seq: Seq,
    entry: Entry,
    /// The answer if the command is lost. `None` if the command was refused, or was already answered.
    if_lost: Option<Refused>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct WaitingAnswer {
    pub(super) ticket: Ticket,
    pub(super) seq: Seq,
    pub(super) luggage: Option<LuggageId>,
    /// The verdict, if the command gave one. Another verdict may replace it before the answer is sent.
    pub(super) verdict: Option<crate::command::Verdict>,
    /// Whether the verdict is stored. The answer then waits only for the consequences of the verdict.
    pub(super) decided: bool,
}

impl Outbox {
    pub(super) fn after(written: Seq) -> Outbox {
        Outbox { written, barrier: written, kept: written, ..Outbox::default() }
    }

    pub(super) fn send(&mut self, effect: Effect) {
        self.effects.push_back(effect);
    }

    /// Puts a halt ahead of everything else. Withdraws a motion that has not been sent, and returns it.
    pub(super) fn halt(&mut self, robot: &RobotId) -> Option<Order> {
        let place = self
            .effects
            .iter()
            .position(|effect| matches!(effect, Effect::Order(to, order) if to == robot && order.action.is_motion()));
        let order = place.and_then(|place| self.effects.remove(place));
        let halt = Effect::Halt(robot.clone());
        if !self.effects.iter().take_while(|effect| matches!(effect, Effect::Halt(_))).any(|effect| *effect == halt) {
            self.effects.push_front(halt);
        }
        match order {
            Some(Effect::Order(_, order)) => Some(order),
            _ => None,
        }
    }

    /// Returns the next effect: halts first, then pages for the store, then the rest.
    pub(super) fn poll(&mut self) -> Option<Effect> {
        let is_empty = self.page.is_empty() && self.kept_back.is_none();
        if is_empty || matches!(self.effects.front(), Some(Effect::Halt(_))) {
            return self.effects.pop_front();
        }
        let entries = std::mem::take(&mut self.page);
        let first = Seq(self.written.0 + 1 - entries.len() as u64);
        Some(Effect::Record(Page { first, entries, kept_back: self.kept_back.take() }))
    }

    pub(super) fn keep_back(&mut self, kept_back: KeptBack) {
        self.kept_back = Some(kept_back);
    }

    pub(super) fn sum_up(&mut self) {
        self.sums_up = true;
    }

    /// Whether the whole state must be recorded now. `size` is the size of the state, as a number of entries.
    pub(super) fn is_to_sum_up(&self, size: u64) -> bool {
        self.sums_up || self.since_summed_up >= SUM_UP_AFTER.max(TIMES_ITS_SIZE * size)
    }

    /// Records a fact with the next entry, or after a second at the latest. If another fact arrives here in this
    /// time, it replaces the waiting fact, so many such facts make few entries.
    pub(super) fn record_soon(&mut self, now: Now, fact: Fact) {
        let due = self.soon.take().map_or(now.since_start.saturating_add(SOON), |(_, due)| due);
        self.soon = Some((Entry { wall: now.wall, fact }, due));
    }

    pub(super) fn due_record(&self) -> Option<Duration> {
        self.soon.as_ref().map(|(_, due)| *due)
    }

    pub(super) fn record_overdue(&mut self, now: Now) {
        if let Some((Entry { wall, fact }, _)) = self.soon.take_if(|(_, due)| *due <= now.since_start) {
            self.record(wall, fact);
        }
    }

    /// Sends a fact to the store. If a fact of `record_soon` waits, it is sent first. Returns the number of the entry
    /// with `fact`.
    pub(super) fn record(&mut self, wall: WallTime, fact: Fact) -> Seq {
        if let Some((Entry { wall, fact }, _)) = self.soon.take() {
            self.record(wall, fact);
        }
        self.written = self.written.next();
        let entry = Entry { wall, fact };
        self.since_summed_up += 1;
        if matches!(entry.fact, Fact::State(_)) {
            (self.sums_up, self.since_summed_up) = (false, 0);
        }
        // An endless stream of commands and readings must not prevent the robot from moving.
        if !matches!(entry.fact, Fact::Command { .. } | Fact::Temperature(..) | Fact::ThermometerSilent(_)) {
            self.barrier = self.written;
        }
        self.page.push(entry);
        self.written
    }

    /// Sends a command to the store. If the command never gets stored, its sender gets the answer `if_lost`.
    pub(super) fn record_command(&mut self, wall: WallTime, fact: Fact, if_lost: Option<Refused>) {
        let entry = Entry { wall, fact };
        let seq = self.record(wall, entry.fact.clone());
        if self.commands.len() < COMMANDS {
            self.commands.push_back(Unkept { seq, entry, if_lost });
        }
    }

    /// Sends to the store, once more, the commands that were lost when the store failed. Each is recorded with the
    /// answer that its sender got. Later commands are not lost: the store still has them and stores them now.
    pub(super) fn repeat_commands(&mut self) {
        let lost = self.lost;
        let (repeat, rest) = std::mem::take(&mut self.commands).into_iter().partition(|unkept: &Unkept| unkept.seq <= lost);
        self.commands = rest;
        let repeat: VecDeque<Unkept> = repeat;
        for Unkept { entry: Entry { wall, mut fact }, if_lost, .. } in repeat {
            if let (Fact::Command { refused, .. }, Some(told)) = (&mut fact, if_lost) {
                *refused = Some(told);
            }
            self.record_command(wall, fact, None);
        }
    }

    pub(super) const fn written(&self) -> Seq {
        self.written
    }

    pub(super) const fn kept(&self) -> Seq {
        self.kept
    }

    /// Whether everything that concerns the mission is stored. The robot waits for this before each move, so a kill
    /// of the program loses at most the current move. The place that the robot then reports still fits the map.
    pub(super) fn is_settled(&self) -> bool {
        self.kept >= self.barrier
    }

    pub(super) fn is_kept(&self) -> bool {
        self.kept >= self.written
    }

    pub(super) fn keep(&mut self, seq: Seq) {
        self.kept = self.kept.max(seq);
        self.commands.retain(|unkept| unkept.seq > seq);
    }

    pub(super) fn next_ticket(&mut self) -> Ticket {
        self.tickets = self.tickets.next();
        self.tickets
    }

    pub(super) fn wait(&mut self, waiting: WaitingAnswer) {
        self.waiting.push(waiting);
    }

    pub(super) fn due(&mut self) -> Vec<WaitingAnswer> {
        let kept = self.kept;
        let (due, waiting) = self.waiting.drain(..).partition(|waiting| waiting.seq <= kept);
        self.waiting = waiting;
        due
    }

    pub(super) fn give_up(&mut self) -> Vec<WaitingAnswer> {
        self.lost = self.written;
        std::mem::take(&mut self.waiting)
    }

    pub(super) fn follow(&mut self, first: Ticket, ticket: Ticket) {
        if let Some(waiting) = self.waiting.iter().find(|waiting| waiting.ticket == first).copied() {
            self.waiting.push(WaitingAnswer { ticket, ..waiting });
        }
    }

    /// Makes the answers about this piece wait for entry `seq`, because a new verdict has replaced the old one.
    pub(super) fn defer(&mut self, luggage: LuggageId, seq: Seq) {
        for waiting in &mut self.waiting {
            if waiting.luggage == Some(luggage) && waiting.verdict.is_some() {
                waiting.seq = seq;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::command::Strategy;
    use crate::state::PersistentState;

    #[test]
    fn what_is_said_of_all_that_stands_grows_with_the_entries_between_and_not_with_the_hall() {
        let summed_up = |size: u64| {
            let mut outbox = Outbox::default();
            let all = || Fact::State(Box::new(PersistentState::first(Strategy::default())));
            let mut said = 0;
            for _ in 0..200_000 {
                outbox.record(WallTime::default(), Fact::Led(true));
                if outbox.is_to_sum_up(size) {
                    outbox.record(WallTime::default(), all());
                    said += size;
                }
            }
            said
        };
        assert_eq!((summed_up(100), summed_up(5_000)), (2_000, 50_000));
        assert!(summed_up(20_000) <= 50_000 && summed_up(60_000) <= 50_000);
    }

    /// Safety S2.
    #[test]
    fn a_halt_goes_ahead_of_whatever_was_on_its_way() {
        let mut outbox = Outbox::default();
        outbox.send(Effect::Led(RobotId::discovery(), true));
        outbox.record(WallTime::default(), Fact::Led(true));
        assert_eq!(outbox.halt(&RobotId::discovery()), None);
        assert_eq!(outbox.poll(), Some(Effect::Halt(RobotId::discovery())));
        assert!(matches!(outbox.poll(), Some(Effect::Record(_))));
        assert_eq!(outbox.poll(), Some(Effect::Led(RobotId::discovery(), true)));
    }
}
