//! More than anybody can take: what a client does not read costs the program little, and others nothing.

use std::thread::sleep;

use super::packets::publish;
use super::siege::{GLANCE, Siege};
use crate::program::{Deadline, PATIENCE};

/// So many bytes are published,
const FLOOD: usize = 200 * 1024 * 1024;

/// in messages of so many.
const MESSAGE: usize = 16 * 1024;

/// The most memory that the program may take, in MiB.
const MEMORY_MIB: u64 = 150;

/// What an engine may take before it is started anew, in MiB, and something over for the moment in which that is seen.
const ENGINE_MIB: u64 = 1_536;

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

/// Small messages cost the engine many times what it counts, and under many filters each many times that. Safety A5.
#[test]
fn an_engine_that_takes_too_much_memory_is_started_anew_and_gives_it_back() {
    let mut siege = Siege::begin();
    let mut holder = siege.client("holder");
    let levels = |n: usize| (0..6).map(|level| if n >> level & 1 == 1 { "+" } else { "a" }).collect::<Vec<_>>().join("/");
    for n in 0..60 {
        assert_eq!(holder.subscribe(&levels(n), 0), 0);
    }
    let mut publisher = siege.client("publisher");
    let (burst, mut most) = (publish(&levels(0), b"", 0, 0, 0).repeat(1_000), 0);
    // The holder reads nothing, and is not waited for: its connection may end, and what was said stays in the engine.
    while !siege.said().contains("it takes too much memory") {
        if !publisher.try_say(&burst) {
            publisher = siege.client("publisher");
        }
        most = most.max(siege.memory_mib());
        assert!(most < ENGINE_MIB, "{most} MiB");
    }
    siege.screen_comes_again();
    let deadline = Deadline::within(PATIENCE);
    while siege.memory_mib() >= MEMORY_MIB {
        assert!(!deadline.has_passed(), "{most} MiB were in use, and {} MiB are", siege.memory_mib());
        sleep(GLANCE);
    }
    siege.is_served();
}
