//! The order in which connections are evicted. There are queues for operators and for all others, and one for each
//! key and each network. The queues are kept sorted, so that the first connection is found at once. So a crowd that
//! comes and goes costs the hearing thread little. `connection_slots` chooses the queue.

use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::hash::Hash;

use super::{Activity, SlotClaim, Who};
use crate::access::Network;

/// Position in the order of eviction. Strangers are evicted first, operators last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct EvictionTurn {
    pub(super) rank: u8,
    pub(super) activity: Activity,
    pub(super) since: u64,
    pub(super) number: u64,
}

/// The number of connections of one kind, and the connection that is evicted first. `first` is `None` if no
/// connection may be evicted.
#[derive(Debug, Default, PartialEq)]
pub(super) struct QueueHead {
    pub(super) many: usize,
    pub(super) first: Option<EvictionTurn>,
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

    /// Returns the number of all connections, and the first to evict. Operators are evicted last.
    pub(super) fn of_all(&self) -> QueueHead {
        let (operators, others) = (self.operators.head(), self.others.head());
        QueueHead { many: operators.many + others.many, first: others.first.or(operators.first) }
    }

    /// Returns the number of connections of viewers and strangers, and the first to evict.
    pub(super) fn of_others(&self) -> QueueHead {
        self.others.head()
    }

    pub(super) fn of_key(&self, claim: &SlotClaim) -> QueueHead {
        claim.who.as_ref().and_then(|who| self.keys.get(who)).map(EvictionQueue::head).unwrap_or_default()
    }

    pub(super) fn of_network(&self, claim: &SlotClaim) -> QueueHead {
        self.networks.get(&claim.network).map(EvictionQueue::head).unwrap_or_default()
    }

    /// Whether all queues are empty, and no queues of keys or networks are left over.
    #[cfg(test)]
    pub(super) fn are_empty(&self) -> bool {
        let is_kept = self.keys.len() + self.networks.len() + self.operators.yielding.len() + self.others.yielding.len() > 0;
        self.of_all().many == 0 && !is_kept
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

    fn head(&self) -> QueueHead {
        QueueHead { many: self.many, first: self.yielding.first().copied() }
    }
}

/// Removes a connection from the queue of its key or network. An empty queue is removed too, so that the maps do not
/// grow without bound.
fn leave<K: Eq + Hash>(queues: &mut HashMap<K, EvictionQueue>, of: K, turn: EvictionTurn) {
    if let Entry::Occupied(mut queue) = queues.entry(of) {
        queue.get_mut().leave(turn);
        if queue.get().many == 0 {
            queue.remove();
        }
    }
}
