//! Clients that publish without pause to subscribers that read nothing, above all to themselves: each costs little,
//! other clients are not affected, and a STOP after all the messages halts.

use std::thread::JoinHandle;

use super::client::Client;
use super::packets::publish;
use super::siege::Siege;

const STOP: &str = "hallsweep/discovery/command/stop";

/// Number of clients that do not read.
const DEAF: usize = 20;

/// Messages that each client publishes.
const MESSAGES: usize = 100_000;

/// Size of a message, in bytes. The messages of one client exceed every queue.
const MESSAGE: usize = 100;

/// Limit for the additional memory of the program, in MiB, for all clients together.
const MOST_MIB: u64 = 64;

/// A client that subscribes to this filter and reads none of the messages.
fn deaf(siege: &Siege, n: usize, filter: &str) -> Client {
    let mut client = siege.client(&format!("deaf-{n}"));
    assert_eq!(client.subscribe(filter, 0), 0);
    client
}

/// Makes each client publish all its messages on its own topic, and a STOP at the end.
fn say_all(deaf: Vec<Client>) -> Vec<JoinHandle<Client>> {
    let saying = deaf.into_iter().enumerate().map(|(n, mut client)| {
        std::thread::spawn(move || {
            let said = publish(&format!("deaf/{n}"), &[b'x'; MESSAGE], 0, 0, 0).repeat(1_000);
            (0..MESSAGES / 1_000).for_each(|_| client.say(&said));
            client.publish(STOP, b"");
            client
        })
    });
    saying.collect()
}

/// Highest memory of the program while the clients publish, in MiB. Also checks that other clients are served.
fn most_mib(siege: &mut Siege, saying: &[JoinHandle<Client>]) -> u64 {
    let mut most = 0;
    while !saying.iter().all(JoinHandle::is_finished) {
        most = most.max(siege.memory_mib());
        siege.is_served();
    }
    most.max(siege.memory_mib())
}

fn epoch(state: &serde_json::Value) -> u64 {
    state["mission"]["epoch"].as_u64().expect("an epoch")
}

/// Safety A5, S1.
#[test]
fn twenty_clients_who_read_nothing_of_what_they_say_cost_little_and_the_stop_behind_it_halts() {
    let themselves: fn(usize) -> String = |n| format!("deaf/{n}");
    for follows in [themselves, |n| format!("deaf/{}", n ^ 1), |_| "deaf/#".to_owned()] {
        let mut siege = Siege::begin();
        let (before, stops) = (siege.memory_mib(), epoch(&siege.program.json("state")));
        let saying = say_all((0..DEAF).map(|n| deaf(&siege, n, &follows(n))).collect());
        let most = most_mib(&mut siege, &saying).saturating_sub(before);
        siege.program.until("each of them has halted", |state| epoch(state) >= stops + DEAF as u64);
        assert!(most <= MOST_MIB, "{most} MiB, who follow {}", follows(0));
        siege.stands();
        saying.into_iter().for_each(|client| drop(client.join().expect("all of it is taken")));
    }
}
