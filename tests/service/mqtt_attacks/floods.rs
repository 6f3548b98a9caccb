//! More than anybody can take: what a client does not read costs the program little, and others nothing.

use std::io::Write;

use super::packets::publish;
use super::siege::Siege;

/// So many bytes are published,
const FLOOD: usize = 200 * 1024 * 1024;

/// in messages of so many.
const MESSAGE: usize = 16 * 1024;

/// The most memory that the program may take, in MiB.
const MEMORY_MIB: u64 = 150;

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

/// Safety A5.
#[test]
fn empty_messages_under_many_filters_cost_little() {
    let mut siege = Siege::begin();
    let mut holders = Vec::new();
    for n in 0..3 {
        let mut holder = siege.client(&format!("holder-{n}"));
        for filter in
            [vec!["a/b/c", "a/b/+", "a/+/c", "a/+/+"], vec!["+/b/c", "+/b/+", "+/+/c", "+/+/+"], vec!["a/#", "#"]][n].iter()
        {
            assert_eq!(holder.subscribe(filter, 0), 0);
        }
        holders.push(holder);
    }
    let mut publisher = siege.client("publisher").mouth();
    let burst = publish("a/b/c", b"", 0, 0, 0).repeat(10_000);
    let mut most = 0;
    for _ in 0..100 {
        publisher.write_all(&burst).expect("the broker takes it");
        most = most.max(siege.memory_mib());
        eprintln!("{most}");
    }
    assert!(most < MEMORY_MIB, "{most} MiB");
    siege.stands();
}
