//! In which order connections give way, of all of them and of each key and network, kept so that the first is found at once however
//! many there are: a crowd that comes and goes costs the thread that hears little. Who has to give way, is said by `connection_slots`.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::hash::Hash;

use super::{Activity, SlotClaim, Who};
use crate::access::Network;

/// When a connection gives way: strangers go before anybody else, and operators go last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct EvictionTurn {
    pub(super) rank: u8,
    pub(super) activity: Activity,
    pub(super) since: u64,
    pub(super) number: u64,
}

#[derive(Default)]
pub(super) struct EvictionQueues {
    operators: EvictionQueue,
    others: EvictionQueue,
    keys: HashMap<Who, EvictionQueue>,
    networks: HashMap<Network, EvictionQueue>,
}

/// Those who have something in common.
#[derive(Default)]
struct EvictionQueue {
    many: usize,
    /// Of them, those who can give way at all.
    yielding: BTreeSet<EvictionTurn>,
}

impl EvictionQueues {
    pub(super) fn enter(&mut self, claim: &SlotClaim, turn: EvictionTurn) {
        self.everybody(claim).enter(turn);
        if let Some(who) = &claim.who {
            self.keys.entry(who.clone()).or_default().enter(turn);
        }
        self.networks.entry(claim.network).or_default().enter(turn);
    }

    pub(super) fn leave(&mut self, claim: &SlotClaim, turn: EvictionTurn) {
        self.everybody(claim).leave(turn);
        if let Some(who) = &claim.who {
            leave(&mut self.keys, who.clone(), turn);
        }
        leave(&mut self.networks, claim.network, turn);
    }

    /// How many there are, and who gives way first.
    pub(super) fn of_all(&self) -> (usize, Option<EvictionTurn>) {
        let ((operators, last), (others, first)) = (self.operators.first(), self.others.first());
        (operators + others, first.or(last))
    }

    /// The same of those who are no operators,
    pub(super) fn of_others(&self) -> (usize, Option<EvictionTurn>) {
        self.others.first()
    }

    /// of one key, where there is one,
    pub(super) fn of_key(&self, claim: &SlotClaim) -> (usize, Option<EvictionTurn>) {
        claim.who.as_ref().and_then(|who| self.keys.get(who)).map(EvictionQueue::first).unwrap_or_default()
    }

    /// and of one network.
    pub(super) fn of_network(&self, claim: &SlotClaim) -> (usize, Option<EvictionTurn>) {
        self.networks.get(&claim.network).map(EvictionQueue::first).unwrap_or_default()
    }

    /// Whether nobody is here, and nothing is kept of anybody.
    #[cfg(test)]
    pub(super) fn are_empty(&self) -> bool {
        let is_kept = self.keys.len() + self.networks.len() + self.operators.yielding.len() + self.others.yielding.len() > 0;
        self.of_all().0 == 0 && !is_kept
    }

    fn everybody(&mut self, claim: &SlotClaim) -> &mut EvictionQueue {
        if claim.is_operator() { &mut self.operators } else { &mut self.others }
    }
}

impl EvictionQueue {
    fn enter(&mut self, turn: EvictionTurn) {
        self.many += 1;
        if turn.activity != Activity::Watching {
            self.yielding.insert(turn);
        }
    }

    fn leave(&mut self, turn: EvictionTurn) {
        self.many -= 1;
        self.yielding.remove(&turn);
    }

    fn first(&self) -> (usize, Option<EvictionTurn>) {
        (self.many, self.yielding.first().copied())
    }
}

/// Of whom nobody is here any more nothing is kept.
fn leave<K: Eq + Hash>(queues: &mut HashMap<K, EvictionQueue>, of: K, turn: EvictionTurn) {
    if let Entry::Occupied(mut queue) = queues.entry(of) {
        queue.get_mut().leave(turn);
        if queue.get().many == 0 {
            queue.remove();
        }
    }
}
