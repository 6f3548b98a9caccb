//! Tests sessions between connections: the filters of a client, its unacknowledged messages, and the messages that
//! wait for it.

use std::sync::Arc;

use super::scene::{OPERATOR, Scene, broker, publish, unsubscribe};
use crate::frame::PacketKind;
use crate::limits::{AWAY, QUEUE, QUEUE_BYTES, WINDOW, WINDOW_BYTES};
use crate::message::Draft;
use crate::packet::Qos;
use crate::{Broker, Session};

fn back(broker: &Arc<Broker>, session: Session) -> Scene {
    Scene::at_broker(broker, OPERATOR, |terms| terms.session = session)
}

/// Section 4.4: unacknowledged messages are sent again with DUP, under the same ids and in the same order.
#[test]
fn what_was_not_acknowledged_comes_again_in_the_next_connection() {
    let broker = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let mut scene = writer.reader(&[("a/#", Qos::Two)]);
    writer.client(&publish(0x33, "a/kept", "0", 9)).unwrap();
    let mut session = scene.connection.into_session().unwrap();
    for _ in 0..2 {
        scene = back(&broker, session);
        scene.got();
        session = scene.connection.into_session().unwrap();
    }
    scene = back(&broker, session);
    assert_eq!(scene.got(), ["Publish a/kept=0 q1 #1 again"], "as often as it breaks");
    scene.acknowledge(PacketKind::Puback, 1);
    writer.client(&[publish(0x32, "a/1", "x", 1), publish(0x34, "a/2", "y", 2), publish(0x34, "a/3", "z", 3)].concat()).unwrap();
    assert_eq!(scene.got(), ["Publish a/1=x q1 #2", "Publish a/2=y q2 #3", "Publish a/3=z q2 #4"]);
    scene.acknowledge(PacketKind::Pubrec, 3);
    assert_eq!(scene.got(), ["Pubrel 3"]);
    let mut scene = back(&broker, scene.connection.into_session().unwrap());
    assert_eq!(scene.got(), ["Publish a/1=x q1 #2 again", "Pubrel 3", "Publish a/3=z q2 #4 again"]);
    scene.acknowledge(PacketKind::Pubcomp, 3);
    scene.acknowledge(PacketKind::Puback, 2);
    let mut scene = back(&broker, scene.connection.into_session().unwrap());
    assert_eq!(scene.got(), ["Publish a/3=z q2 #4 again"]);
}

#[test]
fn an_answer_to_what_was_not_sent_does_nothing() {
    let mut scene = Scene::of(OPERATOR);
    scene.subscribe(&[("#", Qos::Two)]);
    scene.client(&[publish(0x32, "a", "x", 1), publish(0x34, "b", "y", 2)].concat()).unwrap();
    scene.got();
    for (kind, id) in [
        (PacketKind::Puback, 2),
        (PacketKind::Pubcomp, 1),
        (PacketKind::Puback, 9),
        (PacketKind::Pubcomp, 9),
        (PacketKind::Puback, 1000),
    ] {
        scene.acknowledge(kind, id);
    }
    scene.acknowledge(PacketKind::Pubrec, 1);
    assert_eq!(scene.got(), ["Pubrel 1"], "whoever asks is answered");
    let broker = scene.broker.clone();
    assert_eq!(back(&broker, scene.connection.into_session().unwrap()).got().len(), 2);
}

#[test]
fn whoever_is_away_gets_what_is_to_reach_him_surely_and_of_the_rest_what_is_kept() {
    let broker = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let scene = writer.reader(&[("a/#", Qos::One), ("b/#", Qos::Zero)]);
    let session = scene.connection.into_session().unwrap();
    let said = [
        publish(0x32, "a/1", "x", 1),
        publish(0x30, "a/2", "lost", 0),
        publish(0x33, "b/1", "kept", 2),
        publish(0x32, "b/2", "lost", 3),
        publish(0x32, "a/3", "y", 4),
    ];
    writer.client(&said.concat()).unwrap();
    let mut scene = back(&broker, session);
    assert_eq!(scene.read(), ["a/1=x q1", "a/3=y q1", "b/1=kept q0"]);
    writer.client(&publish(0x30, "b/2", "now", 0)).unwrap();
    assert_eq!(scene.read(), ["b/2=now q0"]);
    scene.client(&unsubscribe(3, &["b/#"])).unwrap();
    assert_eq!(scene.got(), ["Unsuback 3"]);
    assert_eq!(scene.connection.into_session().unwrap().filters().collect::<Vec<_>>(), ["a/#"]);
    assert!(
        broker.readers.of("a/1", None).is_empty() && broker.readers.of("b/1", None).is_empty(),
        "a session that is dropped is forgotten"
    );
}

/// Safety A5: a client that is away cannot read, and there may be many such clients.
#[test]
fn for_one_who_is_away_only_so_much_waits_and_the_newest() {
    let broker = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let session = writer.reader(&[("a/#", Qos::One)]).connection.into_session().unwrap();
    for n in 0..10_000 {
        writer.client(&publish(0x32, "a/b", &format!("{n:0100}"), 1)).unwrap();
    }
    assert!(broker.beside() <= QUEUE, "{} bytes", broker.beside());
    let much = vec![broker.message(Draft::plain("x", &vec![0; AWAY + 1], Qos::One))];
    writer.client(&[publish(0x33, "a/kept", "newest", 2), publish(0x32, "a/b", "one too many", 3)].concat()).unwrap();
    drop(much);
    let mut scene = back(&broker, session);
    let mut got = Vec::new();
    for _ in 0..10_000 / WINDOW {
        let some = scene.got();
        for id in some.iter().filter_map(|words| words.split_once('#')?.1.split(' ').next()?.parse().ok()) {
            scene.acknowledge(PacketKind::Puback, id);
        }
        got.extend(some);
    }
    assert!(got.iter().any(|words| words.contains("9999 q1")) && !got.iter().any(|words| words.contains("too many")));
    assert!(got.last().is_some_and(|last| last.contains("a/kept=newest")), "{:?}", got.last());
}

/// Section 4.9 of MQTT 5, which the broker applies to MQTT 3.1.1 as well.
#[test]
fn a_client_that_acknowledges_nothing_has_so_many_and_gets_what_it_need_not_acknowledge() {
    let mut scene = Scene::of(OPERATOR);
    let mut reader = scene.reader(&[("#", Qos::One)]);
    for n in 0..2 * WINDOW {
        scene.client(&publish(0x32, "a", &n.to_string(), 1)).unwrap();
    }
    let got = reader.got();
    assert_eq!((got.len(), reader.connection.has_window()), (WINDOW, false));
    reader.acknowledge(PacketKind::Puback, 50);
    assert_eq!(reader.got(), ["Publish a=100 q1 #101"]);
}

/// Safety A5: unacknowledged messages take memory too. They are dropped when their client disconnects while the
/// messages for absent clients take too much memory.
#[test]
fn there_is_an_end_to_the_bytes_of_what_is_not_acknowledged() {
    let broker = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let mut reader = writer.reader(&[("a", Qos::One)]);
    let long = "x".repeat(WINDOW_BYTES / 4);
    for _ in 0..8 {
        writer.client(&publish(0x33, "a", &long, 1)).unwrap();
    }
    let got: usize = std::iter::from_fn(|| Some(reader.got().len()).filter(|got| *got > 0)).sum();
    assert_eq!((got, reader.connection.has_window()), (4, false));
    assert!(reader.connection.shared() > WINDOW_BYTES && broker.beside() < WINDOW_BYTES + QUEUE_BYTES);
    let _much = broker.message(Draft::plain("x", &vec![0; AWAY], Qos::One));
    let mut again = back(&broker, reader.connection.into_session().unwrap());
    let got = again.read();
    assert_eq!((got.len(), got[0].ends_with(" q1")), (1, true), "of what it has missed the newest that is kept");
}
