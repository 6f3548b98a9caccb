//! Viewers that subscribe to filters and unsubscribe from them without end: each packet gets its answer, the cost for
//! the program is small, and other clients are not affected.

use std::thread::JoinHandle;

use super::client::Client;
use super::packets::{SUBACK, UNSUBACK, connect_as, packet, subscribe_all, text};
use super::siege::Siege;
use crate::access::Folder;

/// Number of connections with the same key.
const CLIENTS: usize = 48;

/// Filters in each SUBSCRIBE, and in the UNSUBSCRIBE that follows it.
const FILTERS: usize = 60;

/// Pairs of SUBSCRIBE and UNSUBSCRIBE that each connection sends without waiting for an answer.
const PAIRS: usize = 400;

/// Limit for the memory of the program, in MiB.
const MEMORY_MIB: u64 = 128;

/// A SUBSCRIBE to `FILTERS` filters, followed by an UNSUBSCRIBE from all of them.
fn pair() -> Vec<u8> {
    let filters: Vec<String> = (0..FILTERS).map(|n| format!("a/{n}")).collect();
    let named: Vec<u8> = filters.iter().flat_map(|filter| text(filter)).collect();
    [subscribe_all(1, &filters), packet(0xA2, &[&[0, 2][..], &named].concat())].concat()
}

/// Safety A5.
#[test]
fn a_viewer_that_takes_filters_and_lets_them_go_without_end_costs_little_and_nobody_else_anything() {
    let folder = Folder::new("churn");
    folder.token(&["add", "lobby", "--role", "viewer"]);
    let (mut siege, token) = (Siege::with_keys(&folder), folder.token_of("lobby"));
    let churning = (0..CLIENTS).map(|n| {
        let connect = connect_as(&format!("viewer-{n}"), ("lobby", &token));
        let mut viewer = Client::try_connect(siege.broker, &connect).expect("it is let in");
        std::thread::spawn(move || {
            viewer.say(&pair().repeat(PAIRS));
            for _ in 0..PAIRS {
                assert_eq!(viewer.until(SUBACK).body[2..], [0; FILTERS]);
                viewer.until(UNSUBACK);
            }
        })
    });
    let churning: Vec<_> = churning.collect();
    let mut most = 0;
    while !churning.iter().all(JoinHandle::is_finished) {
        siege.is_served();
        most = most.max(siege.memory_mib());
    }
    churning.into_iter().for_each(|thread| thread.join().expect("each packet had its answer"));
    siege.stands();
    most = most.max(siege.memory_mib());
    assert!(most < MEMORY_MIB, "{most} MiB");
}
