//! More than anybody can take: what a client does not read costs the program little, and others nothing.

use super::packets::{SUBACK, packet, publish, subscribe_all};
use super::siege::Siege;

/// So many bytes are published,
const FLOOD: usize = 200 * 1024 * 1024;

/// in messages of so many.
const MESSAGE: usize = 16 * 1024;

/// The most memory that the program may take, in MiB.
const MEMORY_MIB: u64 = 128;

/// So many filters are held by so many clients,
const HOLDERS: usize = 24;

/// messages of so many bytes are published on each,
const LONGEST: usize = 4_000;

/// so often,
const ROUNDS: usize = 40;

/// and the program may take so much for all of it, in MiB.
const READ_MIB: u64 = 64;

/// So many short messages are published that match sixty filters.
const SHORT: usize = 200_000;

/// So many messages are more than wait anywhere at once.
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

/// Short messages cost more than their bytes. Safety A5.
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

/// What was said and read takes no room any more, under however many topics and filters. Safety A5.
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

/// A topic of six levels, and filters that match it: one for each number below 64.
fn levels(n: usize) -> String {
    (0..6).map(|level| if n >> level & 1 == 1 { "+" } else { "a" }).collect::<Vec<_>>().join("/")
}
