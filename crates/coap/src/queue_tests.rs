//! Tests the limits and the turns of a queue under floods.

use super::*;

const COST: usize = WAITING_HEAD + 1;

fn peer(port: u16) -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], port))
}

fn is_kept(queue: &mut Queue, peer: SocketAddr, bytes: &[u8]) -> bool {
    let before = queue.left;
    queue.push(peer, bytes);
    queue.left < before
}

/// The ports and first bytes of all waiting datagrams, in their order.
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
    let mut queue = Queue::of(99 * COST);
    let fill = |queue: &mut Queue| (0..100).filter(|n| is_kept(queue, peer(1), &[*n])).count();
    assert_eq!(fill(&mut queue), 33);
    (0..33).for_each(|_| assert!(queue.next().is_some()));
    assert_eq!(fill(&mut queue), 33);
}

#[test]
fn whoever_always_has_something_waiting_has_room_for_as_much_as_was_taken() {
    let mut queue = Queue::of(99 * COST);
    for n in 0..1_000 {
        assert!(is_kept(&mut queue, peer(1 + n % 2), &[1]), "{n} were taken before");
        assert!(n < 4 || queue.next().is_some());
    }
}

#[test]
fn what_is_put_first_goes_before_what_comes_later_and_has_its_room_until_it_goes() {
    let mut queue = Queue::of(90 * COST);
    (1..=2).for_each(|n| [1, 2].into_iter().for_each(|port| queue.push(peer(port), &[n])));
    assert!(!queue.has_first());
    queue.put_first();
    assert!(queue.has_first() && !queue.is_empty());
    assert_eq!(queue.left, 86 * COST);
    queue.push(peer(3), &[9]);
    assert_eq!(queue.next_first().map(|(peer, _)| peer.port()), Some(1));
    assert_eq!(taken(&mut queue), [(2, 1), (1, 2), (2, 2), (3, 9)]);
    assert!(queue.is_empty() && queue.next_first().is_none());
    assert_eq!(queue.left, 90 * COST);
}

#[test]
fn a_flood_loses_its_own_and_takes_neither_the_room_nor_the_turn_of_others() {
    for floods in 1..20 {
        let mut queue = Queue::of(1000 * COST);
        for n in 0..10_000_u32 {
            (1..=floods).for_each(|port| queue.push(peer(port), &n.to_be_bytes()[3..]));
        }
        queue.push(peer(99), &[9]);
        let taken = taken(&mut queue);
        assert!(taken[..=usize::from(floods)].contains(&(99, 9)), "{floods}");
        assert!((330..=1000).contains(&taken.len()), "{floods} have {}", taken.len());
    }
}

/// A sender can use all ports of its address, and all addresses of its IPv6 /64.
#[test]
fn a_crowd_of_ports_of_one_address_takes_neither_the_room_nor_the_turn_of_another() {
    let crowds: [fn(u16) -> SocketAddr; 3] = [
        |n| SocketAddr::from(([192, 0, 2, 7], n)),
        |n| SocketAddr::from(([0x2001, 0xdb8, 1, 2, n, n, n, n], 5683)),
        |n| SocketAddr::from(([127, 0, 0, 2], n)),
    ];
    for crowd in crowds {
        for each in [1, 5] {
            let mut queue = Queue::of(1000 * COST);
            (0..each).for_each(|_| (1..=10_000).for_each(|n| queue.push(crowd(n), &[1])));
            for n in 1..=5 {
                queue.push(SocketAddr::from(([192, 0, 2, 9], n)), &[9]);
                queue.push(peer(n), &[8]);
            }
            let order: Vec<u8> = std::iter::from_fn(|| queue.next()).map(|(_, bytes)| bytes[0]).collect();
            assert_eq!(order[..15], [1, 9, 8].repeat(5), "they have every other turn");
            assert!(order.len() > 400, "the crowd has what is not kept for others: {}", order.len());
        }
    }
}

#[test]
fn no_more_is_kept_than_there_is_room_for() {
    let mut queue = Queue::of(100_000);
    for network in 1..=200 {
        (1..100).for_each(|port| queue.push(SocketAddr::from(([10, 0, 0, network], port)), &[1]));
    }
    let kept = 100_000 / COST;
    assert!(queue.left < 4 * COST, "{} are left", queue.left);
    assert!((kept - 3..=kept).contains(&taken(&mut queue).len()));
    assert!(!is_kept(&mut queue, peer(1), &[1; 100_000]), "what alone has no room is lost");
    assert!(is_kept(&mut queue, peer(1), &[1; 30_000]) && !is_kept(&mut queue, peer(1), &[1; 30_000]));
    queue.push(SocketAddr::from(([10, 0, 0, 1], 2)), &[2; 20_000]);
    assert_eq!(taken(&mut queue), [(1, 1), (2, 2)]);
}
