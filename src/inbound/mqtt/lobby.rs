//! Places for connections that have not said yet who they are: how many there are, how many one network may take, and whose is given to
//! a newcomer when there is none: that of the oldest. So however many flock in, everybody can say who he is (safety S9).

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::access::Network;

/// One network in so many parts of all places may have its part full; this machine itself is not so bounded.
const PARTS: usize = 4;

/// So many connections are cut at once when the system has no more descriptors: newcomers wait meanwhile, and files are to be
/// opened too.
const RELIEF: usize = 16;

/// All places. Cheap to clone.
#[derive(Clone)]
pub(super) struct Lobby(Arc<Mutex<Taken>>);

struct Taken {
    most: usize,
    given: u64,
    /// By the number of the place: who came first has the least.
    strangers: BTreeMap<u64, Stranger>,
}

struct Stranger {
    network: Network,
    cut: Arc<Notify>,
}

/// One connection's place; it is free again when this is dropped.
pub(super) struct Place {
    number: u64,
    lobby: Lobby,
    cut: Arc<Notify>,
}

impl Lobby {
    /// So many places, all free.
    pub(super) fn new(most: usize) -> Lobby {
        Lobby(Arc::new(Mutex::new(Taken { most, given: 0, strangers: BTreeMap::new() })))
    }

    /// A place for a connection from there; when none is free the oldest gives way.
    pub(super) fn take(&self, address: IpAddr) -> Place {
        let network = Network::of(address);
        let mut taken = self.taken();
        let of_network = taken.strangers.values().filter(|stranger| stranger.network == network).count();
        if !network.is_loopback() && of_network >= taken.most / PARTS {
            taken.cut(|stranger| stranger.network == network);
        }
        if taken.strangers.len() >= taken.most {
            taken.cut(|_| true);
        }
        taken.given += 1;
        let (number, cut) = (taken.given, Arc::new(Notify::new()));
        taken.strangers.insert(number, Stranger { network, cut: Arc::clone(&cut) });
        drop(taken);
        Place { number, lobby: self.clone(), cut }
    }

    /// Cuts some connections, when the system has no more descriptors, and says how many.
    pub(super) fn relieve(&self) -> usize {
        let mut taken = self.taken();
        (0..RELIEF).take_while(|_| taken.cut(|_| true)).count()
    }

    fn taken(&self) -> MutexGuard<'_, Taken> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Taken {
    /// Cuts the oldest of these; `false` when there is none.
    fn cut(&mut self, among: impl Fn(&Stranger) -> bool) -> bool {
        let first = self.strangers.iter().find(|(_, stranger)| among(stranger)).map(|(number, _)| *number);
        let Some(stranger) = first.and_then(|number| self.strangers.remove(&number)) else { return false };
        stranger.cut.notify_one();
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
        self.lobby.taken().strangers.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: [u8; 4] = [127, 0, 0, 1];
    const THERE: [u8; 4] = [192, 0, 2, 1];

    fn crowd(lobby: &Lobby, from: [u8; 4], count: usize) -> Vec<Place> {
        (0..count).map(|_| lobby.take(from.into())).collect()
    }

    async fn is_cut(place: &Place) -> bool {
        tokio::select! {
            biased;
            () = place.cut() => true,
            () = std::future::ready(()) => false,
        }
    }

    /// Safety S9.
    #[tokio::test]
    async fn the_oldest_gives_way_and_a_newcomer_has_as_long_as_all_before_him() {
        let lobby = Lobby::new(4);
        let before = crowd(&lobby, HERE, 4);
        let newcomer = lobby.take(HERE.into());
        let _flock = crowd(&lobby, HERE, 3);
        for place in &before {
            assert!(is_cut(place).await);
        }
        assert!(!is_cut(&newcomer).await);
    }

    /// Safety S9.
    #[tokio::test]
    async fn one_network_has_its_part_and_this_machine_has_all() {
        let lobby = Lobby::new(8);
        let ours = crowd(&lobby, HERE, 6);
        let theirs = crowd(&lobby, THERE, 3);
        assert!(is_cut(&theirs[0]).await && !is_cut(&theirs[1]).await && !is_cut(&ours[0]).await);
    }

    #[tokio::test]
    async fn a_system_without_descriptors_is_relieved_and_a_place_that_is_left_is_free() {
        let lobby = Lobby::new(20);
        let all = crowd(&lobby, HERE, 20);
        assert_eq!([lobby.relieve(), lobby.relieve(), lobby.relieve()], [RELIEF, 4, 0]);
        drop(all);
        let again = crowd(&lobby, HERE, 20);
        assert!(!is_cut(&again[0]).await);
    }
}
