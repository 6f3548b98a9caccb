//! What leaves the core: effects in order, entries of the journal with their numbers, and the answers that wait for a record.

use std::collections::VecDeque;

use crate::core::effect::{Effect, Entry, Fact, Order};
use crate::core::event::RobotId;
use crate::core::units::{LuggageId, Seq, Ticket, Wall};

/// The outgoing side of a sweep.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox {
    effects: VecDeque<Effect>,
    written: Seq,
    /// Nothing begins to move until everything up to here is kept.
    barrier: Seq,
    kept: Seq,
    tickets: Ticket,
    waiting: Vec<Waiting>,
}

/// An accepted command whose answer waits for a record.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub(super) ticket: Ticket,
    pub(super) seq: Seq,
    /// The piece it concerned.
    pub(super) luggage: Option<LuggageId>,
    /// The verdict it gave, if it gave one: another may have won by then.
    pub(super) verdict: Option<crate::core::command::Verdict>,
}

impl Outbox {
    pub(super) fn send(&mut self, effect: Effect) {
        self.effects.push_back(effect);
    }

    /// Puts a halt ahead of everything else; a motion that has not gone out is taken back, and returned.
    pub(super) fn halt(&mut self, robot: RobotId) -> Option<Order> {
        let place = self
            .effects
            .iter()
            .position(|effect| matches!(effect, Effect::Order(to, order) if *to == robot && order.action.is_motion()));
        let order = place.and_then(|place| self.effects.remove(place));
        if self.effects.front() != Some(&Effect::Halt(robot)) {
            self.effects.push_front(Effect::Halt(robot));
        }
        match order {
            Some(Effect::Order(_, order)) => Some(order),
            _ => None,
        }
    }

    pub(super) fn poll(&mut self) -> Option<Effect> {
        self.effects.pop_front()
    }

    /// Puts a fact on its way to the store; motion need not wait for it.
    pub(super) fn note(&mut self, wall: Wall, fact: Fact) -> Seq {
        self.written = self.written.next();
        self.effects.push_back(Effect::Record(self.written, Entry { wall, fact }));
        self.written
    }

    /// Puts a fact on its way to the store; nothing begins to move before it is kept.
    pub(super) fn record(&mut self, wall: Wall, fact: Fact) -> Seq {
        self.barrier = self.note(wall, fact);
        self.barrier
    }

    pub(super) const fn barrier(&self) -> Seq {
        self.barrier
    }

    /// Whether everything that must be kept before motion is kept.
    pub(super) fn is_settled(&self) -> bool {
        self.kept >= self.barrier
    }

    pub(super) fn keep(&mut self, seq: Seq) {
        self.kept = self.kept.max(seq);
    }

    pub(super) fn next_ticket(&mut self) -> Ticket {
        self.tickets = self.tickets.next();
        self.tickets
    }

    pub(super) fn wait(&mut self, waiting: Waiting) {
        self.waiting.push(waiting);
    }

    /// The waiting answers whose record is kept, in order.
    pub(super) fn due(&mut self) -> Vec<Waiting> {
        let kept = self.kept;
        let (due, waiting) = self.waiting.drain(..).partition(|waiting| waiting.seq <= kept);
        self.waiting = waiting;
        due
    }

    /// All waiting answers, because the store has failed.
    pub(super) fn give_up(&mut self) -> Vec<Waiting> {
        std::mem::take(&mut self.waiting)
    }

    /// Lets the answers that waited for a replaced verdict on this piece wait for the one that replaced it.
    pub(super) fn defer(&mut self, luggage: LuggageId, seq: Seq) {
        for waiting in &mut self.waiting {
            if waiting.luggage == Some(luggage) && waiting.verdict.is_some() {
                waiting.seq = seq;
            }
        }
    }
}
