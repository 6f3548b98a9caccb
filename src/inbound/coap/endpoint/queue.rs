//! Datagrams that were heard and wait for their turn: each peer has its turns, and none takes the room of others, so that whoever
//! sends more than is answered loses its own, which CoAP clients send again. What does not wait is the business of `hear`.

use std::collections::VecDeque;
use std::net::SocketAddr;

use hashlink::LinkedHashMap;

use super::limits::WAITING_HEAD;

/// The peers of whom something waits, the one whose turn is next first.
pub(super) struct Queue {
    peers: LinkedHashMap<SocketAddr, Share>,
    /// So many bytes more have room.
    left: usize,
}

/// What one peer has there.
#[derive(Default)]
struct Share {
    datagrams: VecDeque<Box<[u8]>>,
    bytes: usize,
}

impl Queue {
    /// Room for so many bytes, `WAITING_HEAD` of them for each datagram beside its own.
    pub(super) fn of(room: usize) -> Queue {
        Queue { peers: LinkedHashMap::new(), left: room }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.peers.is_empty()
    }

    /// Keeps one more, or loses it: nobody has more than what is left for others.
    pub(super) fn push(&mut self, peer: SocketAddr, bytes: &[u8]) {
        let (cost, held) = (WAITING_HEAD + bytes.len(), self.peers.get(&peer).map_or(0, |share| share.bytes));
        if held + cost > self.left {
            return;
        }
        if held == 0 {
            self.peers.insert(peer, Share::default());
        }
        // `entry` would send a peer that waits already to the end of the turns.
        if let Some(share) = self.peers.get_mut(&peer) {
            share.datagrams.push_back(bytes.into());
            share.bytes += cost;
            self.left -= cost;
        }
    }

    /// The next one: those of a peer in their order, one in each of its turns.
    pub(super) fn next(&mut self) -> Option<(SocketAddr, Box<[u8]>)> {
        let (peer, mut share) = self.peers.pop_front()?;
        let datagram = share.datagrams.pop_front()?;
        let cost = WAITING_HEAD + datagram.len();
        share.bytes -= cost;
        self.left += cost;
        if !share.datagrams.is_empty() {
            self.peers.insert(peer, share);
        }
        Some((peer, datagram))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peer(port: u16) -> SocketAddr {
        SocketAddr::from(([127, 0, 0, 1], port))
    }

    /// The ports and first bytes of all that wait, in their order.
    fn taken(queue: &mut Queue) -> Vec<(u16, u8)> {
        std::iter::from_fn(|| queue.next()).map(|(peer, bytes)| (peer.port(), bytes[0])).collect()
    }

    #[test]
    fn each_peer_has_its_turn_and_its_own_keep_their_order() {
        let mut queue = Queue::of(10_000);
        for (port, n) in [(1, 1), (1, 2), (1, 3), (2, 1), (3, 1), (2, 2)] {
            queue.push(peer(port), &[n]);
        }
        assert_eq!(taken(&mut queue), [(1, 1), (2, 1), (3, 1), (1, 2), (2, 2), (1, 3)]);
        assert!(queue.is_empty());
        assert_eq!(queue.left, 10_000);
    }

    #[test]
    fn whoever_was_answered_has_room_again() {
        let mut queue = Queue::of(100 * (WAITING_HEAD + 1));
        let fill = |queue: &mut Queue| (0..100).for_each(|n| queue.push(peer(1), &[n]));
        fill(&mut queue);
        (0..49).for_each(|_| assert!(queue.next().is_some()));
        fill(&mut queue);
        assert_eq!(taken(&mut queue).len(), 50);
    }

    /// Safety S9, A5.
    #[test]
    fn a_flood_loses_its_own_and_takes_neither_the_room_nor_the_turn_of_others() {
        const COST: usize = WAITING_HEAD + 4;
        for floods in 1..20 {
            let mut queue = Queue::of(1000 * COST);
            for n in 0..10_000_u32 {
                (1..=floods).for_each(|port| queue.push(peer(port), &n.to_be_bytes()));
            }
            queue.push(peer(99), &[9; 4]);
            let taken = taken(&mut queue);
            assert!(taken[..=usize::from(floods)].contains(&(99, 9)), "{floods}");
            assert!((500..=1000).contains(&taken.len()), "{floods} have {}", taken.len());
        }
    }

    /// Safety A5.
    #[test]
    fn no_more_is_kept_than_there_is_room_for() {
        let mut queue = Queue::of(100_000);
        (1..10_000).for_each(|port| queue.push(peer(port), &[1]));
        assert!(queue.left < WAITING_HEAD + 1);
        assert_eq!(taken(&mut queue).len(), 100_000 / (WAITING_HEAD + 1));
        queue.push(peer(1), &[1; 100_000]);
        assert!(queue.is_empty(), "what alone has no room is lost");
        queue.push(peer(1), &[1; 60_000]);
        queue.push(peer(1), &[1; 60_000]);
        queue.push(peer(2), &[2; 30_000]);
        assert_eq!(taken(&mut queue), [(1, 1), (2, 2)]);
    }
}
