//! A STOP behind its sender's own flood, and those who do not read it: simulated, no time passing but that for which the sender waits.

use std::time::Duration;

use bytes::BytesMut;

use super::scene::{OPERATOR, STOP, Scene, gatehouse, publish};
use crate::inbound::mqtt::gate::limits::{PATIENCE, STILL};
use crate::inbound::mqtt::gate::packet::Qos;

/// So deep the STOP stands, in messages of a kibibyte.
const DEEP: usize = 4096;

/// When the sender begins.
const BEGINS: Duration = Duration::from_secs(100);

/// The flood, and a STOP behind it.
fn said() -> BytesMut {
    let mut said = BytesMut::new();
    let message = publish(0x30, "flood/a", &"x".repeat(1000), 0);
    (0..DEEP).for_each(|_| said.extend_from_slice(&message));
    said.extend_from_slice(&publish(0x30, STOP, "", 0));
    said
}

/// How long it takes until the STOP is heard beside so many subscribers, of whom one after the other stops reading
/// every so many turns. Whoever reads is never found behind.
fn waited(crowd: usize, every: usize) -> Duration {
    let gatehouse = gatehouse();
    let mut readers: Vec<Scene> = (0..crowd).map(|_| Scene::in_house(&gatehouse, OPERATOR, |_| {})).collect();
    readers.iter_mut().for_each(|reader| drop(reader.subscribe(&[("flood/#", Qos::Zero)])));
    let mut sender = Scene::in_house(&gatehouse, OPERATOR, |_| {});
    let (mut said, mut now, mut turns) = (said(), BEGINS, 0);
    while !said.is_empty() {
        sender.turnstile.handle_turn(&mut said, now).unwrap();
        let passed = std::mem::take(sender.turnstile.to_engine());
        turns += 1;
        for (n, reader) in readers.iter_mut().enumerate() {
            if reader.turnstile.wants_engine() {
                reader.engine(&passed).unwrap();
            }
            if turns <= n * every {
                reader.turnstile.to_client().clear();
            }
            reader.turnstile.note_room(now);
        }
        while !sender.turnstile.poll_behind(now).is_empty() {
            now = sender.turnstile.waits_until(now);
            sender.turnstile.handle_waited(now);
        }
    }
    assert_eq!(sender.heard(), [format!("{STOP} ")]);
    now - BEGINS
}

/// Safety S1, S7.
#[test]
fn a_stop_four_mebibytes_deep_in_its_senders_flood_waits_less_than_a_tenth_of_a_second_for_those_who_do_not_read() {
    assert_eq!(waited(1, 0), STILL, "it is waited for, in case it reads again");
    for (crowd, every) in [(8, 0), (64, 0), (8, 40), (64, 4), (192, 2)] {
        let waited = waited(crowd, every);
        assert!(waited <= 2 * STILL && waited >= STILL, "{crowd} every {every} turns: {waited:?}");
    }
    assert!(2 * STILL < Duration::from_millis(100) && 2 * STILL < PATIENCE);
}
