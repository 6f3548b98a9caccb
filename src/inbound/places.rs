//! Places for connections that have not said who they are: how many there are, how many one network may take, and whose is given to a
//! newcomer when there is none: the oldest. So strangers who hold connections keep nobody's STOP waiting.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::access::Network;

/// One network in so many parts of all places may have its part full; this machine itself is not so bounded.
const PARTS: usize = 4;

/// So many connections are cut at once when the system has no more descriptors: newcomers wait meanwhile, and files are to be
/// opened too.
const RELIEF: usize = 16;

/// All places of a door. Cheap to clone.
#[derive(Clone)]
pub(super) struct Places(Arc<Mutex<Taken>>);

struct Taken {
    most: usize,
    /// Counts everything that happens here, so that what is older has the lesser number.
    moments: u64,
    seats: HashMap<u64, Seat>,
}

struct Seat {
    network: Network,
    /// When it was taken.
    since: u64,
    cut: Arc<Notify>,
}

/// One connection's place; it is free again when this is dropped.
pub(super) struct Place {
    number: u64,
    places: Places,
    cut: Arc<Notify>,
}

impl Places {
    /// So many places, all free.
    pub(super) fn new(most: usize) -> Places {
        Places(Arc::new(Mutex::new(Taken { most, moments: 0, seats: HashMap::new() })))
    }

    /// A place for a connection from there; somebody else's when none is free. `None` when nobody can give way.
    pub(super) fn take(&self, address: IpAddr) -> Option<Place> {
        let network = Network::of(address);
        let mut taken = self.taken();
        let of_network = taken.seats.values().filter(|seat| seat.network == network).count();
        let is_full = !network.is_loopback() && of_network >= taken.most / PARTS;
        if is_full && !taken.cut(|seat| seat.network == network) {
            return None;
        }
        if taken.seats.len() >= taken.most && !taken.cut(|_| true) {
            return None;
        }
        let (number, cut) = (taken.moment(), Arc::new(Notify::new()));
        taken.seats.insert(number, Seat { network, since: number, cut: Arc::clone(&cut) });
        drop(taken);
        Some(Place { number, places: self.clone(), cut })
    }

    /// Cuts some connections that can give way, when the system has no more descriptors, and says how many.
    pub(super) fn relieve(&self) -> usize {
        let mut taken = self.taken();
        (0..RELIEF).take_while(|_| taken.cut(|_| true)).count()
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

    /// Cuts the connection that gives way first among these; `false` when none does.
    fn cut(&mut self, among: impl Fn(&Seat) -> bool) -> bool {
        let yielding = self.seats.iter().filter(|(_, seat)| among(seat));
        let first = yielding.min_by_key(|(_, seat)| seat.since).map(|(number, _)| *number);
        let Some(seat) = first.and_then(|number| self.seats.remove(&number)) else { return false };
        seat.cut.notify_one();
        true
    }
}

impl Place {
    /// Waits until a newcomer has been given this place.
    pub(super) async fn cut(&self) {
        self.cut.notified().await;
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.taken().seats.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: [u8; 4] = [127, 0, 0, 1];
    const THERE: [u8; 4] = [192, 0, 2, 1];

    fn taken(places: &Places, from: [u8; 4]) -> Option<Arc<Place>> {
        places.take(from.into()).map(Arc::new)
    }

    async fn is_cut(place: &Place) -> bool {
        tokio::select! {
            biased;
            () = place.cut() => true,
            () = std::future::ready(()) => false,
        }
    }

    /// Safety A5, S9.
    #[tokio::test]
    async fn the_oldest_gives_way_and_a_newcomer_has_time_to_say_who_he_is() {
        let places = Places::new(8);
        let strangers: Vec<_> = (0..8).map(|_| taken(&places, HERE).unwrap()).collect();
        let newcomer = taken(&places, HERE).unwrap();
        assert!(is_cut(&strangers[0]).await && !is_cut(&strangers[1]).await);
        let _flock: Vec<_> = (0..7).map(|_| taken(&places, HERE).unwrap()).collect();
        assert!(!is_cut(&newcomer).await, "those before him went first");
    }

    /// Safety A5, S9.
    #[tokio::test]
    async fn one_network_has_its_part_and_this_machine_has_all() {
        let places = Places::new(8);
        let theirs: Vec<_> = (0..2).map(|_| taken(&places, THERE).unwrap()).collect();
        let third = taken(&places, THERE).expect("the oldest of its own gives way");
        assert!(is_cut(&theirs[0]).await && !is_cut(&theirs[1]).await);
        let ours: Vec<_> = (0..6).map(|_| taken(&places, HERE).unwrap()).collect();
        assert!(!is_cut(&ours[0]).await && !is_cut(&third).await, "nobody had to give way");
    }

    #[tokio::test]
    async fn a_place_that_is_left_is_free() {
        let places = Places::new(1);
        for _ in 0..3 {
            let place = taken(&places, HERE).unwrap();
            assert!(!is_cut(&place).await);
        }
        assert_eq!(places.relieve(), 0, "nobody is here");
    }

    #[tokio::test]
    async fn a_system_without_descriptors_is_relieved() {
        let places = Places::new(40);
        let _all: Vec<_> = (0..20).map(|_| taken(&places, HERE).unwrap()).collect();
        assert_eq!([places.relieve(), places.relieve(), places.relieve()], [RELIEF, 4, 0]);
    }
}
