//! A STOP behind its sender's own flood, and those who do not read it: simulated, no time passing but that for which the sender waits.

use std::sync::Arc;
use std::time::Duration;

use bytes::BytesMut;

use super::scene::{OPERATOR, STOP, Scene, TestRights, broker, publish};
use crate::Broker;
use crate::limits::{LAG, LONG, NO_FLOOD, PATIENCE, QUIET, STILL};
use crate::packet::Qos;

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
    let broker = broker();
    let mut readers: Vec<Scene> = (0..crowd).map(|_| Scene::at_broker(&broker, OPERATOR, |_| {})).collect();
    readers.iter_mut().for_each(|reader| drop(reader.subscribe(&[("flood/#", Qos::Zero)])));
    let mut sender = Scene::at_broker(&broker, OPERATOR, |_| {});
    let (mut said, mut now, mut turns) = (said(), BEGINS, 0);
    while !said.is_empty() {
        sender.connection.handle_turn(&mut said, now).unwrap();
        let passed = std::mem::take(sender.connection.to_router());
        turns += 1;
        for (n, reader) in readers.iter_mut().enumerate() {
            if reader.connection.wants_router() {
                reader.router(&passed).unwrap();
            }
            if turns <= n * every {
                reader.connection.to_client().clear();
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

/// Nobody who stops reading holds up what an honest client says for long.
#[test]
fn a_stop_four_mebibytes_deep_in_its_senders_flood_waits_less_than_a_tenth_of_a_second_for_those_who_do_not_read() {
    assert_eq!(waited(1, 0), STILL, "it is waited for, in case it reads again");
    for (crowd, every) in [(8, 0), (64, 0), (8, 40), (64, 4), (192, 2)] {
        let waited = waited(crowd, every);
        assert!(waited <= 2 * STILL && waited >= STILL, "{crowd} every {every} turns: {waited:?}");
    }
    assert!(2 * STILL < Duration::from_millis(100) && 2 * STILL < PATIENCE);
}

/// Somebody alone who reads what he says himself, if he reads at all.
fn alone() -> Scene {
    let broker = Arc::new(Broker::new(TestRights));
    let mut alone = Scene::at_broker(&broker, OPERATOR, |_| {});
    alone.subscribe(&[("flood/#", Qos::Zero)]);
    alone
}

/// He says all this, and the router sends nothing of it back; how many bytes of it the router got, and when that was over.
fn unread(deaf: &mut Scene, mut said: BytesMut, mut now: Duration) -> (usize, Duration) {
    let mut passed = 0;
    while !said.is_empty() {
        while !deaf.connection.poll_behind(now).is_empty() {
            now = deaf.connection.waits_until(now);
            deaf.connection.handle_waited(now);
        }
        deaf.connection.handle_turn(&mut said, now).unwrap();
        passed += std::mem::take(deaf.connection.to_router()).len();
    }
    (passed, now)
}

/// Each message costs the router many times its bytes before it is lost there. The flood is taken all the same: something urgent may
/// stand in it.
#[test]
fn of_a_flood_whose_readers_are_not_waited_for_the_router_gets_little_and_the_stop_behind_it_is_heard() {
    let mut deaf = alone();
    let (passed, now) = unread(&mut deaf, said(), BEGINS);
    let before_it_is_a_flood = i64::try_from(LONG).unwrap() * i64::try_from(NO_FLOOD).unwrap();
    assert!(i64::try_from(passed).unwrap() <= before_it_is_a_flood + 2 * LAG, "{passed} bytes");
    assert_eq!(deaf.heard(), [format!("{STOP} ")]);
    // One message in a second is no flood, and somebody may read it.
    let (passed, _) = unread(&mut deaf, publish(0x30, "flood/a", "seldom", 0), now + 2 * QUIET);
    assert!(passed > 0);
}

/// What is kept is not lost for those who missed it, though it was the first of what they missed.
#[test]
fn what_was_kept_of_a_flood_that_went_no_further_comes_when_nothing_else_does() {
    let mut deaf = alone();
    let (_, now) = unread(&mut deaf, said(), BEGINS);
    let (passed, now) = unread(&mut deaf, publish(0x31, "flood/b", "newest", 0), now);
    assert_eq!(passed, 0);
    let _ = deaf.connection.poll_behind(now);
    deaf.connection.handle_timeout(now + QUIET).unwrap();
    assert_eq!(deaf.client_got(), ["Publish flood/b=newest q0"]);
}
