//! The order in which connections are evicted, of all of them and of each key and network. It is kept sorted, so that the first
//! is found at once: a crowd that comes and goes costs the hearing thread little. `connection_slots` decides from which queue one
//! is evicted.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::hash::Hash;

use super::{Activity, SlotClaim, Who};
use crate::access::Network;

/// Position in the order of eviction: strangers go first, operators last.
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

#[derive(Default)]
struct EvictionQueue {
    many: usize,
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

    /// Number of all connections, and the first to evict.
    pub(super) fn of_all(&self) -> (usize, Option<EvictionTurn>) {
        let ((operators, last), (others, first)) = (self.operators.first(), self.others.first());
        (operators + others, first.or(last))
    }

    /// Number of connections of viewers and strangers, and the first to evict.
    pub(super) fn of_others(&self) -> (usize, Option<EvictionTurn>) {
        self.others.first()
    }

    /// Number of connections of the claim's key, and the first to evict; none without a key.
    pub(super) fn of_key(&self, claim: &SlotClaim) -> (usize, Option<EvictionTurn>) {
        claim.who.as_ref().and_then(|who| self.keys.get(who)).map(EvictionQueue::first).unwrap_or_default()
    }

    /// Number of connections of the claim's network, and the first to evict.
    pub(super) fn of_network(&self, claim: &SlotClaim) -> (usize, Option<EvictionTurn>) {
        self.networks.get(&claim.network).map(EvictionQueue::first).unwrap_or_default()
    }

    /// Whether there are no connections, and no leftover entries of keys or networks.
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

/// Removes the entry of a key or network with its last connection.
fn leave<K: Eq + Hash>(queues: &mut HashMap<K, EvictionQueue>, of: K, turn: EvictionTurn) {
    if let Entry::Occupied(mut queue) = queues.entry(of) {
        queue.get_mut().leave(turn);
        if queue.get().many == 0 {
            queue.remove();
        }
    }
}
