//! What one key may take of what all share: it uses up what is its own, and others are none the worse for it.

use super::client::Client;
use super::packets::{PUBACK, RETAIN, SUBACK, connect_as, packet, publish, subscribe_all};
use super::siege::Siege;
use crate::access::Folder;
use crate::program::{Deadline, PATIENCE};

/// So many topics are named.
const TOPICS: usize = 75_000;

/// So many messages are to be kept,
const KEPT: usize = 5_000;

/// and so many of one key are.
const SHARE: usize = 4_096;

/// So many are kept that filters are looked for in,
const SHELF: usize = 8_000;

/// of so many kinds, in as many filters.
const KINDS: usize = 64;

/// A client with this key.
fn with_key(siege: &Siege, folder: &Folder, name: &str) -> Client {
    // Without an id of their own, so that the second does not take the first one's place.
    Client::try_connect(siege.broker, &connect_as("", (name, &folder.token_of(name)))).expect("it is let in")
}

/// Publishes so many messages that are to be kept, and waits until each is acknowledged.
fn keep(client: &mut Client, above: &str, count: usize) {
    for numbers in (0..count).collect::<Vec<_>>().chunks(500) {
        let said = numbers.iter().flat_map(|n| publish(&format!("{above}/{n}"), b"x", 1, RETAIN, 7));
        client.say(&said.collect::<Vec<u8>>());
        numbers.iter().for_each(|_| drop(client.until(PUBACK)));
    }
}

/// How many kept messages a filter finds.
fn kept(siege: &Siege, filter: &str) -> usize {
    // They come in the order of their topics, and the others have numbers.
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

/// Safety S7: what a SUBSCRIBE costs does not grow with what others have let keep, and what it costs is taken in turns.
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
