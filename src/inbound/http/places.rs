//! Places for connections that have said what they want: how many there are, how many of them one key or one network may have,
//! and who gives way to a newcomer when there is none: whoever makes least progress. Those who have said nothing yet wait in the
//! `vestibule`.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::access::{Access, Caller, Network, Role};
use crate::inbound::room::Room;
use crate::inbound::vestibule::RELIEF;

/// Connections open at once: every stream there may be, and half as many again for requests beside them. A process has 1,024
/// descriptors by default, and the vestibule, those who linger, the other doors and files need some too.
pub(super) const PLACES: usize = 640;

/// Where keys tell people apart, one key, and one network but this machine itself, has one in so many of all places,
const PARTS: usize = 4;

/// and one in so many is kept for operators, who may not be there yet.
const KEPT: usize = 8;

/// A connection that was cut is closed where answers are made, which may be late: so many may be on their way out before nobody else is
/// let in, and as many again for whoever says STOP and for operators. So what a flood opens and loses costs no more than this.
const LEAVING: usize = 32;

/// All places of the door. Cheap to clone.
#[derive(Clone)]
pub(super) struct Places(Arc<Mutex<Taken>>);

struct Taken {
    most: usize,
    /// How many of those who were cut may be on their way out.
    leaving: usize,
    has_shares: bool,
    /// Counts everything that happens here, so that what is older has the lesser number.
    moments: u64,
    /// Places that were given and not left, those that were cut included.
    held: usize,
    seats: HashMap<u64, Seat>,
}

/// For whom a place is wanted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Claim {
    network: Network,
    /// The name of the key, and whether it is an operator's; nothing of strangers.
    who: Option<(Arc<str>, bool)>,
}

struct Seat {
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
pub(super) struct Place {
    number: u64,
    places: Places,
}

impl Claim {
    /// Whoever asks from there; nobody is known by a request without a key.
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

    fn has_key_of(&self, other: &Claim) -> bool {
        self.who.is_some() && self.who == other.who
    }
}

impl Places {
    /// So many places, all free. Where nobody signs in there are no shares.
    pub(super) fn new(most: usize, room: Room, access: &Access) -> Places {
        let (most, leaving, has_shares) = (room.part(most), room.part(LEAVING), matches!(access, Access::Keys(_)));
        Places(Arc::new(Mutex::new(Taken { most, leaving, has_shares, moments: 0, held: 0, seats: HashMap::new() })))
    }

    /// A place; somebody else's, who is told by `cut`, when none is free. `None` when nobody can give way, or too many who had to have
    /// not gone yet.
    pub(super) fn take(&self, claim: Claim, says_stop: bool, cut: Arc<Notify>) -> Option<Place> {
        let mut taken = self.taken();
        let is_heeded = says_stop || taken.has_shares && claim.is_operator();
        let leaving = if is_heeded { 2 * taken.leaving } else { taken.leaving };
        if taken.held >= taken.most + leaving || !taken.make_room(&claim) {
            return None;
        }
        taken.held += 1;
        let number = taken.moment();
        let seat = Seat { claim, open: 0, is_receiving: false, is_watching: false, since: number, cut };
        taken.seats.insert(number, seat);
        drop(taken);
        Some(Place { number, places: self.clone() })
    }

    /// Cuts some connections that can give way, when the system has no more descriptors, and says how many.
    pub(super) fn relieve(&self) -> usize {
        let mut taken = self.taken();
        (0..RELIEF).take_while(|_| taken.cut(|_| true)).count()
    }

    /// Places that were given and not left.
    #[cfg(test)]
    pub(super) fn held(&self) -> usize {
        self.taken().held
    }

    fn taken(&self) -> MutexGuard<'_, Taken> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Taken {
    fn moment(&mut self) -> u64 {
        self.moments += 1;
        self.moments
    }

    /// Whoever has his share full takes the place of one of his own, and nobody but an operator takes an operator's.
    fn make_room(&mut self, claim: &Claim) -> bool {
        let (most, has_shares) = (self.most, self.has_shares);
        if has_shares {
            let of_key = |seat: &Seat| seat.claim.has_key_of(claim);
            let of_network = |seat: &Seat| seat.claim.network == claim.network;
            let of_all = |seat: &Seat| !seat.claim.is_operator();
            let is_made = self.bounded(most / PARTS, of_key)
                && (claim.network.is_loopback() || self.bounded(most / PARTS, of_network))
                && (claim.is_operator() || self.bounded(most - most / KEPT, of_all));
            if !is_made {
                return false;
            }
        }
        self.seats.len() < most || self.cut(|seat| !has_shares || claim.is_operator() || !seat.claim.is_operator())
    }

    /// Whether there is room for one more of these, after one of them gave way if need be.
    fn bounded(&mut self, most: usize, of_these: impl Fn(&Seat) -> bool) -> bool {
        self.seats.values().filter(|seat| of_these(seat)).count() < most || self.cut(of_these)
    }

    /// A connection has shown another key than before: when there are too many of that now, one of them gives way.
    fn keep_share(&mut self, claim: &Claim) {
        let of_key = |seat: &Seat| seat.claim.has_key_of(claim);
        if self.has_shares && self.seats.values().filter(|seat| of_key(seat)).count() > self.most / PARTS {
            self.cut(of_key);
        }
    }

    /// Cuts the connection that gives way first among these; `false` when none does. Strangers go before anybody else, and
    /// operators go last.
    fn cut(&mut self, among: impl Fn(&Seat) -> bool) -> bool {
        let yielding = self.seats.iter().filter(|(_, seat)| seat.stage() != Stage::Watching && among(seat));
        let first = yielding.min_by_key(|(_, seat)| (seat.claim.rank(), seat.stage(), seat.since));
        let Some(seat) = first.map(|(number, _)| *number).and_then(|number| self.seats.remove(&number)) else { return false };
        seat.cut.notify_one();
        true
    }
}

impl Seat {
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
    pub(super) fn asked(&self, claim: Claim, has_body: bool) {
        let mut is_another = false;
        self.change(true, |seat| {
            is_another = claim.who.is_some() && claim.who != seat.claim.who;
            (seat.claim, seat.is_receiving) = (claim.clone(), has_body);
            seat.open += 1;
        });
        if is_another {
            self.places.taken().keep_share(&claim);
        }
    }

    /// The whole body has come.
    pub(super) fn received(&self) {
        self.change(true, |seat| seat.is_receiving = false);
    }

    /// The answer to a request has no end.
    pub(super) fn watches(&self) {
        self.change(false, |seat| seat.is_watching = true);
    }

    /// The connection speaks another protocol from now on: its place is free, and nobody needs to cut it.
    pub(super) fn hands_over(&self) {
        let _ = self.places.taken().seats.remove(&self.number);
    }

    /// Something of an answer was taken to be sent.
    pub(super) fn sends(&self) {
        self.change(true, |_| {});
    }

    /// A request is over.
    pub(super) fn answered(&self) {
        self.change(true, |seat| {
            seat.open = seat.open.saturating_sub(1);
            seat.is_watching = false;
        });
    }

    fn change(&self, is_progress: bool, change: impl FnOnce(&mut Seat)) {
        let mut taken = self.places.taken();
        let now = taken.moment();
        if let Some(seat) = taken.seats.get_mut(&self.number) {
            change(seat);
            if is_progress {
                seat.since = now;
            }
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let mut taken = self.places.taken();
        taken.held -= 1;
        taken.seats.remove(&self.number);
    }
}

#[cfg(test)]
#[path = "places_tests.rs"]
mod tests;
