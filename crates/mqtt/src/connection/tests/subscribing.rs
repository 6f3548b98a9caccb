//! Tests subscriptions: who receives what, and that each packet has one answer.

use super::scene::{OPERATOR, Scene, VIEWER, publish, subscribe, unsubscribe};
use crate::limits::{FILTER_BYTES, FILTERS, PACKET_FILTERS};
use crate::packet::Qos;

#[test]
fn refusals_stand_in_their_places_among_what_is_granted() {
    let mut scene = Scene::of(VIEWER);
    let filters = [("$SYS/#", Qos::Zero), ("a/#", Qos::Two), ("$share/g/a", Qos::One), ("b#", Qos::One), ("b", Qos::Zero)];
    scene.client(&subscribe(9, &filters)).unwrap();
    assert_eq!(scene.got(), ["Suback (9, [128, 2, 128, 128, 0])"]);
}

#[test]
fn one_unsuback_for_each_unsubscribe_whatever_is_known() {
    let mut scene = Scene::of(OPERATOR);
    scene.subscribe(&[("a", Qos::Zero), ("b", Qos::One), ("c", Qos::One)]);
    scene.client(&unsubscribe(5, &["a", "never", "b", "a", "$SYS/#"])).unwrap();
    assert_eq!(scene.got(), ["Unsuback 5"]);
    scene.client(&[publish(0x30, "a", "x", 0), publish(0x30, "b", "x", 0), publish(0x30, "c", "x", 0)].concat()).unwrap();
    assert_eq!(scene.read(), ["c=x q0"]);
}

/// Section 3.8.4: the new subscription replaces the one before.
#[test]
fn a_filter_that_is_asked_for_again_is_held_once_at_its_new_quality() {
    let mut scene = Scene::of(OPERATOR);
    assert_eq!(scene.subscribe(&[("a", Qos::Zero), ("a", Qos::One)]), ["Suback (1, [0, 1])"]);
    for (qos, got) in [(Qos::Two, "a=x q2"), (Qos::Zero, "a=x q0")] {
        scene.subscribe(&[("a", qos)]);
        scene.client(&publish(0x34, "a", "x", 7)).unwrap();
        assert_eq!(scene.read(), [got]);
        scene.client(&[0x62, 2, 0, 7]).unwrap();
    }
}

/// Section 3.3.5: the client gets one copy, at the highest QoS of the filters that match.
#[test]
fn whoever_holds_several_filters_that_match_gets_a_message_once() {
    let mut scene = Scene::of(OPERATOR);
    scene.subscribe(&[("a/#", Qos::Zero), ("a/+", Qos::Two), ("#", Qos::One)]);
    scene.client(&publish(0x34, "a/b", "x", 7)).unwrap();
    assert_eq!(scene.read(), ["a/b=x q2"]);
}

#[test]
fn a_connection_holds_so_many_filters() {
    let mut scene = Scene::of(OPERATOR);
    let names: Vec<String> = (0..FILTERS).map(|n| format!("a/{n}")).collect();
    let filters: Vec<(&str, Qos)> = names.iter().map(|name| (&**name, Qos::Zero)).collect();
    for packet in filters.chunks(PACKET_FILTERS) {
        assert_eq!(scene.subscribe(packet), [format!("Suback (1, {:?})", vec![0; packet.len()])]);
    }
    assert_eq!(scene.subscribe(&[("a/0", Qos::One), ("b", Qos::Zero)]), ["Suback (1, [1, 128])"], "one of them may change");
    scene.client(&unsubscribe(2, &["a/0"])).unwrap();
    scene.got();
    assert_eq!(scene.subscribe(&[("b", Qos::Zero)]), ["Suback (1, [0])"]);
}

#[test]
fn the_filters_of_a_connection_have_so_many_bytes_together() {
    let mut scene = Scene::of(OPERATOR);
    let names: Vec<String> = (0..FILTER_BYTES / 512).map(|n| format!("{n:0>512}")).collect();
    for name in &names {
        assert_eq!(scene.subscribe(&[(name, Qos::Zero)]), ["Suback (1, [0])"]);
    }
    assert_eq!(scene.subscribe(&[("b", Qos::Zero)]), ["Suback (1, [128])"]);
    scene.client(&unsubscribe(2, &[&names[0]])).unwrap();
    scene.got();
    assert_eq!(scene.subscribe(&[("b", Qos::Zero)]), ["Suback (1, [0])"]);
}

/// Section 3.8.4: a new subscriber gets the messages that are published after its SUBSCRIBE, in order.
#[test]
fn what_comes_in_one_piece_with_a_subscribe_comes_back_behind_its_answer() {
    let mut scene = Scene::of(OPERATOR);
    let piece = [
        publish(0x30, "a", "before", 0),
        subscribe(3, &[("a", Qos::Zero)]),
        publish(0x30, "a", "1", 0),
        publish(0x30, "a", "2", 0),
    ];
    scene.client(&piece.concat()).unwrap();
    assert_eq!(scene.got(), ["Suback (3, [0])", "Publish a=1 q0", "Publish a=2 q0"]);
}
