//! Places for connections that have said what they want: how many there are, how many of them one key or one network may have,
//! and who gives way to a newcomer when there is none: whoever makes least progress. Those who have said nothing yet wait in the
//! `pending_connections`.

mod eviction_queues;

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use eviction_queues::{Queues, Turn};

use super::connection_budget::ConnectionBudget;
use super::pending_connections::EVICTED_AT_ONCE;
use crate::access::{Access, Caller, Network, Role};

/// Connections open at once: every stream there may be, and half as many again for requests beside them. A process has 1,024
/// descriptors by default, and pending connections, those who linger, the other doors and files need some too.
pub(in crate::doors) const PLACES: usize = 640;

/// Where keys tell people apart, one key, and one network but this machine itself, has one in so many of all places,
const PARTS: usize = 4;

/// and one in so many is kept for operators, who may not be there yet.
const KEPT: usize = 8;

/// A connection that was cut is closed where answers are made, which may be late: so many may be on their way out before nobody else is
/// let in, and as many again for whoever says STOP and for operators. So what a flood opens and loses costs no more than this.
const LEAVING: usize = 32;

/// All places of the door. Cheap to clone.
#[derive(Clone)]
pub(in crate::doors) struct Places(Arc<Mutex<Occupancy>>);

struct Occupancy {
    most: usize,
    /// How many of those who were cut may be on their way out.
    leaving: usize,
    has_shares: bool,
    /// Counts everything that happens here, so that what is older has the lesser number.
    moments: u64,
    /// Places that were given and not left, those that were cut included.
    held: usize,
    occupants: HashMap<u64, Occupant>,
    /// The order in which they give way: looking through all of them for each newcomer would keep STOPs of others waiting.
    queues: Queues,
}

/// For whom a place is wanted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::doors) struct Claim {
    network: Network,
    /// Nothing of strangers.
    who: Option<Who>,
}

/// The name of a key, and whether it is an operator's.
type Who = (Arc<str>, bool);

struct Occupant {
    claim: Claim,
    /// Requests whose heads have come and that are not answered.
    open: u64,
    is_receiving: bool,
    is_watching: bool,
    /// When it last came further.
    since: u64,
    cut: Arc<Notify>,
}

/// What a connection is doing, in the order in which it gives way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    Resting,
    /// A body is on its way, however slowly.
    Receiving,
    Answering,
    /// An endless answer: it does not give way, and there are fewer of them than places.
    Watching,
}

/// One connection's place; it is free again when this is dropped.
pub(in crate::doors) struct Place {
    number: u64,
    places: Places,
}

impl Claim {
    /// Whoever asks from there; nobody is known by a request without a key.
    pub(in crate::doors) fn new(address: IpAddr, caller: Option<&Caller>) -> Claim {
        let who = caller.map(|caller| (caller.name(), caller.role() == Role::Operator));
        Claim { network: Network::of(address), who }
    }

    fn is_operator(&self) -> bool {
        self.who.as_ref().is_some_and(|(_, is_operator)| *is_operator)
    }

    /// Strangers, then viewers, then operators.
    const fn rank(&self) -> u8 {
        match &self.who {
            None => 0,
            Some((_, false)) => 1,
            Some((_, true)) => 2,
        }
    }
}

impl Places {
    /// So many places, all free. Where nobody signs in there are no shares.
    pub(in crate::doors) fn new(most: usize, budget: ConnectionBudget, access: &Access) -> Places {
        let (most, leaving, has_shares) = (budget.scaled(most), budget.scaled(LEAVING), matches!(access, Access::Keys(_)));
        let (occupants, queues) = (HashMap::new(), Queues::default());
        Places(Arc::new(Mutex::new(Occupancy { most, leaving, has_shares, moments: 0, held: 0, occupants, queues })))
    }

    /// A place; somebody else's, who is told by `cut`, when none is free. `None` when nobody can give way, or too many who had to have
    /// not gone yet.
    pub(in crate::doors) fn take(&self, claim: Claim, says_stop: bool, cut: Arc<Notify>) -> Option<Place> {
        let mut occupancy = self.occupancy();
        let is_heeded = says_stop || occupancy.has_shares && claim.is_operator();
        let leaving = if is_heeded { 2 * occupancy.leaving } else { occupancy.leaving };
        if occupancy.held >= occupancy.most + leaving || !occupancy.make_room(&claim) {
            return None;
        }
        occupancy.held += 1;
        let number = occupancy.moment();
        let occupant = Occupant { claim, open: 0, is_receiving: false, is_watching: false, since: number, cut };
        occupancy.sit(number, occupant);
        drop(occupancy);
        Some(Place { number, places: self.clone() })
    }

    /// Cuts some connections that can give way, when the system has no more descriptors, and says how many.
    pub(in crate::doors) fn evict_some(&self) -> usize {
        let mut occupancy = self.occupancy();
        (0..EVICTED_AT_ONCE).map_while(|_| occupancy.queues.of_all().1.filter(|first| occupancy.cut(Some(*first)))).count()
    }

    #[cfg(test)]
    pub(in crate::doors) fn held(&self) -> usize {
        self.occupancy().held
    }

    fn occupancy(&self) -> MutexGuard<'_, Occupancy> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Occupancy {
    fn moment(&mut self) -> u64 {
        self.moments += 1;
        self.moments
    }

    fn sit(&mut self, number: u64, occupant: Occupant) {
        self.queues.enter(&occupant.claim, occupant.turn(number));
        self.occupants.insert(number, occupant);
    }

    fn rise(&mut self, number: u64) -> Option<Occupant> {
        let occupant = self.occupants.remove(&number)?;
        self.queues.leave(&occupant.claim, occupant.turn(number));
        Some(occupant)
    }

    /// Whoever has his share full takes the place of one of his own, and nobody but an operator takes an operator's.
    fn make_room(&mut self, claim: &Claim) -> bool {
        let (most, has_shares) = (self.most, self.has_shares);
        if has_shares {
            let is_made = self.bounded(most / PARTS, self.queues.of_key(claim))
                && (claim.network.is_loopback() || self.bounded(most / PARTS, self.queues.of_network(claim)))
                && (claim.is_operator() || self.bounded(most - most / KEPT, self.queues.of_others()));
            if !is_made {
                return false;
            }
        }
        let (_, first) = if !has_shares || claim.is_operator() { self.queues.of_all() } else { self.queues.of_others() };
        self.occupants.len() < most || self.cut(first)
    }

    /// Whether there is room for one more of so many, after the first of them gave way if need be.
    fn bounded(&mut self, most: usize, (many, first): (usize, Option<Turn>)) -> bool {
        many < most || self.cut(first)
    }

    /// A connection has shown another key than before: when there are too many of that now, one of them gives way.
    fn keep_share(&mut self, claim: &Claim) {
        if self.has_shares {
            self.bounded(self.most / PARTS + 1, self.queues.of_key(claim));
        }
    }

    /// Cuts this connection; `false` when there is none.
    fn cut(&mut self, turn: Option<Turn>) -> bool {
        let Some(occupant) = turn.and_then(|turn| self.rise(turn.number)) else { return false };
        occupant.cut.notify_one();
        true
    }
}

impl Occupant {
    /// When it gives way, under this number.
    const fn turn(&self, number: u64) -> Turn {
        Turn { rank: self.claim.rank(), stage: self.stage(), since: self.since, number }
    }

    const fn stage(&self) -> Stage {
        match (self.is_receiving, self.is_watching, self.open) {
            (true, _, _) => Stage::Receiving,
            (false, true, _) => Stage::Watching,
            (false, false, 0) => Stage::Resting,
            (false, false, _) => Stage::Answering,
        }
    }
}

impl Place {
    /// A head has come, whose body follows or not. A body that comes slowly is no progress.
    pub(in crate::doors) fn asked(&self, claim: Claim, has_body: bool) {
        let mut is_another = false;
        self.change(true, |occupant| {
            is_another = claim.who.is_some() && claim.who != occupant.claim.who;
            (occupant.claim, occupant.is_receiving) = (claim.clone(), has_body);
            occupant.open += 1;
        });
        if is_another {
            self.places.occupancy().keep_share(&claim);
        }
    }

    pub(in crate::doors) fn received(&self) {
        self.change(true, |occupant| occupant.is_receiving = false);
    }

    /// The answer to a request has no end.
    pub(in crate::doors) fn watches(&self) {
        self.change(false, |occupant| occupant.is_watching = true);
    }

    /// The connection speaks another protocol from now on: its place is free, and nobody needs to cut it.
    pub(in crate::doors) fn hands_over(&self) {
        let _ = self.places.occupancy().rise(self.number);
    }

    /// Something of an answer was taken to be sent.
    pub(in crate::doors) fn sends(&self) {
        self.change(true, |_| {});
    }

    pub(in crate::doors) fn answered(&self) {
        self.change(true, |occupant| {
            occupant.open = occupant.open.saturating_sub(1);
            occupant.is_watching = false;
        });
    }

    fn change(&self, is_progress: bool, change: impl FnOnce(&mut Occupant)) {
        let mut occupancy = self.places.occupancy();
        let now = occupancy.moment();
        if let Some(mut occupant) = occupancy.rise(self.number) {
            change(&mut occupant);
            if is_progress {
                occupant.since = now;
            }
            occupancy.sit(self.number, occupant);
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut occupancy = self.places.occupancy();
        occupancy.held -= 1;
        let _ = occupancy.rise(self.number);
    }
}

#[cfg(test)]
mod tests;
