//! Where connections are without a place, as long as they have not said who they are or get no further answer: so many at once, and
//! the oldest of whichever network has most of them gives way. So a newcomer is heard however many flock in, and longer than all of
//! a crowd (safety S9). Who gets a place, is each door's own matter.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::access::Network;

/// So many connections are cut at once when the system has no more descriptors: newcomers wait, and files are to be opened.
pub(super) const RELIEF: usize = 16;

/// The places before all places of a door. Cheap to clone.
#[derive(Clone)]
pub(in crate::doors) struct Vestibule(Arc<Mutex<Crowd>>);

struct Crowd {
    most: usize,
    entered: u64,
    /// In the order in which they came,
    waiting: BTreeMap<u64, (Network, Arc<Notify>)>,
    /// and how many of them each network has.
    networks: HashMap<Network, usize>,
}

/// A connection that waits; its room is free again when this is dropped.
pub(in crate::doors) struct Waiting {
    number: u64,
    vestibule: Vestibule,
    cut: Arc<Notify>,
}

impl Vestibule {
    pub(in crate::doors) fn new(most: usize) -> Vestibule {
        Vestibule(Arc::new(Mutex::new(Crowd { most, entered: 0, waiting: BTreeMap::new(), networks: HashMap::new() })))
    }

    /// Lets a connection from there wait, which is told by `cut` when it has to make room.
    pub(in crate::doors) fn enter(&self, address: IpAddr, cut: Arc<Notify>) -> Waiting {
        let mut crowd = self.crowd();
        if crowd.waiting.len() >= crowd.most {
            crowd.cut();
        }
        crowd.entered += 1;
        let (number, network) = (crowd.entered, Network::of(address));
        crowd.waiting.insert(number, (network, Arc::clone(&cut)));
        *crowd.networks.entry(network).or_default() += 1;
        drop(crowd);
        Waiting { number, vestibule: self.clone(), cut }
    }

    /// Lets a connection from there do its `last`, until that is done or it has to make room.
    pub(in crate::doors) async fn linger(&self, address: IpAddr, last: impl Future<Output = ()>) {
        let waiting = self.enter(address, Arc::default());
        tokio::select! {
            biased;
            () = last => {}
            () = waiting.cut() => {}
        }
    }

    /// Cuts some connections, when the system has no more descriptors, and says how many.
    pub(in crate::doors) fn relieve(&self) -> usize {
        let mut crowd = self.crowd();
        (0..RELIEF).take_while(|_| crowd.cut()).count()
    }

    fn crowd(&self) -> MutexGuard<'_, Crowd> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Crowd {
    /// Cuts whoever gives way first; `false` when nobody is here.
    fn cut(&mut self) -> bool {
        let most = self.networks.values().max();
        let oldest = self.waiting.iter().find(|(_, (network, _))| self.networks.get(network) == most);
        let Some(cut) = oldest.map(|(number, _)| *number).and_then(|oldest| self.remove(oldest)) else { return false };
        cut.notify_one();
        true
    }

    fn remove(&mut self, number: u64) -> Option<Arc<Notify>> {
        let (network, cut) = self.waiting.remove(&number)?;
        if let Entry::Occupied(mut left) = self.networks.entry(network) {
            *left.get_mut() -= 1;
            if *left.get() == 0 {
                left.remove();
            }
        }
        Some(cut)
    }
}

impl Waiting {
    /// Leaves for a place; `false` when it had to make room before.
    pub(in crate::doors) fn leave(self) -> bool {
        self.vestibule.crowd().remove(self.number).is_some()
    }

    /// Waits until it has to make room.
    pub(in crate::doors) async fn cut(&self) {
        self.cut.notified().await;
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        let _ = self.vestibule.crowd().remove(self.number);
    }
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt;

    use super::*;
    use crate::runtime::within::within;

    fn crowd<'a>(vestibule: &Vestibule, from: impl IntoIterator<Item = &'a str>) -> Vec<Waiting> {
        from.into_iter().map(|address| vestibule.enter(address.parse().unwrap(), Arc::default())).collect()
    }

    /// Who had to make room.
    fn gone(crowd: &[Waiting]) -> Vec<usize> {
        (0..crowd.len()).filter(|number| crowd[*number].cut().now_or_never().is_some()).collect()
    }

    /// Safety S9.
    #[test]
    fn the_oldest_of_the_largest_crowd_makes_room() {
        let vestibule = Vestibule::new(4);
        let all = crowd(&vestibule, ["192.0.2.1", "192.0.2.7", "192.0.2.7", "192.0.2.7", "192.0.2.9", "192.0.2.10"]);
        assert_eq!(gone(&all), [1, 2]);
        assert_eq!(vestibule.crowd().waiting.len(), 4);
        drop(all);
        let crowd = vestibule.crowd();
        assert!(crowd.waiting.is_empty() && crowd.networks.is_empty(), "whoever leaves is not counted");
    }

    /// Safety S9: an attacker with many addresses drives nobody away sooner than his own that are older.
    #[test]
    fn of_crowds_that_are_equally_large_the_oldest_makes_room() {
        let vestibule = Vestibule::new(4);
        let from = ["192.0.2.5", "192.0.2.1", "192.0.2.8", "192.0.2.2", "192.0.2.9", "192.0.2.3", "192.0.2.7"];
        assert_eq!(gone(&crowd(&vestibule, from)), [0, 1, 2]);
    }

    /// Safety S9.
    #[test]
    fn whoever_comes_from_elsewhere_is_not_driven_away_by_a_crowd() {
        let vestibule = Vestibule::new(4);
        let before = crowd(&vestibule, ["127.0.0.1"; 4]);
        let newcomer = crowd(&vestibule, ["192.0.2.1"]);
        let flock = crowd(&vestibule, ["127.0.0.1"; 20]);
        assert_eq!((gone(&before).len(), gone(&newcomer).len(), gone(&flock).len()), (4, 0, 17));
    }

    /// Safety A5.
    #[tokio::test]
    async fn whoever_lingers_does_so_until_it_is_done_or_has_to_make_room() {
        let vestibule = Vestibule::new(1);
        let address = "192.0.2.1".parse().unwrap();
        vestibule.linger(address, std::future::ready(())).await;
        let endless = tokio::spawn({
            let vestibule = vestibule.clone();
            async move { vestibule.linger(address, std::future::pending()).await }
        });
        tokio::task::yield_now().await;
        assert!(!endless.is_finished());
        let _newcomer = vestibule.enter(address, Arc::default());
        within("it makes room", endless).await.unwrap();
    }

    #[test]
    fn a_system_without_descriptors_is_relieved_and_whoever_goes_on_leaves_room() {
        let vestibule = Vestibule::new(20);
        let all = crowd(&vestibule, ["127.0.0.1"; 20]);
        assert_eq!([vestibule.relieve(), vestibule.relieve(), vestibule.relieve()], [RELIEF, 4, 0]);
        drop(all);
        let again = crowd(&vestibule, ["127.0.0.1"; 20]);
        assert!(gone(&again).is_empty());
        drop(again);
        assert!(vestibule.crowd().waiting.is_empty());
    }
}
