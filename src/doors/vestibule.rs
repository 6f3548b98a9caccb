//! Connections that have not introduced themselves yet, or get no further answer: a bounded number, of which the oldest from the
//! network with the most gives way. So a newcomer is heard however many arrive, and longer than all connections of a crowd
//! (safety S9). Each door decides who gets a place afterwards.

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::access::Network;

/// Number of connections cut at once when the system has no more descriptors: newcomers wait, and files have to be opened.
pub(super) const RELIEF: usize = 16;

/// The waiting connections of a door. Cheap to clone.
#[derive(Clone)]
pub(super) struct Vestibule(Arc<Mutex<Crowd>>);

struct Crowd {
    most: usize,
    entered: u64,
    /// By order of arrival.
    waiting: BTreeMap<u64, (Network, Arc<Notify>)>,
    /// Number of waiting connections of each network.
    networks: HashMap<Network, usize>,
}

/// A waiting connection; its room is free again when this is dropped.
pub(super) struct Waiting {
    number: u64,
    vestibule: Vestibule,
    cut: Arc<Notify>,
}

impl Vestibule {
    pub(super) fn new(most: usize) -> Vestibule {
        Vestibule(Arc::new(Mutex::new(Crowd { most, entered: 0, waiting: BTreeMap::new(), networks: HashMap::new() })))
    }

    /// Lets a connection from this address wait; `cut` is notified when it has to make room.
    pub(super) fn enter(&self, address: IpAddr, cut: Arc<Notify>) -> Waiting {
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

    /// Lets a connection from this address complete `last`, unless it has to make room first.
    pub(super) async fn linger(&self, address: IpAddr, last: impl Future<Output = ()>) {
        let waiting = self.enter(address, Arc::default());
        tokio::select! {
            biased;
            () = last => {}
            () = waiting.cut() => {}
        }
    }

    /// Cuts some connections when the system has no more descriptors; returns their number.
    pub(super) fn relieve(&self) -> usize {
        let mut crowd = self.crowd();
        (0..RELIEF).take_while(|_| crowd.cut()).count()
    }

    fn crowd(&self) -> MutexGuard<'_, Crowd> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Crowd {
    /// Cuts the connection that gives way first; `false` when there is none.
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
    pub(super) fn leave(self) -> bool {
        self.vestibule.crowd().remove(self.number).is_some()
    }

    /// Waits until it has to make room.
    pub(super) async fn cut(&self) {
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

    /// Indices of the connections that had to make room.
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

    /// Safety S9: an attacker with many addresses drives out only his own older connections earlier.
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
