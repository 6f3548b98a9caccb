//! Tests retained messages: they all arrive, at the right QoS, and only as fast as the client acknowledges them.

use std::collections::BTreeSet;

use super::scene::{OPERATOR, Scene, publish, subscribe, unsubscribe};
use crate::frame::PacketKind;
use crate::limits::{CLIENT_PACKET, KEPT_ROOM, KEPT_UNDER_WAY, WINDOW_BYTES};
use crate::message::Draft;
use crate::packet::Qos;
use crate::rights::Payer;

fn scene_with(count: usize, payload: &str, qos: Qos) -> Scene {
    let scene = Scene::of(OPERATOR);
    for n in 0..count {
        assert!(keep(&scene, &format!("a/{n:04}/b"), payload, qos));
    }
    scene
}

fn keep(scene: &Scene, topic: &str, payload: &str, qos: Qos) -> bool {
    let message = scene.broker.message(Draft::plain(topic, payload.as_bytes(), qos));
    scene.broker.retained.keep(&Payer::Anybody, &message, scene.now)
}

/// Returns everything that a client receives while it acknowledges every message. Also returns the largest number of
/// messages that were unacknowledged at once.
fn all_that_comes(scene: &mut Scene) -> (BTreeSet<String>, usize) {
    let (mut all, mut most) = (BTreeSet::new(), 0);
    loop {
        let got = scene.got();
        if got.is_empty() {
            return (all, most);
        }
        let ids: Vec<u16> = got.iter().filter_map(|words| words.split_once('#')?.1.split(' ').next()?.parse().ok()).collect();
        most = most.max(ids.len());
        for id in ids {
            scene.acknowledge(PacketKind::Puback, id);
        }
        all.extend(got.iter().map(|words| words.split(" q").next().unwrap().to_owned()));
    }
}

#[test]
fn five_thousand_kept_topics_on_one_wildcard_all_arrive_at_qos_0() {
    let mut scene = scene_with(5000, "x", Qos::One);
    scene.client(&subscribe(1, &[("a/#", Qos::Zero)])).unwrap();
    let (all, at_once) = all_that_comes(&mut scene);
    assert_eq!((all.len(), at_once), (5001, 0));
    assert!(all.contains("Publish a/0000/b=x") && all.contains("Publish a/4999/b=x"));
}

#[test]
fn five_thousand_kept_topics_on_one_wildcard_all_arrive_at_qos_1() {
    let mut scene = scene_with(5000, "x", Qos::One);
    scene.client(&subscribe(1, &[("#", Qos::One)])).unwrap();
    let (all, at_once) = all_that_comes(&mut scene);
    assert_eq!((all.len(), at_once), (5001, KEPT_UNDER_WAY));
}

#[test]
fn the_lesser_qos_counts_and_kept_messages_say_that_they_are() {
    let mut scene = Scene::of(OPERATOR);
    assert!(keep(&scene, "a", "0", Qos::Zero) && keep(&scene, "b", "2", Qos::Two));
    assert_eq!(scene.subscribe(&[("+", Qos::One)]), ["Suback (1, [1])", "Publish a=0 q0 kept", "Publish b=2 q1 #1 kept"]);
    assert_eq!(scene.subscribe(&[("b", Qos::Two)])[1..], ["Publish b=2 q2 #2 kept"]);
    assert_eq!(scene.subscribe(&[("b", Qos::Zero)])[1..], ["Publish b=2 q0 kept"]);
}

#[test]
fn to_subscribe_again_is_to_get_them_again() {
    let mut scene = scene_with(2, "x", Qos::Zero);
    assert_eq!(scene.subscribe(&[("a/#", Qos::Zero)]).len(), 3);
    assert_eq!(scene.subscribe(&[("a/#", Qos::Zero)]).len(), 3);
}

#[test]
fn a_client_that_takes_nothing_is_not_drowned() {
    let payload = "x".repeat(1000);
    let mut scene = scene_with(2000, &payload, Qos::Zero);
    scene.client(&subscribe(1, &[("#", Qos::Zero), ("a/#", Qos::Zero)])).unwrap();
    let waiting = scene.connection.to_client().len();
    assert!((KEPT_ROOM..KEPT_ROOM + 2000).contains(&waiting) && scene.connection.reads(), "{waiting}");
    assert!(!scene.connection.is_unread(), "it may be about to say something urgent");
    let mut got = 0;
    loop {
        let some = scene.got().len();
        got += some;
        if some == 0 {
            break;
        }
    }
    assert_eq!(got, 4001);
}

/// A long message is in memory once, however many clients wait for it.
#[test]
fn a_long_kept_message_is_not_copied_for_those_who_wait_for_it() {
    let payload = "x".repeat(CLIENT_PACKET / 2);
    let mut scene = scene_with(20, &payload, Qos::Zero);
    scene.client(&subscribe(1, &[("#", Qos::Zero)])).unwrap();
    let outbox = scene.connection.to_client();
    assert!(outbox.len() > payload.len() && outbox.own() < 100, "{} bytes of its own", outbox.own());
    let mut got = BTreeSet::new();
    while !scene.connection.to_client().is_empty() {
        got.extend(scene.got());
    }
    assert_eq!(got.len(), 21);
    assert!(got.iter().filter(|got| got.starts_with("Publish")).all(|got| got.contains(&*payload)));
}

#[test]
fn what_changes_while_they_are_on_their_way_arrives_as_it_is_then() {
    let mut scene = scene_with(50, "old", Qos::One);
    let got = scene.subscribe(&[("a/#", Qos::One)]);
    assert_eq!(got.len(), 1 + KEPT_UNDER_WAY);
    scene.client(&[publish(0x31, "a/0049/b", "new", 0), publish(0x31, "a/0048/b", "", 0)].concat()).unwrap();
    (1..=20).for_each(|id| scene.acknowledge(PacketKind::Puback, id));
    let (all, _) = all_that_comes(&mut scene);
    assert_eq!(all.len(), 30, "those that are kept still, and what has changed, as it did");
    assert!(all.contains("Publish a/0049/b=new"));
}

#[test]
fn nothing_more_comes_of_a_filter_that_was_let_go() {
    let mut scene = scene_with(50, "x", Qos::One);
    scene.subscribe(&[("a/#", Qos::One)]);
    scene.client(&unsubscribe(2, &["a/#"])).unwrap();
    (1..=20).for_each(|id| scene.acknowledge(PacketKind::Puback, id));
    assert_eq!(scene.got(), ["Unsuback 2"]);
}

/// The total size of the unacknowledged messages is limited, however many such messages the client allows.
#[test]
fn long_kept_messages_wait_for_acknowledgements() {
    let payload = "x".repeat(WINDOW_BYTES / 4);
    let mut scene = scene_with(10, &payload, Qos::One);
    scene.client(&subscribe(1, &[("#", Qos::One)])).unwrap();
    let (all, at_once) = all_that_comes(&mut scene);
    assert_eq!(all.len(), 11);
    assert!(at_once <= 4, "{at_once} at once");
}
