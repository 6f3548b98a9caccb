//! Tests publishing: who receives a message, what is a command, retained or dropped, and that everything is
//! acknowledged.

use super::scene::{OPERATOR, START, STOP, Scene, VIEWER, publish, taken};
use crate::frame::PacketKind;
use crate::limits::{CLIENT_PACKET, HANDLED, UNRELEASED};
use crate::packet::Qos;
use crate::{Announcement, Ended, Epoch, Mark};

const NONE: [&str; 0] = [];

/// Section 3.8.4: a message is sent at the lower of its own QoS and the subscription's QoS.
#[test]
fn messages_come_at_the_lesser_of_both_qualities_and_are_acknowledged() {
    let mut scene = Scene::of(OPERATOR);
    let mut readers = [Qos::Zero, Qos::One, Qos::Two].map(|qos| scene.reader(&[("#", qos)]));
    let script = [
        publish(0x30, "a", "0", 0),
        publish(0x31, "a", "1", 0),
        publish(0x33, "a", "2", 7),
        publish(0x35, "b", "3", 8),
        publish(0x3D, "b", "3", 8),
    ];
    scene.client(&script.concat()).unwrap();
    scene.acknowledge(PacketKind::Pubrel, 8);
    assert_eq!(scene.got(), ["Puback 7", "Pubrec 8", "Pubrec 8", "Pubcomp 8"]);
    let got = readers.each_mut().map(Scene::read);
    assert_eq!(got[0], ["a=0 q0", "a=1 q0", "a=2 q0", "b=3 q0"]);
    assert_eq!(got[1], ["a=0 q0", "a=1 q0", "a=2 q1", "b=3 q1"]);
    assert_eq!(got[2], ["a=0 q0", "a=1 q0", "a=2 q1", "b=3 q2"]);
    scene.client(&publish(0x34, "b", "4", 8)).unwrap();
    assert_eq!(readers[0].read(), ["b=4 q0"], "a released id is free again");
}

#[test]
fn what_is_no_topic_here_goes_nowhere_and_is_acknowledged() {
    let mut scene = Scene::of(OPERATOR);
    let mut everybody = scene.everybody();
    let long = "a".repeat(513);
    let deep = "a/".repeat(32);
    for topic in ["$SYS/a", "$share/a/b", "$", &long, &deep] {
        scene.client(&publish(0x33, topic, "x", 7)).unwrap();
        assert_eq!((everybody.got(), scene.got()), (vec![], vec!["Puback 7".to_owned()]), "{topic}");
    }
    assert_eq!(scene.broker.retained.count(), 0);
    scene.client(&publish(0x30, "日本", "x", 0)).unwrap();
    assert_eq!(everybody.got(), ["Publish 日本=x q0"]);
}

#[test]
fn a_forbidden_message_is_acknowledged_and_goes_nowhere() {
    for (tier, topic) in [(OPERATOR, "site/robot/state/robot"), (VIEWER, "a"), (OPERATOR, "directory/robot")] {
        let mut scene = Scene::of(tier);
        let mut everybody = scene.everybody();
        let script = [publish(0x31, topic, "x", 0), publish(0x33, topic, "x", 1), publish(0x35, topic, "x", 2)];
        scene.client(&script.concat()).unwrap();
        scene.client(&[0x62, 2, 0, 2]).unwrap();
        assert_eq!(everybody.got(), NONE, "{topic}");
        assert_eq!(scene.got(), ["Puback 1", "Pubrec 2", "Pubcomp 2"]);
        assert_eq!(scene.broker.retained.count(), 0);
    }
}

#[test]
fn a_command_is_heard_before_it_goes_on_and_never_kept() {
    for tier in [OPERATOR, VIEWER] {
        let mut scene = Scene::of(tier);
        let mut everybody = scene.everybody();
        scene.client(&publish(0x31, STOP, "", 0)).unwrap();
        scene.client(&publish(0x33, "old/robotmind", "x", 3)).unwrap();
        scene.client(&publish(0x30, "site/robot/command", "forbidden", 0)).unwrap();
        assert_eq!(scene.heard(), [format!("{STOP} "), "old/robotmind x".into(), "site/robot/command forbidden".into()]);
        assert_eq!(everybody.read(), [format!("{STOP}= q0"), "old/robotmind=x q1".into()]);
        assert_eq!(scene.broker.retained.count(), 0);
    }
}

#[test]
fn the_program_itself_says_what_it_likes_and_keeps_all_but_commands() {
    let scene = Scene::of(OPERATOR);
    let mut everybody = scene.everybody();
    let announce = |topic, payload| scene.broker.publish(&Announcement { topic, payload, retain: true, properties: &[] });
    assert!(announce("site/robot/state/robot", b"x") && announce("old/events", b"y"));
    assert_eq!(everybody.read(), ["site/robot/state/robot=x q1", "old/events=y q1"]);
    assert_eq!((scene.broker.retained.count(), scene.heard().len()), (1, 0));
}

#[tokio::test]
async fn the_program_itself_hears_what_it_subscribed_to() {
    let mut scene = Scene::of(OPERATOR);
    let own = scene.broker.subscribe(&["a/+"]);
    scene.client(&[publish(0x30, "b", "x", 0), publish(0x30, "a/b", "y", 0)].concat()).unwrap();
    let message = own.next().await;
    assert_eq!((message.topic(), message.payload()), ("a/b", &b"y"[..]));
}

#[test]
fn a_command_that_was_heard_is_not_heard_again_only_when_it_is_truly_the_same_packet() {
    let mut scene = Scene::of(OPERATOR);
    let mut heard = |bytes: &[u8]| {
        scene.client(bytes).unwrap();
        scene.heard().len()
    };
    assert_eq!(heard(&publish(0x32, START, "a", 7)), 1);
    assert_eq!(heard(&publish(0x3A, START, "a", 7)), 0, "the same, and marked");
    assert_eq!(heard(&publish(0x32, START, "a", 7)), 1, "not marked");
    assert_eq!(heard(&publish(0x3A, START, "b", 7)), 1, "marked, and something else");
    assert_eq!(heard(&publish(0x3A, START, "b", 8)), 1, "marked, and of an id that was not there");
    assert_eq!(heard(&publish(0x30, START, "b", 0)) + heard(&publish(0x30, START, "b", 0)), 2, "QoS 0 is always heard");
    assert_eq!(scene.got().len(), 5, "all of QoS 1 are acknowledged");
}

/// The listener is told that the command may be old.
#[test]
fn a_command_that_was_sent_before_in_another_connection_is_heard_as_such() {
    let mut scene = Scene::of(OPERATOR);
    scene.client(&[publish(0x3A, START, "a", 7), publish(0x32, START, "b", 8), publish(0x3C, START, "c", 9)].concat()).unwrap();
    assert_eq!(scene.heard(), [format!("{START} a again"), format!("{START} b"), format!("{START} c again")]);
}

#[test]
fn a_command_of_qos_2_is_heard_once_until_it_is_released() {
    let mut scene = Scene::of(OPERATOR);
    let mut everybody = scene.everybody();
    scene.client(&[publish(0x34, START, "a", 7), publish(0x3C, START, "a", 7)].concat()).unwrap();
    assert_eq!((scene.heard().len(), everybody.got().len()), (1, 1));
    scene.client(&publish(0x34, START, "a", 7)).unwrap();
    assert_eq!((scene.heard().len(), everybody.got().len()), (1, 0), "heard, as it is not marked; nobody else gets it twice");
    scene.acknowledge(PacketKind::Pubrel, 7);
    scene.client(&publish(0x3C, START, "a", 7)).unwrap();
    assert_eq!((scene.heard().len(), everybody.got().len()), (1, 1), "a new one, whatever its mark");
}

#[test]
fn a_command_of_qos_2_is_known_again_in_the_next_connection_of_a_session() {
    let mut scene = Scene::of(OPERATOR);
    scene.client(&publish(0x34, START, "a", 7)).unwrap();
    let broker = scene.broker.clone();
    let session = scene.connection.into_session().unwrap();
    let mut scene = Scene::at_broker(&broker, OPERATOR, |terms| terms.session = session);
    scene.client(&publish(0x3C, START, "a", 7)).unwrap();
    assert_eq!((scene.heard().len(), scene.got()), (0, vec!["Pubrec 7".to_owned()]));
}

#[test]
fn a_stop_is_heard_as_often_as_it_comes_whatever_was_heard_before() {
    let mut scene = Scene::of(OPERATOR);
    for first in [0x32, 0x3A, 0x34, 0x3C] {
        scene.client(&publish(first, STOP, "a", 7)).unwrap();
        assert_eq!(scene.heard().len(), 1, "{first:#x}");
    }
}

/// Marks of handled packets must not pile up for a client that never sends an urgent message.
#[test]
fn what_is_known_of_packets_is_forgotten_when_they_were_taken() {
    let mut scene = Scene::of(OPERATOR);
    let (said, before) = (publish(0x30, "a", "x", 0), scene.connection.held());
    for round in 0..1000 {
        let begins = round * u64::try_from(said.len()).unwrap();
        scene.connection.handle_mark(Mark { begins, epoch: Epoch(round), heard_ahead: false });
        scene.client(&said).unwrap();
    }
    assert!(scene.connection.held() < before + 100, "{}", scene.connection.held());
}

/// The same packets arrive twice. Each time, the first of their two STOPs has halted on arrival.
#[test]
fn a_stop_that_halted_when_it_came_does_not_halt_again_when_its_turn_comes() {
    let mut scene = Scene::of(OPERATOR);
    let mut everybody = scene.everybody();
    let [other, stop, start] = [publish(0x30, "a", "x", 0), publish(0x30, STOP, "", 0), publish(0x30, START, "", 0)];
    let waiting = [&other[..], &stop, &start, &stop].concat();
    for round in 0..2 {
        let begins = round * u64::try_from(waiting.len()).unwrap();
        scene.connection.handle_mark(Mark { begins: begins + other.len() as u64, epoch: Epoch(1), heard_ahead: true });
        scene.client(&waiting).unwrap();
        assert_eq!(scene.heard(), [format!("{START} "), format!("{STOP} ")], "one of the two had halted in round {round}");
        assert_eq!(everybody.got().len(), 4, "everybody is told of both");
    }
}

#[test]
fn what_is_remembered_of_commands_has_an_end() {
    let mut scene = Scene::of(OPERATOR);
    for id in 1..=2 * u16::try_from(HANDLED).unwrap() {
        scene.client(&publish(0x32, START, "a", id)).unwrap();
    }
    scene.heard();
    scene.client(&publish(0x3A, START, "a", 1)).unwrap();
    assert_eq!(scene.heard().len(), 1, "forgotten, and so heard again");
}

#[test]
fn nobody_leaves_too_much_unreleased_and_a_stop_is_heard_all_the_same() {
    let mut scene = Scene::of(OPERATOR);
    for id in 1..=u16::try_from(UNRELEASED).unwrap() {
        scene.client(&publish(0x34, "a", "x", id)).unwrap();
    }
    let ended = scene.client(&publish(0x34, STOP, "", 60_000));
    assert_eq!(ended, Err(Ended::Unreleased));
    assert_eq!(scene.heard().len(), 1);
}

#[test]
fn what_nobody_reads_is_kept_all_the_same_and_costs_nothing_else() {
    let mut scene = Scene::of(OPERATOR);
    let said = [publish(0x31, "a", "1", 0), publish(0x33, "b", "2", 7), publish(0x30, STOP, "", 0)].concat();
    scene.client(&said).unwrap();
    assert_eq!((scene.got(), scene.heard().len()), (vec!["Puback 7".to_owned()], 1));
    assert_eq!((scene.broker.retained.count(), scene.broker.beside()), (2, 0));
}

/// A long message is in memory once, however many clients wait for it.
#[test]
fn a_long_message_is_there_once_for_all_who_wait_for_it() {
    let mut writer = Scene::of(OPERATOR);
    let mut readers = [Qos::Zero, Qos::One].map(|qos| writer.reader(&[("a", qos)]));
    let payload = "x".repeat(CLIENT_PACKET / 2);
    writer.client(&publish(0x33, "a", &payload, 9)).unwrap();
    assert_eq!(writer.broker.beside(), 0, "what is kept is the same");
    for (reader, first) in readers.iter_mut().zip([0x30, 0x32]) {
        reader.connection.handle_come(reader.now);
        assert!(reader.connection.held() < 100 && reader.connection.shared() >= payload.len());
        assert_eq!(taken(reader.connection.to_client()), publish(first, "a", &payload, 1));
    }
    writer.client(&publish(0x31, "a", "", 0)).unwrap();
    let [first, second] = readers;
    drop(first);
    assert!(writer.broker.beside() > payload.len(), "it is not acknowledged yet");
    drop(second);
    assert_eq!(writer.broker.beside(), 0);
}

#[test]
fn clients_send_packets_of_256_kib() {
    let payload = "x".repeat(CLIENT_PACKET);
    assert!(matches!(Scene::of(OPERATOR).client(&publish(0x30, "a", &payload, 0)), Err(Ended::Malformed(_))));
    let fitting = publish(0x30, "a", &payload[..CLIENT_PACKET - 7], 0);
    assert_eq!(fitting.len(), CLIENT_PACKET);
    assert!(Scene::of(OPERATOR).client(&fitting).is_ok());
}
