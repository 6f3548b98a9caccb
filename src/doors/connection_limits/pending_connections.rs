//! Limits connections that have no slot or session yet, and connections that are closing. An HTTP connection is
//! pending until its first head is complete. After that even a stranger without a key gets a slot. An MQTT client is
//! pending until it is admitted or refused. Beyond the limit, a connection of the network with the most pending
//! connections is evicted, the oldest one. So every newcomer is served, and outlasts a crowd of one network (safety
//! S9).

use std::collections::hash_map::Entry;
use std::collections::{BTreeMap, HashMap};
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::access::Network;

/// Number of connections evicted at once when the system has no more descriptors. Newcomers and files then find free
/// descriptors.
pub(super) const EVICTED_AT_ONCE: usize = 16;

#[derive(Clone)]
pub(in crate::doors) struct PendingConnections(Arc<Mutex<PendingTable>>);

struct PendingTable {
    most: usize,
    entered: u64,
    /// The pending connections by number, so the oldest is first.
    waiting: BTreeMap<u64, (Network, Arc<Notify>)>,
    networks: HashMap<Network, usize>,
}

/// One pending connection. It counts until this value is dropped.
pub(in crate::doors) struct PendingConnection {
    number: u64,
    pending: PendingConnections,
    cut: Arc<Notify>,
}

impl PendingConnections {
    pub(in crate::doors) fn new(most: usize) -> PendingConnections {
        PendingConnections(Arc::new(Mutex::new(PendingTable {
            most,
            entered: 0,
            waiting: BTreeMap::new(),
            networks: HashMap::new(),
        })))
    }

    /// Admits a connection from this address. `cut` is notified if the connection is evicted.
    pub(in crate::doors) fn admit(&self, address: IpAddr, cut: Arc<Notify>) -> PendingConnection {
        let mut table = self.table();
        if table.waiting.len() >= table.most {
            table.evict_one();
        }
        table.entered += 1;
        let (number, network) = (table.entered, Network::of(address));
        table.waiting.insert(number, (network, Arc::clone(&cut)));
        *table.networks.entry(network).or_default() += 1;
        drop(table);
        PendingConnection { number, pending: self.clone(), cut }
    }

    /// Runs `last`, the remaining work of a closing connection. It is stopped if the connection is evicted.
    pub(in crate::doors) async fn linger(&self, address: IpAddr, last: impl Future<Output = ()>) {
        let waiting = self.admit(address, Arc::default());
        tokio::select! {
            biased;
            () = last => {}
            () = waiting.evicted() => {}
        }
    }

    /// Evicts some connections when the system has no more descriptors. Returns how many were evicted.
    pub(in crate::doors) fn evict_some(&self) -> usize {
        let mut table = self.table();
        (0..EVICTED_AT_ONCE).take_while(|_| table.evict_one()).count()
    }

    fn table(&self) -> MutexGuard<'_, PendingTable> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl PendingTable {
    /// Evicts the oldest connection of the network with the most pending connections. Returns false if there was no
    /// connection.
    fn evict_one(&mut self) -> bool {
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

impl PendingConnection {
    /// Stops counting the connection. Returns `false` if it was evicted before.
    pub(in crate::doors) fn leave(self) -> bool {
        self.pending.table().remove(self.number).is_some()
    }

    pub(in crate::doors) async fn evicted(&self) {
        self.cut.notified().await;
    }
}

impl Drop for PendingConnection {
    fn drop(&mut self) {
        let _ = self.pending.table().remove(self.number);
    }
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt;

    use super::*;
    use crate::runtime::tests::within::within;

    fn crowd<'a>(pending: &PendingConnections, from: impl IntoIterator<Item = &'a str>) -> Vec<PendingConnection> {
        from.into_iter().map(|address| pending.admit(address.parse().unwrap(), Arc::default())).collect()
    }

    /// Returns the indexes of the evicted connections.
    fn gone(crowd: &[PendingConnection]) -> Vec<usize> {
        (0..crowd.len()).filter(|number| crowd[*number].evicted().now_or_never().is_some()).collect()
    }

    /// Safety S9.
    #[test]
    fn the_oldest_of_the_largest_crowd_makes_room() {
        let pending = PendingConnections::new(4);
        let all = crowd(&pending, ["192.0.2.1", "192.0.2.7", "192.0.2.7", "192.0.2.7", "192.0.2.9", "192.0.2.10"]);
        assert_eq!(gone(&all), [1, 2]);
        assert_eq!(pending.table().waiting.len(), 4);
        drop(all);
        let crowd = pending.table();
        assert!(crowd.waiting.is_empty() && crowd.networks.is_empty(), "whoever leaves is not counted");
    }

    /// Safety S9: an attacker with many addresses loses older connections of its own before newer connections of
    /// others.
    #[test]
    fn of_crowds_that_are_equally_large_the_oldest_makes_room() {
        let pending = PendingConnections::new(4);
        let from = ["192.0.2.5", "192.0.2.1", "192.0.2.8", "192.0.2.2", "192.0.2.9", "192.0.2.3", "192.0.2.7"];
        assert_eq!(gone(&crowd(&pending, from)), [0, 1, 2]);
    }

    /// Safety S9.
    #[test]
    fn whoever_comes_from_elsewhere_is_not_driven_away_by_a_crowd() {
        let pending = PendingConnections::new(4);
        let before = crowd(&pending, ["127.0.0.1"; 4]);
        let newcomer = crowd(&pending, ["192.0.2.1"]);
        let flock = crowd(&pending, ["127.0.0.1"; 20]);
        assert_eq!((gone(&before).len(), gone(&newcomer).len(), gone(&flock).len()), (4, 0, 17));
    }

    /// Safety A5.
    #[tokio::test]
    async fn whoever_lingers_does_so_until_it_is_done_or_has_to_make_room() {
        let pending = PendingConnections::new(1);
        let address = "192.0.2.1".parse().unwrap();
        pending.linger(address, std::future::ready(())).await;
        let endless = tokio::spawn({
            let pending = pending.clone();
            async move { pending.linger(address, std::future::pending()).await }
        });
        tokio::task::yield_now().await;
        assert!(!endless.is_finished());
        let _newcomer = pending.admit(address, Arc::default());
        within("it makes room", endless).await.unwrap();
    }

    #[test]
    fn a_system_without_descriptors_is_relieved_and_whoever_goes_on_leaves_room() {
        let pending = PendingConnections::new(20);
        let all = crowd(&pending, ["127.0.0.1"; 20]);
        assert_eq!([pending.evict_some(), pending.evict_some(), pending.evict_some()], [EVICTED_AT_ONCE, 4, 0]);
        drop(all);
        let again = crowd(&pending, ["127.0.0.1"; 20]);
        assert!(gone(&again).is_empty());
        drop(again);
        assert!(pending.table().waiting.is_empty());
    }
}
