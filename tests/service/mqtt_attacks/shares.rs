//! Limits per key for shared resources: a key can exhaust only its own share, and other keys are not affected.

use super::client::Client;
use super::packets::{PUBACK, RETAIN, SUBACK, connect_as, packet, publish, subscribe_all};
use super::siege::Siege;
use crate::access::Folder;
use crate::program::{Deadline, PATIENCE};

/// Number of different topics that a client publishes on.
const TOPICS: usize = 75_000;

/// Retained messages that one key publishes.
const KEPT: usize = 5_000;

/// Retained messages that the broker stores for one key.
const SHARE: usize = 4_096;

/// Retained messages among which the filters search.
const SHELF: usize = 8_000;

/// Number of different last topic levels, and of filters.
const KINDS: usize = 64;

/// Connects a client with this key.
fn with_key(siege: &Siege, folder: &Folder, name: &str) -> Client {
    // The id is empty, so that a second client does not replace the first.
    Client::try_connect(siege.broker, &connect_as("", (name, &folder.token_of(name)))).expect("it is let in")
}

/// Publishes `count` retained messages and waits for all acknowledgements.
fn keep(client: &mut Client, above: &str, count: usize) {
    for numbers in (0..count).collect::<Vec<_>>().chunks(500) {
        let said = numbers.iter().flat_map(|n| publish(&format!("{above}/{n}"), b"x", 1, RETAIN, 7));
        client.say(&said.collect::<Vec<u8>>());
        numbers.iter().for_each(|_| drop(client.until(PUBACK)));
    }
}

/// Number of retained messages that match a filter.
fn kept(siege: &Siege, filter: &str) -> usize {
    // Retained messages arrive in the order of their topics. The other topics end with numbers, so `end` comes last.
    let mut last = siege.client("last");
    let end = filter.replace('#', "end");
    last.say(&publish(&end, b"x", 0, RETAIN, 0));
    last.settle();
    let mut reader = siege.client("counter");
    assert_eq!(reader.subscribe(filter, 0), 0);
    let mut count = 0;
    loop {
        let message = reader.message();
        if message.topic == end {
            break;
        }
        count += usize::from(message.is_kept);
    }
    last.say(&publish(&end, b"", 0, RETAIN, 0));
    last.settle();
    count
}

/// Safety A5 and S9.
#[test]
fn one_keys_topics_and_kept_messages_leave_others_as_they_were() {
    let folder = Folder::new("mqtt-shares");
    folder.token(&["add", "greedy", "--role", "operator"]);
    let mut siege = Siege::with_keys(&folder);
    let mut greedy = with_key(&siege, &folder, "greedy");
    keep(&mut greedy, "greedy", KEPT);
    let mut reader = with_key(&siege, &folder, "greedy");
    assert_eq!(reader.subscribe("many/#", 0), 0);
    for n in 0..TOPICS {
        greedy.publish(&format!("many/{n}"), b"");
    }
    greedy.settle();
    siege.stands();
    let mut modest = siege.client("modest");
    keep(&mut modest, "modest", 100);
    assert_eq!((kept(&siege, "modest/#"), kept(&siege, "greedy/#")), (100, SHARE));
    siege.stands();
}

/// Safety A5 and S9.
#[test]
fn the_topics_that_a_viewer_names_wear_nothing_out() {
    let folder = Folder::new("mqtt-viewer");
    folder.token(&["add", "lobby", "--role", "viewer"]);
    let mut siege = Siege::with_keys(&folder);
    let mut viewer = with_key(&siege, &folder, "lobby");
    let mut reader = siege.client("reader");
    assert_eq!(reader.subscribe("#", 0), 0);
    for n in 0..TOPICS / 3 {
        viewer.publish(&format!("many/{n}"), b"");
        viewer.publish(&format!("unibo/qak/{n}"), b"x");
        viewer.publish(&format!("hallsweep/discovery/command/{n}"), b"");
    }
    viewer.settle();
    siege.stands();
}

/// Safety S7: the cost of a SUBSCRIBE does not grow with the retained messages of others, and a long SUBSCRIBE lets
/// other clients have their turns.
#[test]
fn deep_filters_over_thousands_of_kept_messages_hold_nobody_up() {
    let mut siege = Siege::begin();
    let mut keeper = siege.client("keeper");
    let deep = "a/".repeat(20);
    for n in 0..SHELF {
        keeper.say(&publish(&format!("{n}/{deep}z{}", n % KINDS), b"x", 0, RETAIN, 0));
    }
    keeper.settle();
    let mut asking = siege.client("asking");
    let filters: Vec<String> = (0..KINDS).map(|kind| format!("{}z{kind}", "+/".repeat(21))).collect();
    asking.say(&subscribe_all(1, &filters));
    siege.stands();
    assert_eq!(asking.until(SUBACK).body[2..], [0; KINDS]);
    for _ in 0..SHELF {
        assert!(asking.message().is_kept);
    }
    siege.stands();
}

/// Safety S7.
#[test]
fn a_packet_with_tens_of_thousands_of_filters_ends_its_connection_and_says_why() {
    let mut siege = Siege::begin();
    let mut client = siege.client("many");
    let unsubscribe = packet(0xA2, &[&[0, 7][..], &[0, 1, b'a'].repeat(80_000)].concat());
    assert!(unsubscribe.len() < 256 * 1024 && client.try_say(&unsubscribe));
    while client.next().is_some() {}
    let deadline = Deadline::within(PATIENCE);
    while !siege.said().contains("more than 512 filters") {
        assert!(!deadline.has_passed(), "{}", siege.said());
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    siege.stands();
}
