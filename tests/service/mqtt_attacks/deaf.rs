//! Clients that publish without pause to whoever reads none of it, themselves above all: each costs little, nobody else anything, and a
//! STOP behind all of it halts.

use std::thread::JoinHandle;

use super::client::Client;
use super::packets::publish;
use super::siege::Siege;

const STOP: &str = "hallsweep/discovery/command/stop";

/// So many clients,
const DEAF: usize = 20;

/// each of which says so much,
const MESSAGES: usize = 100_000;

/// in so many bytes each, which is more than waits anywhere for it,
const MESSAGE: usize = 100;

/// may cost so much together, in MiB.
const MOST_MIB: u64 = 64;

/// A client that reads what is said there, and reads nothing of it.
fn deaf(siege: &Siege, n: usize, filter: &str) -> Client {
    let mut client = siege.client(&format!("deaf-{n}"));
    assert_eq!(client.subscribe(filter, 0), 0);
    client
}

/// They all say what they have to say, each on a topic of its own, and STOP at the end.
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

/// The most memory that the program has in use until they have said it; others are served meanwhile.
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
