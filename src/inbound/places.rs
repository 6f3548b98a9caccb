//! Places for connections: how many there are, how many one network may take, and whose is given to a newcomer when there is
//! none: of those of strangers, the one in which nothing has happened for longest. A request of somebody who was let in gives
//! way to nobody, and a newcomer has time to say who he is; so strangers who hold connections keep nobody's STOP waiting.

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
    /// Whether a request of somebody who was let in is under way.
    is_known: bool,
    /// When anything last happened in it.
    since: u64,
    cut: Arc<Notify>,
}

/// One connection's place; it is free again when this is dropped.
pub(super) struct Place {
    number: u64,
    places: Places,
    cut: Arc<Notify>,
}

/// A request under way in a place; when it is dropped the connection rests.
pub(super) struct Request(Arc<Place>);

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
        taken.seats.insert(number, Seat { network, is_known: false, since: number, cut: Arc::clone(&cut) });
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
        let yielding = self.seats.iter().filter(|(_, seat)| !seat.is_known && among(seat));
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

    /// A request has begun; of whom is not known yet.
    pub(super) fn begin(self: &Arc<Place>) -> Request {
        self.happens(false);
        Request(Arc::clone(self))
    }

    /// Whoever asks was let in.
    pub(super) fn known(&self) {
        self.happens(true);
    }

    fn happens(&self, is_known: bool) {
        let mut taken = self.places.taken();
        let since = taken.moment();
        if let Some(seat) = taken.seats.get_mut(&self.number) {
            (seat.is_known, seat.since) = (is_known, since);
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.places.taken().seats.remove(&self.number);
    }
}

impl Drop for Request {
    fn drop(&mut self) {
        self.0.happens(false);
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

    /// Safety A5.
    #[tokio::test]
    async fn the_stranger_in_whose_place_nothing_happened_for_longest_gives_way() {
        let places = Places::new(4);
        let all: Vec<_> = (0..4).map(|_| taken(&places, HERE).unwrap()).collect();
        let known = all[0].begin();
        all[0].known();
        let _stranger = all[1].begin();
        for gives_way in [&all[2], &all[3], &all[1]] {
            assert!(!is_cut(gives_way).await);
            let newcomer = taken(&places, HERE).expect("somebody gives way");
            assert!(is_cut(gives_way).await);
            std::mem::forget((newcomer.begin(), newcomer.known()));
        }
        assert!(taken(&places, HERE).is_none(), "everybody left is known");
        drop(known);
        assert!(taken(&places, HERE).is_some(), "who was known rests now");
    }

    /// Safety A5, S1.
    #[tokio::test]
    async fn a_newcomer_has_time_to_say_who_he_is_while_others_flock_in() {
        let places = Places::new(8);
        let strangers: Vec<_> = (0..8).map(|_| taken(&places, HERE).unwrap()).collect();
        let asked: Vec<_> = strangers.iter().map(Place::begin).collect();
        let newcomer = taken(&places, HERE).unwrap();
        let flock: Vec<_> = (0..7).map(|_| taken(&places, HERE).unwrap()).collect();
        assert!(!is_cut(&newcomer).await, "those before him went first");
        newcomer.known();
        let _more: Vec<_> = (0..100).map(|_| taken(&places, HERE).unwrap()).collect();
        assert!(!is_cut(&newcomer).await);
        drop((asked, flock));
    }

    /// Safety A5.
    #[tokio::test]
    async fn one_network_has_its_part_and_this_machine_has_all() {
        let places = Places::new(8);
        let theirs: Vec<_> = (0..2).map(|_| taken(&places, THERE).unwrap()).collect();
        let third = taken(&places, THERE).expect("the oldest of its own gives way");
        assert!(is_cut(&theirs[0]).await && !is_cut(&theirs[1]).await);
        let requests = [theirs[1].begin(), third.begin()];
        theirs[1].known();
        third.known();
        assert!(taken(&places, THERE).is_none(), "its part is full of people who are known");
        let ours: Vec<_> = (0..6).map(|_| taken(&places, HERE).unwrap()).collect();
        assert!(!is_cut(&ours[0]).await, "nobody had to give way");
        drop(requests);
    }

    #[tokio::test]
    async fn a_system_without_descriptors_is_relieved_of_strangers_only() {
        let places = Places::new(40);
        let all: Vec<_> = (0..40).map(|_| taken(&places, HERE).unwrap()).collect();
        let requests: Vec<_> = all.iter().take(20).map(Place::begin).collect();
        all.iter().take(20).for_each(|place| place.known());
        assert_eq!([places.relieve(), places.relieve(), places.relieve()], [RELIEF, 4, 0]);
        drop(requests);
    }

    #[tokio::test]
    async fn a_place_that_is_left_is_free() {
        let places = Places::new(1);
        for _ in 0..3 {
            let place = taken(&places, HERE).unwrap();
            std::mem::drop(place.begin());
            assert!(!is_cut(&place).await);
        }
        assert_eq!(places.relieve(), 0, "nobody is here");
    }
}
