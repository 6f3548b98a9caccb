//! Floods beyond what any client can read: messages that a client does not read cost the program little and do not
//! affect others.

use super::packets::{SUBACK, packet, publish, subscribe_all};
use super::siege::Siege;

/// Total size of the published messages, in bytes.
const FLOOD: usize = 200 * 1024 * 1024;

/// Size of each message, in bytes.
const MESSAGE: usize = 16 * 1024;

/// Limit for the memory of the program, in MiB.
const MEMORY_MIB: u64 = 128;

/// Clients that subscribe to 64 filters each.
const HOLDERS: usize = 24;

/// Size of each message for these clients, in bytes.
const LONGEST: usize = 4_000;

/// Messages that are published for each filter.
const ROUNDS: usize = 40;

/// Limit for the memory of the program during these messages, in MiB.
const READ_MIB: u64 = 64;

/// Number of short messages, each of which matches sixty filters.
const SHORT: usize = 200_000;

/// Number of messages, more than all queues together can hold.
const MESSAGES: u32 = 30_000;

#[test]
fn whoever_floods_and_leaves_at_once_has_said_all_of_it_to_those_who_read() {
    let siege = Siege::begin();
    let mut reader = siege.client("reader");
    assert_eq!(reader.subscribe("flood/#", 0), 0);
    let mut publisher = siege.client("publisher");
    let publisher = std::thread::spawn(move || {
        for n in 0..MESSAGES {
            publisher.say(&publish("flood/1", &n.to_be_bytes(), 0, 0, 0));
        }
        publisher.say(&packet(0xE0, &[]));
        drop(publisher);
    });
    for n in 0..MESSAGES {
        assert_eq!(reader.message().payload, n.to_be_bytes(), "message {n}");
    }
    publisher.join().expect("it has said everything");
}

/// Safety A5.
#[test]
fn a_subscriber_that_never_reads_costs_little_and_nobody_else_anything() {
    let mut siege = Siege::begin();
    let mut stalled = siege.client("stalled");
    assert_eq!(stalled.subscribe("#", 1), 1);
    let mut publisher = siege.client("publisher");
    let message = publish("flood/1", &vec![b'x'; MESSAGE], 0, 0, 0);
    let mut most = 0;
    for _ in 0..20 {
        for _ in 0..FLOOD / MESSAGE / 20 {
            publisher.say(&message);
        }
        most = most.max(siege.memory_mib());
        siege.is_served();
    }
    publisher.settle();
    most = most.max(siege.memory_mib());
    assert!(most < MEMORY_MIB, "{most} MiB");
    siege.stands();
}

/// A short message costs more than its bytes. Safety A5.
#[test]
fn short_messages_under_many_filters_cost_little_and_nobody_else_anything() {
    let mut siege = Siege::begin();
    let mut holder = siege.client("holder");
    for n in 0..60 {
        assert_eq!(holder.subscribe(&levels(n), 0), 0);
    }
    let mut publisher = siege.client("publisher");
    let burst = publish(&levels(0), b"", 0, 0, 0).repeat(1_000);
    for _ in 0..SHORT / 1_000 {
        publisher.say(&burst);
        let memory = siege.memory_mib();
        assert!(memory < MEMORY_MIB, "{memory} MiB");
    }
    publisher.settle();
    siege.stands();
}

/// Messages that were sent and read occupy no memory, however many topics and filters there are. Safety A5.
#[test]
fn messages_that_were_read_take_no_memory() {
    let mut siege = Siege::begin();
    let holders: Vec<_> = (0..HOLDERS).map(|holder| siege.client(&format!("holder-{holder}"))).collect();
    let holding = holders.into_iter().enumerate().map(|(holder, mut client)| {
        let filters: Vec<String> = (0..64).map(|n| format!("long/{holder}/{n}")).collect();
        client.say(&subscribe_all(1, &filters));
        client.until(SUBACK);
        std::thread::spawn(move || (0..64 * ROUNDS).for_each(|_| drop(client.message())))
    });
    let holding: Vec<_> = holding.collect();
    let mut publisher = siege.client("publisher");
    for holder in (0..HOLDERS).cycle().take(HOLDERS * ROUNDS) {
        let said = (0..64).flat_map(|n| publish(&format!("long/{holder}/{n}"), &[b'x'; LONGEST], 0, 0, 0));
        publisher.say(&said.collect::<Vec<u8>>());
        let memory = siege.memory_mib();
        assert!(memory < READ_MIB, "{memory} MiB");
    }
    holding.into_iter().for_each(|holder| holder.join().expect("it got everything"));
    siege.stands();
}

/// Filter number `n`, below 64, that matches the topic of six levels. Number 0 is the topic itself.
fn levels(n: usize) -> String {
    (0..6).map(|level| if n >> level & 1 == 1 { "+" } else { "a" }).collect::<Vec<_>>().join("/")
}
