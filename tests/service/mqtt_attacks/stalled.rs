//! Subscribers that do not read, beside others that do: a stalled subscriber loses only its own messages, and
//! receives the newest ones when it reads again.

use std::sync::mpsc;

use super::client::Client;
use super::packets::{PUBACK, RETAIN, publish, subscribe};
use super::siege::Siege;

/// Total number of published messages.
const MESSAGES: usize = 60_000;

/// Number of publishers that run in parallel.
const PUBLISHERS: usize = 2;

/// Number of subscribers that read. The same number do not read.
const READERS: usize = 3;

/// Messages of one KiB each, more than the queue of a stalled subscriber holds.
const NOISE: usize = 20_000;

/// Number of subscribers that never read.
const STALLED: usize = 180;

/// Number of large retained messages.
const KEPT: usize = 120;

/// Size of a large message, in bytes.
const LONG: usize = 250 * 1024;

/// Number of large messages that are published after the retained ones.
const FLOOD: usize = 300;

/// Limit for the memory of the program, in MiB.
const MEMORY_MIB: u64 = 128;

/// Publishes all numbers of publisher `of`.
fn flood(mut client: Client, of: usize) {
    let mine: Vec<usize> = (0..MESSAGES).filter(|n| n % PUBLISHERS == of).collect();
    for numbers in mine.chunks(100) {
        let said = numbers.iter().flat_map(|n| publish(&format!("flood/{of}"), format!("{n:0100}").as_bytes(), 0, 0, 0));
        client.say(&said.collect::<Vec<u8>>());
    }
    client.settle();
}

/// Safety A5.
#[test]
fn those_who_read_miss_nothing_beside_those_who_do_not() {
    miss_nothing(Siege::begin());
}

/// Safety A5.
#[cfg(feature = "rumqttd-router")]
#[test]
fn those_who_read_miss_nothing_beside_those_who_do_not_where_rumqttd_routes() {
    miss_nothing(Siege::routed_by("rumqttd"));
}

/// The setting for rumqttd must not prevent the start of a program that was built without rumqttd.
#[cfg(not(feature = "rumqttd-router"))]
#[test]
fn without_rumqttd_the_programs_own_router_takes_its_place_and_the_console_and_the_log_say_so() {
    let siege = Siege::routed_by("rumqttd");
    let told = "--features rumqttd-router";
    let state = siege.program.json("state");
    assert!(state["log"].to_string().contains(told), "{state:#}");
    assert!(siege.program.read("/", &[]).text().contains(told), "the console says it");
    assert!(siege.said().contains(told), "the log says it");
    miss_nothing(siege);
}

fn miss_nothing(mut siege: Siege) {
    let come = |n: usize, what: &str, qos: u8| {
        let mut client = siege.client(&format!("{what}-{n}"));
        assert_eq!(client.subscribe("flood/#", qos), qos);
        client
    };
    let stalled: Vec<Client> = (0..READERS).map(|n| come(n, "stalled", u8::from(n > 0))).collect();
    let readers: Vec<Client> = (0..READERS).map(|n| come(n, "reader", 0)).collect();
    let reading = readers.into_iter().map(|mut reader| {
        std::thread::spawn(move || {
            let mut next = [0, 1];
            for _ in 0..MESSAGES {
                let message = reader.message();
                let number: usize = String::from_utf8_lossy(&message.payload).parse().expect("a number");
                let expected = &mut next[number % PUBLISHERS];
                assert_eq!(number, *expected, "none is missing, and all in order");
                *expected += PUBLISHERS;
            }
        })
    });
    let reading: Vec<_> = reading.collect();
    let publishers = (0..PUBLISHERS).map(|of| (siege.client(&format!("publisher-{of}")), of));
    let publishing: Vec<_> = publishers.map(|(client, of)| std::thread::spawn(move || flood(client, of))).collect();
    for thread in publishing.into_iter().chain(reading) {
        thread.join().expect("everything was said and heard");
    }
    siege.stands();
    drop(stalled);
}

#[test]
fn whoever_fell_behind_gets_the_newest_of_each_topic_when_it_reads_again() {
    let siege = Siege::begin();
    let mut late = siege.client("late");
    assert_eq!(late.subscribe("late/#", 0), 0);
    let mut publisher = siege.client("publisher");
    let noise = publish("late/noise", &[b'x'; 1024], 0, 0, 0).repeat(100);
    let mut make_noise = || (0..NOISE / 100).for_each(|_| publisher.say(&noise));
    make_noise();
    let mut teller = siege.client("teller");
    teller.say(&publish("late/state", b"newest", 0, RETAIN, 0));
    teller.settle();
    make_noise();
    publisher.settle();
    let told = loop {
        let message = late.message();
        if message.topic == "late/state" {
            break message;
        }
    };
    assert!(told.payload == b"newest" && !told.is_kept, "as somebody who was here all the time: {told:?}");
}

/// Safety A5: stalled subscribers share one queue limit. If it is exceeded, the subscriber that has not read for the
/// longest time is evicted.
#[test]
fn a_crowd_that_never_reads_costs_little_and_those_who_read_miss_nothing() {
    let mut siege = Siege::begin();
    let mut keeper = siege.client("keeper");
    for n in 0..KEPT {
        keeper.say(&publish(&format!("kept/{n}"), &vec![b'x'; LONG], 1, RETAIN, 7));
        keeper.until(PUBACK);
    }
    let mut reader = siege.client("reader");
    assert_eq!(reader.subscribe("flood/#", 0), 0);
    let stalled: Vec<Client> = (0..STALLED)
        .map(|n| {
            let mut client = siege.client(&format!("stalled-{n}"));
            client.say(&subscribe(1, "#", u8::from(n % 2 == 0)));
            client
        })
        .collect();
    siege.is_served();
    let (read, has_read) = mpsc::channel();
    let reading = std::thread::spawn(move || {
        for n in 0..FLOOD {
            let message = reader.message();
            read.send(()).expect("it is waited for");
            assert!(message.payload.starts_with(format!("{n} ").as_bytes()) && message.payload.len() == LONG, "message {n}");
        }
    });
    let (mut publisher, mut most) = (siege.client("publisher"), 0);
    for n in 0..FLOOD {
        let mut payload = format!("{n} ").into_bytes();
        payload.resize(LONG, b'x');
        publisher.say(&publish(&format!("flood/{}", n % 5), &payload, 0, 0, 0));
        most = most.max(siege.memory_mib());
        // The publisher waits for the reader, so the test works on slow machines.
        has_read.recv().expect("it reads");
    }
    publisher.settle();
    reading.join().expect("it has read all of it");
    most = most.max(siege.memory_mib());
    assert!(most < MEMORY_MIB, "{most} MiB");
    siege.stands();
    drop(stalled);
}
