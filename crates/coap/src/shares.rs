//! Counts the entries of each peer in a table that all peers share. When the table is full, the address with the most
//! entries loses one: the oldest entry of its port with the most entries. So a flood cannot push out the entries of
//! others. The entries themselves are stored elsewhere.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::net::{IpAddr, SocketAddr};

#[derive(Debug)]
pub(super) struct Shares<T> {
    addresses: BTreeMap<IpAddr, Address<T>>,
    sizes: BTreeSet<(usize, IpAddr)>,
}

#[derive(Debug)]
struct Address<T> {
    count: usize,
    /// Entries of each port, oldest first.
    ports: BTreeMap<u16, VecDeque<T>>,
    sizes: BTreeSet<(usize, u16)>,
}

impl<T> Default for Shares<T> {
    fn default() -> Shares<T> {
        Shares { addresses: BTreeMap::new(), sizes: BTreeSet::new() }
    }
}

impl<T> Shares<T> {
    pub(super) fn add(&mut self, peer: SocketAddr, thing: T) {
        self.change(peer, |things| things.push_back(thing));
    }

    pub(super) fn forget_oldest(&mut self, peer: SocketAddr) {
        self.change(peer, |things| drop(things.pop_front()));
    }

    /// Removes and returns one entry of the address with the most entries: the oldest entry of its port with the most
    /// entries.
    pub(super) fn take_from_the_largest(&mut self) -> Option<T> {
        let (_, ip) = *self.sizes.last()?;
        let (_, port) = *self.addresses.get(&ip)?.sizes.last()?;
        let mut taken = None;
        self.change(SocketAddr::new(ip, port), |things| taken = things.pop_front());
        taken
    }

    fn change(&mut self, peer: SocketAddr, change: impl FnOnce(&mut VecDeque<T>)) {
        let (ip, port) = (peer.ip(), peer.port());
        let address =
            self.addresses.entry(ip).or_insert_with(|| Address { count: 0, ports: BTreeMap::new(), sizes: BTreeSet::new() });
        self.sizes.remove(&(address.count, ip));
        let things = address.ports.entry(port).or_default();
        let before = things.len();
        change(things);
        let after = things.len();
        address.sizes.remove(&(before, port));
        address.count = address.count + after - before;
        if after > 0 {
            address.sizes.insert((after, port));
        } else {
            address.ports.remove(&port);
        }
        if address.count > 0 {
            self.sizes.insert((address.count, ip));
        } else {
            self.addresses.remove(&ip);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peer(text: &str) -> SocketAddr {
        text.parse().unwrap()
    }

    #[test]
    fn the_oldest_of_the_largest_port_of_the_largest_address_gives_way() {
        let mut shares = Shares::default();
        for (from, thing) in [("127.0.0.1:1", 1), ("127.0.0.2:1", 2), ("127.0.0.2:2", 3), ("127.0.0.2:2", 4), ("[::1]:1", 5)] {
            shares.add(peer(from), thing);
        }
        assert_eq!(shares.take_from_the_largest(), Some(3));
        shares.forget_oldest(peer("127.0.0.2:1"));
        shares.add(peer("127.0.0.1:1"), 6);
        assert_eq!(shares.take_from_the_largest(), Some(1));
        let mut rest: Vec<i32> = std::iter::from_fn(|| shares.take_from_the_largest()).collect();
        rest.sort_unstable();
        assert_eq!(rest, [4, 5, 6]);
        assert!(shares.addresses.is_empty() && shares.sizes.is_empty(), "nothing is left of anybody");
    }
}
