//! Where connections are without a place: as many as there is room for, and the oldest of whoever has most of them gives way. In one
//! wait those that have said nothing yet, each until its first head has come, so that a newcomer's STOP is heard although every place
//! is taken; in another linger those that get no further answer.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::Notify;

use crate::access::Network;

/// So many wait at once: a head comes within a moment, or whoever sends it has this many newcomers' time.
pub(super) const WAITING: usize = 128;

/// So many linger at once.
pub(super) const LINGERING: usize = 64;

/// The vestibule. Cheap to clone.
#[derive(Clone)]
pub(super) struct Vestibule(Arc<Mutex<Waiting>>);

struct Waiting {
    most: usize,
    entered: u64,
    /// In the order in which they came.
    guests: BTreeMap<u64, (Network, Arc<Notify>)>,
}

/// A connection that waits; its room is free again when this is dropped.
pub(super) struct Guest {
    number: u64,
    vestibule: Vestibule,
}

impl Vestibule {
    /// Room for so many.
    pub(super) fn new(most: usize) -> Vestibule {
        Vestibule(Arc::new(Mutex::new(Waiting { most, entered: 0, guests: BTreeMap::new() })))
    }

    /// Lets a connection wait, which is told by `cut` when it has to make room.
    pub(super) fn enter(&self, address: IpAddr, cut: Arc<Notify>) -> Guest {
        let mut waiting = self.waiting();
        if waiting.guests.len() >= waiting.most {
            waiting.cut();
        }
        waiting.entered += 1;
        let number = waiting.entered;
        waiting.guests.insert(number, (Network::of(address), cut));
        drop(waiting);
        Guest { number, vestibule: self.clone() }
    }

    fn waiting(&self) -> MutexGuard<'_, Waiting> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Waiting {
    fn cut(&mut self) {
        let mut crowds: BTreeMap<Network, (usize, u64)> = BTreeMap::new();
        for (number, (network, _)) in &self.guests {
            crowds.entry(*network).or_insert((0, *number)).0 += 1;
        }
        let oldest = crowds.into_values().max_by_key(|(many, _)| *many).map(|(_, oldest)| oldest);
        if let Some((_, cut)) = oldest.and_then(|oldest| self.guests.remove(&oldest)) {
            cut.notify_one();
        }
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        self.vestibule.waiting().guests.remove(&self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    async fn is_cut(cut: &Notify) -> bool {
        tokio::select! {
            biased;
            () = cut.notified() => true,
            () = std::future::ready(()) => false,
        }
    }

    /// Safety S9.
    #[tokio::test]
    async fn the_oldest_of_the_largest_crowd_makes_room() {
        let vestibule = Vestibule::new(4);
        let addresses = ["192.0.2.1", "192.0.2.7", "192.0.2.7", "192.0.2.7", "192.0.2.9"];
        let mut guests = Vec::new();
        for address in addresses {
            let cut = Arc::new(Notify::new());
            guests.push((vestibule.enter(address.parse().unwrap(), Arc::clone(&cut)), cut));
        }
        let mut gone = Vec::new();
        for (_, cut) in &guests {
            gone.push(is_cut(cut).await);
        }
        assert_eq!(gone, [false, true, false, false, false]);
        drop(guests);
        assert!(vestibule.waiting().guests.is_empty(), "whoever goes on leaves room");
    }
}
