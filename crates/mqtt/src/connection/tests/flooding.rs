//! Tests a STOP that follows its sender's own flood, while subscribers do not read. Time is simulated: only the
//! sender's waits take time.

use std::time::Duration;

use bytes::BytesMut;

use super::scene::{OPERATOR, STOP, Scene, broker, publish};
use crate::limits::{PATIENCE, QUEUE_BYTES, STILL};
use crate::packet::Qos;

/// Number of messages of 1 KiB before the STOP.
const DEEP: usize = 4096;

const BEGINS: Duration = Duration::from_secs(100);

fn flood() -> BytesMut {
    let mut said = BytesMut::new();
    let message = publish(0x30, "flood/a", &"x".repeat(1000), 0);
    (0..DEEP).for_each(|_| said.extend_from_slice(&message));
    said.extend_from_slice(&publish(0x30, STOP, "", 0));
    said
}

/// Returns how long the sender waits before the STOP takes effect. There are `crowd` subscribers, and one more of
/// them stops reading every `every` turns.
fn waited(crowd: usize, every: usize) -> Duration {
    let broker = broker();
    let mut readers: Vec<Scene> = (0..crowd).map(|_| Scene::at_broker(&broker, OPERATOR, |_| {})).collect();
    readers.iter_mut().for_each(|reader| drop(reader.subscribe(&[("flood/#", Qos::Zero)])));
    let mut sender = Scene::at_broker(&broker, OPERATOR, |_| {});
    let (mut said, mut now, mut turns) = (flood(), BEGINS, 0);
    while !said.is_empty() {
        sender.connection.handle_turn(&mut said, now).unwrap();
        turns += 1;
        for (n, reader) in readers.iter_mut().enumerate() {
            reader.connection.handle_come(reader.now);
            if turns <= n * every {
                while !reader.connection.to_client().is_empty() {
                    reader.connection.to_client().clear();
                    reader.connection.handle_drained(reader.now);
                }
            }
            reader.connection.note_room(now);
        }
        while !sender.connection.poll_behind(now).is_empty() {
            now = sender.connection.waits_until(now);
            sender.connection.handle_waited(now);
        }
    }
    assert_eq!(sender.heard(), [format!("{STOP} ")]);
    now - BEGINS
}

/// Subscribers that stop reading delay an honest client only briefly.
#[test]
fn a_stop_four_mebibytes_deep_in_its_senders_flood_waits_less_than_a_tenth_of_a_second_for_those_who_do_not_read() {
    assert_eq!(waited(1, 0), STILL, "it is waited for, in case it reads again");
    for (crowd, every) in [(8, 0), (64, 0), (8, 40), (64, 4), (192, 2)] {
        let waited = waited(crowd, every);
        assert!(waited <= 2 * STILL && waited >= STILL, "{crowd} every {every} turns: {waited:?}");
    }
    assert!(2 * STILL < Duration::from_millis(100) && 2 * STILL < PATIENCE);
}

/// A sender does not wait long for a subscriber that does not read, and such a subscriber uses little memory. The
/// subscriber still gets the newest message, and the retained message that it missed.
#[test]
fn of_a_flood_whose_readers_are_not_waited_for_the_newest_waits_and_the_stop_behind_it_is_heard() {
    let mut sender = Scene::of(OPERATOR);
    let mut deaf = sender.reader(&[("flood/#", Qos::Zero)]);
    let mut said = BytesMut::from(&publish(0x31, "flood/kept", "missed", 0)[..]);
    said.unsplit(flood());
    let mut now = BEGINS;
    while !said.is_empty() {
        sender.connection.handle_turn(&mut said, now).unwrap();
        while !sender.connection.poll_behind(now).is_empty() {
            now = sender.connection.waits_until(now);
            sender.connection.handle_waited(now);
        }
        assert!(sender.broker.beside() <= QUEUE_BYTES, "{}", sender.broker.beside());
    }
    assert_eq!(sender.heard(), [format!("{STOP} ")]);
    sender.client(&publish(0x30, "flood/a", "newest", 0)).unwrap();
    let mut got = Vec::new();
    loop {
        let some = deaf.read();
        if some.is_empty() {
            break;
        }
        got.extend(some);
    }
    let last = got.iter().rev().take(2).map(String::as_str).collect::<Vec<_>>();
    assert_eq!(last, ["flood/kept=missed q0", "flood/a=newest q0"]);
}
