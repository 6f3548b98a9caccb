//! Received datagrams that wait for their turn. Networks take turns, and so do the peers of each network. A peer that
//! sends more than can be answered loses only its own datagrams, and CoAP clients send these again. `backlog` decides
//! which datagrams go first.

use std::collections::VecDeque;
use std::net::SocketAddr;

use hashlink::LinkedHashMap;

use super::limits::WAITING_HEAD;
use super::network::Network;

/// The sender's address and the bytes of a received datagram.
pub type Datagram = (SocketAddr, Box<[u8]>);

type Peers = LinkedHashMap<SocketAddr, Share<VecDeque<Box<[u8]>>>>;

/// The networks with waiting datagrams, in the order of their turns.
pub(super) struct Queue {
    networks: LinkedHashMap<Network, Share<Peers>>,
    /// Datagrams that go before all others. Their bytes also count towards the limit.
    first: VecDeque<Datagram>,
    /// Free room in bytes.
    left: usize,
}

/// The datagrams of one network or peer in the queue, and their size in bytes.
#[derive(Default)]
struct Share<T> {
    holds: T,
    bytes: usize,
}

impl Queue {
    /// A queue with this many bytes of room. Each datagram takes `WAITING_HEAD` bytes in addition to its own.
    pub(super) fn of(room: usize) -> Queue {
        Queue { networks: LinkedHashMap::new(), first: VecDeque::new(), left: room }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.first.is_empty() && self.networks.is_empty()
    }

    /// Adds a datagram. Drops it if the bytes of its network plus the bytes of its peer would then exceed the free
    /// room. So other networks, and other peers of this network, can still add their datagrams.
    pub(super) fn push(&mut self, peer: SocketAddr, bytes: &[u8]) {
        let (network, cost) = (Network::of(peer.ip()), cost(bytes));
        let share = self.networks.get(&network);
        let of_network = share.map_or(0, |share| share.bytes);
        let of_peer = share.and_then(|share| share.holds.get(&peer)).map_or(0, |share| share.bytes);
        if (of_network + cost) + (of_peer + cost) > self.left.saturating_sub(cost) {
            return;
        }
        // `entry` would move a network or peer that waits already to the end of the turns.
        if of_network == 0 {
            self.networks.insert(network, Share::default());
        }
        let Some(share) = self.networks.get_mut(&network) else { return };
        if of_peer == 0 {
            share.holds.insert(peer, Share::default());
        }
        let Some(own) = share.holds.get_mut(&peer) else { return };
        own.holds.push_back(bytes.into());
        own.bytes += cost;
        share.bytes += cost;
        self.left -= cost;
    }

    pub(super) fn has_first(&self) -> bool {
        !self.first.is_empty()
    }

    /// Moves all waiting datagrams ahead of later ones. They are then taken before an urgent request.
    pub(super) fn put_first(&mut self) {
        while let Some(datagram) = self.next_in_turn() {
            self.first.push_back(datagram);
        }
    }

    pub(super) fn next_first(&mut self) -> Option<Datagram> {
        let datagram = self.first.pop_front()?;
        self.left += cost(&datagram.1);
        Some(datagram)
    }

    /// The next datagram in turn; the datagrams of one peer keep their order.
    pub(super) fn next(&mut self) -> Option<Datagram> {
        let datagram = self.first.pop_front().or_else(|| self.next_in_turn())?;
        self.left += cost(&datagram.1);
        Some(datagram)
    }

    fn next_in_turn(&mut self) -> Option<Datagram> {
        let (network, mut share) = self.networks.pop_front()?;
        let (peer, mut own) = share.holds.pop_front()?;
        let datagram = own.holds.pop_front()?;
        own.bytes -= cost(&datagram);
        share.bytes -= cost(&datagram);
        if !own.holds.is_empty() {
            share.holds.insert(peer, own);
        }
        if !share.holds.is_empty() {
            self.networks.insert(network, share);
        }
        Some((peer, datagram))
    }
}

const fn cost(bytes: &[u8]) -> usize {
    WAITING_HEAD + bytes.len()
}

#[cfg(test)]
#[path = "queue_tests.rs"]
mod tests;
