//! Places for connections whose first request has come: their number, the maximum for one key or network, and who gives way to a
//! newcomer when all are taken: the connection with the least progress. Connections without a first request wait in the
//! `vestibule`.

mod queues;

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use queues::{Queues, Turn};

use crate::access::{Access, Caller, Network, Role};
use crate::doors::room::Room;
use crate::doors::vestibule::RELIEF;

/// Maximum number of open connections: every possible stream, and half as many again for requests. A process has 1,024
/// descriptors by default, and the vestibule, closing connections, the other doors and files need some too.
pub(super) const PLACES: usize = 640;

/// With keys, the largest share of all places for one key, and for one network other than this machine: one in this many.
const PARTS: usize = 4;

/// Share of places reserved for operators, who may not be connected yet: one in this many.
const KEPT: usize = 8;

/// Maximum number of cut connections that are not closed yet. They are closed on the threads that answer, which may be late:
/// beyond this number nobody is admitted, and as many again are allowed for whoever says STOP and for operators. This bounds what
/// a flood can cost.
const LEAVING: usize = 32;

/// All places of the door. Cheap to clone.
#[derive(Clone)]
pub(super) struct Places(Arc<Mutex<Occupancy>>);

struct Occupancy {
    most: usize,
    /// Maximum number of cut connections that are not closed yet.
    leaving: usize,
    has_shares: bool,
    /// Counts all events, so that an older one has the smaller number.
    moments: u64,
    /// Places in use, including those of cut connections that are not closed yet.
    held: usize,
    occupants: HashMap<u64, Occupant>,
    /// The order in which connections give way: searching all of them for each newcomer would delay STOPs of others.
    queues: Queues,
}

/// For whom a place is wanted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Claim {
    network: Network,
    /// `None` for strangers.
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
    /// Time of its last progress.
    since: u64,
    cut: Arc<Notify>,
}

/// What a connection is doing, in the order in which it gives way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Stage {
    Resting,
    /// A body is arriving, however slowly.
    Receiving,
    Answering,
    /// An endless answer: it does not give way, and there are fewer of them than places.
    Watching,
}

/// One connection's place, free again when this is dropped.
pub(super) struct Place {
    number: u64,
    places: Places,
}

impl Claim {
    /// The sender's claim from this address; a request without a key is a stranger's.
    pub(super) fn new(address: IpAddr, caller: Option<&Caller>) -> Claim {
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
    /// Creates `most` free places. Without keys there are no shares.
    pub(super) fn new(most: usize, room: Room, access: &Access) -> Places {
        let (most, leaving, has_shares) = (room.part(most), room.part(LEAVING), matches!(access, Access::Keys(_)));
        let (occupants, queues) = (HashMap::new(), Queues::default());
        Places(Arc::new(Mutex::new(Occupancy { most, leaving, has_shares, moments: 0, held: 0, occupants, queues })))
    }

    /// Takes a place. When none is free, another connection is told by `cut` to give its own up. `None` when nobody can give way,
    /// or too many cut connections are not closed yet.
    pub(super) fn take(&self, claim: Claim, says_stop: bool, cut: Arc<Notify>) -> Option<Place> {
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

    /// Cuts some connections that can give way, when the system has no more descriptors; returns their number.
    pub(super) fn relieve(&self) -> usize {
        let mut occupancy = self.occupancy();
        (0..RELIEF).map_while(|_| occupancy.queues.of_all().1.filter(|first| occupancy.cut(Some(*first)))).count()
    }

    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
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

    /// A key or network with a full share replaces one of its own connections, and only an operator may replace an operator.
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

    /// Whether there is room for one more among `most`, after cutting the first of them if necessary.
    fn bounded(&mut self, most: usize, (many, first): (usize, Option<Turn>)) -> bool {
        many < most || self.cut(first)
    }

    /// Applies the share of a key that a connection shows later: if the key has too many now, one of its connections is cut.
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
    /// Its position in the order of giving way.
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
    /// A head has come, with or without a body. A body that comes slowly is no progress.
    pub(super) fn asked(&self, claim: Claim, has_body: bool) {
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

    pub(super) fn received(&self) {
        self.change(true, |occupant| occupant.is_receiving = false);
    }

    pub(super) fn watches(&self) {
        self.change(false, |occupant| occupant.is_watching = true);
    }

    /// The connection changes to another protocol: its place is free, and it need not be cut any more.
    pub(super) fn hands_over(&self) {
        let _ = self.places.occupancy().rise(self.number);
    }

    /// A part of an answer was accepted for sending.
    pub(super) fn sends(&self) {
        self.change(true, |_| {});
    }

    pub(super) fn answered(&self) {
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
#[path = "places_tests.rs"]
mod tests;
