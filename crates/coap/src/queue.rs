//! Datagrams that were heard and wait for their turn: networks take turns, and the peers of each, and none takes the room of others,
//! so that whoever sends more than is answered loses its own, which CoAP clients send again. Which of them go first is the business
//! of `backlog`.

use std::collections::VecDeque;
use std::net::SocketAddr;

use hashlink::LinkedHashMap;

use super::limits::WAITING_HEAD;
use super::network::Network;

/// A datagram, and who sent it.
pub type Datagram = (SocketAddr, Box<[u8]>);

type Peers = LinkedHashMap<SocketAddr, Share<VecDeque<Box<[u8]>>>>;

/// The networks of whom something waits, the one whose turn is next first.
pub(super) struct Queue {
    networks: LinkedHashMap<Network, Share<Peers>>,
    /// What goes before all others, whose room it still has.
    first: VecDeque<Datagram>,
    /// So many bytes more have room.
    left: usize,
}

/// What somebody has there, and how many bytes that takes.
#[derive(Default)]
struct Share<T> {
    holds: T,
    bytes: usize,
}

impl Queue {
    /// Room for so many bytes, `WAITING_HEAD` of them for each datagram beside its own.
    pub(super) fn of(room: usize) -> Queue {
        Queue { networks: LinkedHashMap::new(), first: VecDeque::new(), left: room }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.first.is_empty() && self.networks.is_empty()
    }

    /// Keeps one more, or loses it: what is left for others is more than all that its network then has there, and the rest of that
    /// is no less than what its peer has, so that there is room for other networks, and for other peers of each.
    pub(super) fn push(&mut self, peer: SocketAddr, bytes: &[u8]) {
        let (network, cost) = (Network::of(peer.ip()), cost(bytes));
        let share = self.networks.get(&network);
        let of_network = share.map_or(0, |share| share.bytes);
        let of_peer = share.and_then(|share| share.holds.get(&peer)).map_or(0, |share| share.bytes);
        if (of_network + cost) + (of_peer + cost) > self.left.saturating_sub(cost) {
            return;
        }
        // `entry` would send a network or a peer that waits already to the end of the turns.
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

    /// All that waits now goes before what comes later.
    pub(super) fn put_first(&mut self) {
        while let Some(datagram) = self.next_in_turn() {
            self.first.push_back(datagram);
        }
    }

    /// The next of what goes before all others.
    pub(super) fn next_first(&mut self) -> Option<Datagram> {
        let datagram = self.first.pop_front()?;
        self.left += cost(&datagram.1);
        Some(datagram)
    }

    /// The next one: those of a peer in their order, one in each of its turns.
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
