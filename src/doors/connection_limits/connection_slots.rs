//! Slots for HTTP connections that have sent the whole head of a request. The shares of one key and of one network
//! are limited. If no slot is free, a connection is evicted for a newcomer. Strangers are evicted before viewers, and
//! viewers before operators. Only an operator evicts an operator. Among senders of one rank, the least active
//! connection is evicted (`Activity`). Among equally active connections, the one whose last progress is oldest is
//! evicted. Connections without a whole head are in `pending_connections`.

mod eviction_queues;

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use eviction_queues::{EvictionQueues, EvictionTurn, QueueHead};

use super::connection_budget::ConnectionBudget;
use super::pending_connections::EVICTED_AT_ONCE;
use crate::access::{Access, Caller, Network, Role};

/// Maximum number of open connections: 256 streams, and 384 connections for other requests. By default a process has
/// 1,024 descriptors. Some of them are needed for pending and closing connections, the other doors, and files.
pub(in crate::doors) const SLOTS: usize = 640;

/// One key may have 1 / `PARTS` of all slots. The same holds for one network, except for this machine. Without keys
/// there are no shares.
const PARTS: usize = 4;

/// 1 / `KEPT` of all slots is reserved for operators, who may connect later.
const KEPT: usize = 8;

/// Maximum number of evicted connections that are still closing. The ordinary threads close them, which may take
/// long. Beyond this number newcomers are refused. For operators and STOP the number is twice as high. This limits
/// what a flood of new connections can cost.
const LEAVING: usize = 32;

#[derive(Clone)]
pub(in crate::doors) struct ConnectionSlots(Arc<Mutex<SlotTable>>);

struct SlotTable {
    most: usize,
    /// Maximum number of evicted connections that are still closing.
    leaving: usize,
    has_shares: bool,
    /// Number of events so far. A "moment" is the number of an event, so a smaller moment is an older one.
    moments: u64,
    /// Slots in use, including those of evicted connections that are still closing.
    held: usize,
    holders: HashMap<u64, SlotHolder>,
    /// The order of eviction. It is kept sorted, because searching all connections for each newcomer would delay the
    /// STOPs of other senders.
    queues: EvictionQueues,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::doors) struct SlotClaim {
    network: Network,
    /// The sender's key; `None` for strangers.
    who: Option<Who>,
}

/// The name of a key, and whether it is the key of an operator.
type Who = (Arc<str>, bool);

struct SlotHolder {
    claim: SlotClaim,
    /// Number of requests whose heads have arrived and that are not answered yet.
    open: u64,
    is_receiving: bool,
    is_watching: bool,
    /// Moment of the last progress. `SlotTable::moments` counts the moments.
    since: u64,
    cut: Arc<Notify>,
}

/// How active a connection is. Among senders of one rank, connections are evicted in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Activity {
    Resting,
    /// A body is arriving, even if slowly.
    Receiving,
    Answering,
    /// An endless answer is being sent. Such a connection is never evicted. The limit of streams leaves slots for
    /// other connections.
    Watching,
}

/// The slot of one connection. It is in use until this value is dropped.
pub(in crate::doors) struct ConnectionSlot {
    number: u64,
    slots: ConnectionSlots,
}

impl SlotClaim {
    pub(in crate::doors) fn new(address: IpAddr, caller: Option<&Caller>) -> SlotClaim {
        let who = caller.map(|caller| (caller.name(), caller.role() == Role::Operator));
        SlotClaim { network: Network::of(address), who }
    }

    fn is_operator(&self) -> bool {
        self.who.as_ref().is_some_and(|(_, is_operator)| *is_operator)
    }

    /// The rank in the order of eviction: first strangers, then viewers, then operators.
    const fn rank(&self) -> u8 {
        match &self.who {
            None => 0,
            Some((_, false)) => 1,
            Some((_, true)) => 2,
        }
    }
}

impl ConnectionSlots {
    pub(in crate::doors) fn new(most: usize, budget: ConnectionBudget, access: &Access) -> ConnectionSlots {
        let (most, leaving, has_shares) = (budget.scaled(most), budget.scaled(LEAVING), matches!(access, Access::Keys(_)));
        let (holders, queues) = (HashMap::new(), EvictionQueues::default());
        ConnectionSlots(Arc::new(Mutex::new(SlotTable { most, leaving, has_shares, moments: 0, held: 0, holders, queues })))
    }

    /// Takes a slot. If none is free, another connection is evicted, and its `cut` is notified. Returns `None` if no
    /// connection can be evicted, or if too many evicted connections are still closing.
    pub(in crate::doors) fn take(&self, claim: SlotClaim, says_stop: bool, cut: Arc<Notify>) -> Option<ConnectionSlot> {
        let mut table = self.table();
        let is_heeded = says_stop || table.has_shares && claim.is_operator();
        let leaving = if is_heeded { 2 * table.leaving } else { table.leaving };
        if table.held >= table.most + leaving || !table.make_room(&claim) {
            return None;
        }
        table.held += 1;
        let number = table.moment();
        let holder = SlotHolder { claim, open: 0, is_receiving: false, is_watching: false, since: number, cut };
        table.insert(number, holder);
        drop(table);
        Some(ConnectionSlot { number, slots: self.clone() })
    }

    /// Evicts some connections when the system has no more descriptors. Returns how many were evicted.
    pub(in crate::doors) fn evict_some(&self) -> usize {
        let mut table = self.table();
        (0..EVICTED_AT_ONCE).map_while(|_| table.queues.of_all().first.filter(|first| table.cut(Some(*first)))).count()
    }

    #[cfg(test)]
    pub(in crate::doors) fn held(&self) -> usize {
        self.table().held
    }

    fn table(&self) -> MutexGuard<'_, SlotTable> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SlotTable {
    fn moment(&mut self) -> u64 {
        self.moments += 1;
        self.moments
    }

    fn insert(&mut self, number: u64, holder: SlotHolder) {
        self.queues.enter(&holder.claim, holder.turn(number));
        self.holders.insert(number, holder);
    }

    fn remove(&mut self, number: u64) -> Option<SlotHolder> {
        let holder = self.holders.remove(&number)?;
        self.queues.leave(&holder.claim, holder.turn(number));
        Some(holder)
    }

    /// Makes room for this claim; returns whether there is room. If the claim's key or network has used up its share,
    /// a connection of that key or network is evicted. Only an operator evicts an operator.
    fn make_room(&mut self, claim: &SlotClaim) -> bool {
        let (most, has_shares) = (self.most, self.has_shares);
        if has_shares {
            let is_made = self.bounded(most / PARTS, self.queues.of_key(claim))
                && (claim.network.is_loopback() || self.bounded(most / PARTS, self.queues.of_network(claim)))
                && (claim.is_operator() || self.bounded(most - most / KEPT, self.queues.of_others()));
            if !is_made {
                return false;
            }
        }
        let yielding = if !has_shares || claim.is_operator() { self.queues.of_all() } else { self.queues.of_others() };
        self.holders.len() < most || self.cut(yielding.first)
    }

    /// Ensures that one more connection of this kind fits within `most`, and evicts a connection if necessary.
    /// Returns false if no connection can be evicted.
    fn bounded(&mut self, most: usize, head: QueueHead) -> bool {
        head.many < most || self.cut(head.first)
    }

    /// Evicts a connection. Returns false if `turn` is `None` or the connection has gone.
    fn cut(&mut self, turn: Option<EvictionTurn>) -> bool {
        let Some(holder) = turn.and_then(|turn| self.remove(turn.number)) else { return false };
        holder.cut.notify_one();
        true
    }
}

impl SlotHolder {
    const fn turn(&self, number: u64) -> EvictionTurn {
        EvictionTurn { rank: self.claim.rank(), activity: self.activity(), since: self.since, number }
    }

    const fn activity(&self) -> Activity {
        match (self.is_receiving, self.is_watching, self.open) {
            (true, _, _) => Activity::Receiving,
            (false, true, _) => Activity::Watching,
            (false, false, 0) => Activity::Resting,
            (false, false, _) => Activity::Answering,
        }
    }
}

impl ConnectionSlot {
    /// Notes that the head of a request has arrived. While its body arrives slowly, the connection makes no progress.
    pub(in crate::doors) fn asked(&self, claim: SlotClaim, has_body: bool) {
        let mut is_another = false;
        self.change(true, |holder| {
            is_another = claim.who.is_some() && claim.who != holder.claim.who;
            (holder.claim, holder.is_receiving) = (claim.clone(), has_body);
            holder.open += 1;
        });
        if is_another {
            // A connection counts for the key that it used last. This key may now have more than its share.
            let mut table = self.slots.table();
            if table.has_shares {
                let (most, of_key) = (table.most / PARTS + 1, table.queues.of_key(&claim));
                table.bounded(most, of_key);
            }
        }
    }

    pub(in crate::doors) fn received(&self) {
        self.change(true, |holder| holder.is_receiving = false);
    }

    /// Notes that an endless answer begins. The connection is not evicted until the answer ends.
    pub(in crate::doors) fn watches(&self) {
        self.change(false, |holder| holder.is_watching = true);
    }

    /// Frees the slot of a connection that changes to another protocol. After that the connection is never evicted
    /// here.
    pub(in crate::doors) fn hands_over(&self) {
        let _ = self.slots.table().remove(self.number);
    }

    /// Notes progress: a part of an answer was taken for sending.
    pub(in crate::doors) fn sends(&self) {
        self.change(true, |_| {});
    }

    pub(in crate::doors) fn answered(&self) {
        self.change(true, |holder| {
            holder.open = holder.open.saturating_sub(1);
            holder.is_watching = false;
        });
    }

    fn change(&self, is_progress: bool, change: impl FnOnce(&mut SlotHolder)) {
        let mut table = self.slots.table();
        let now = table.moment();
        if let Some(mut holder) = table.remove(self.number) {
            change(&mut holder);
            if is_progress {
                holder.since = now;
            }
            table.insert(self.number, holder);
        }
    }
}

impl Drop for ConnectionSlot {
    fn drop(&mut self) {
        let mut table = self.slots.table();
        table.held -= 1;
        let _ = table.remove(self.number);
    }
}

#[cfg(test)]
mod tests;
