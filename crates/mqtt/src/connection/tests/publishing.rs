//! What clients publish: where it goes, what is heard, what is kept and what is dropped, and that everything is acknowledged.

use std::sync::Arc;
use std::time::Duration;

use super::scene::{OPERATOR, START, STOP, Scene, TestRights, VIEWER, broker, publish, subscribe, taken};
use crate::budget::Payer;
use crate::limits::{
    CLIENT_PACKET, HANDLED, LIMITED_SHARE, PADDED, PARCELS_AWAY, QUIET, ROUTER_TOPICS, SHARE_TOPICS, SHARED, UNRELEASED,
};
use crate::packet::Qos;
use crate::rights::Principal;
use crate::{Broker, Ended, Epoch, Mark};

const NONE: [&str; 0] = [];

#[test]
fn messages_reach_the_router_at_qos_0_and_not_to_be_kept_and_are_acknowledged_here() {
    let mut scene = Scene::of(OPERATOR);
    let script = [
        publish(0x30, "a", "0", 0),
        publish(0x31, "a", "1", 0),
        publish(0x33, "a", "2", 7),
        publish(0x35, "b", "3", 8),
        publish(0x3D, "b", "3", 8),
    ];
    scene.client(&script.concat()).unwrap();
    scene.client(&[0x62, 2, 0, 8]).unwrap();
    assert_eq!(scene.router_got(), ["Publish a=0 q0", "Publish a=1 q0", "Publish a=2 q0", "Publish b=3 q0"]);
    assert_eq!(scene.client_got(), ["Puback 7", "Pubrec 8", "Pubrec 8", "Pubcomp 8"]);
    scene.client(&publish(0x34, "b", "4", 8)).unwrap();
    assert_eq!(scene.router_got(), ["Publish b=4 q0"], "a released id is free again");
}

#[test]
fn what_would_end_the_router_never_reaches_it() {
    let mut scene = Scene::of(OPERATOR);
    let long = "a".repeat(513);
    let deep = "a/".repeat(32);
    for topic in ["é", "日本", "$SYS/a", "$share/a/b", "$", &long, &deep] {
        scene.client(&publish(0x33, topic, "x", 7)).unwrap();
        assert_eq!((scene.router_got(), scene.client_got()), (vec![], vec!["Puback 7".to_owned()]), "{topic}");
    }
    assert_eq!(scene.broker.retained.count(), 0);
}

#[test]
fn a_forbidden_message_is_acknowledged_and_goes_nowhere() {
    for (principal, topic) in [(OPERATOR, "site/robot/state/robot"), (VIEWER, "a"), (OPERATOR, "directory/robot")] {
        let mut scene = Scene::of(principal);
        let script = [publish(0x31, topic, "x", 0), publish(0x33, topic, "x", 1), publish(0x35, topic, "x", 2)];
        scene.client(&script.concat()).unwrap();
        scene.client(&[0x62, 2, 0, 2]).unwrap();
        assert_eq!(scene.router_got(), NONE, "{topic}");
        assert_eq!(scene.client_got(), ["Puback 1", "Pubrec 2", "Pubcomp 2"]);
        assert_eq!(scene.broker.retained.count(), 0);
    }
}

#[test]
fn a_command_is_heard_before_it_goes_on_and_never_kept() {
    for principal in [OPERATOR, VIEWER] {
        let mut scene = Scene::of(principal);
        scene.client(&publish(0x31, STOP, "", 0)).unwrap();
        scene.client(&publish(0x33, "old/robotmind", "x", 3)).unwrap();
        scene.client(&publish(0x30, "site/robot/command", "forbidden", 0)).unwrap();
        assert_eq!(scene.heard(), [format!("{STOP} "), "old/robotmind x".into(), "site/robot/command forbidden".into()]);
        assert_eq!(scene.router_got(), [format!("Publish {STOP}= q0"), "Publish old/robotmind=x q0".into()]);
        assert_eq!(scene.broker.retained.count(), 0);
    }
}

#[test]
fn the_program_itself_is_not_heard_and_may_keep_what_it_likes_but_commands() {
    let mut scene = Scene::of(Principal::Program);
    let script = [publish(0x31, "site/robot/state/robot", "x", 0), publish(0x31, "old/events", "y", 0)];
    scene.client(&script.concat()).unwrap();
    assert!(scene.heard().is_empty());
    assert_eq!(scene.router_got(), ["Publish site/robot/state/robot=x q0", "Publish old/events=y q0"]);
    assert_eq!(scene.broker.retained.count(), 1);
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
    assert_eq!(scene.client_got().len(), 5, "all of QoS 1 are acknowledged");
}

/// Whoever carries it out is told that it may be old.
#[test]
fn a_command_that_was_sent_before_in_another_connection_is_heard_as_such() {
    let mut scene = Scene::of(OPERATOR);
    scene.client(&[publish(0x3A, START, "a", 7), publish(0x32, START, "b", 8), publish(0x3C, START, "c", 9)].concat()).unwrap();
    assert_eq!(scene.heard(), [format!("{START} a again"), format!("{START} b"), format!("{START} c again")]);
}

#[test]
fn a_command_of_qos_2_is_heard_once_until_it_is_released() {
    let mut scene = Scene::of(OPERATOR);
    scene.client(&[publish(0x34, START, "a", 7), publish(0x3C, START, "a", 7)].concat()).unwrap();
    assert_eq!((scene.heard().len(), scene.router_got().len()), (1, 1));
    scene.client(&publish(0x34, START, "a", 7)).unwrap();
    assert_eq!((scene.heard().len(), scene.router_got().len()), (1, 0), "heard, as it is not marked; nobody else gets it twice");
    scene.client(&[0x62, 2, 0, 7]).unwrap();
    scene.client(&publish(0x3C, START, "a", 7)).unwrap();
    assert_eq!((scene.heard().len(), scene.router_got().len()), (1, 1), "a new one, whatever its mark");
}

#[test]
fn a_command_of_qos_2_is_known_again_in_the_next_connection_of_a_session() {
    let mut scene = Scene::of(OPERATOR);
    scene.client(&publish(0x34, START, "a", 7)).unwrap();
    let broker = scene.broker.clone();
    let session = scene.connection.into_session();
    let mut scene = Scene::at_broker(&broker, OPERATOR, |terms| terms.session = session);
    scene.client(&publish(0x3C, START, "a", 7)).unwrap();
    assert_eq!((scene.heard().len(), scene.client_got()), (0, vec!["Pubrec 7".to_owned()]));
}

#[test]
fn a_stop_is_heard_as_often_as_it_comes_whatever_was_heard_before() {
    let mut scene = Scene::of(OPERATOR);
    for first in [0x32, 0x3A, 0x34, 0x3C] {
        scene.client(&publish(first, STOP, "a", 7)).unwrap();
        assert_eq!(scene.heard().len(), 1, "{first:#x}");
    }
}

/// Others may say urgent things for ever while a client says nothing that is held against it.
#[test]
fn what_is_known_of_packets_is_forgotten_when_they_were_taken() {
    let mut scene = Scene::of(OPERATOR);
    let (said, before) = (publish(0x30, "a", "x", 0), scene.connection.held());
    for round in 0..1000 {
        let begins = round * u64::try_from(said.len()).unwrap();
        scene.connection.handle_mark(Mark { begins, epoch: Epoch(round), heard_ahead: false });
        scene.client(&said).unwrap();
        scene.router_got();
    }
    assert!(scene.connection.held() < before + 100, "{}", scene.connection.held());
}

/// In the first wait for readers and in the second.
#[test]
fn a_stop_that_halted_when_it_came_does_not_halt_again_when_its_turn_comes() {
    let mut scene = Scene::of(OPERATOR);
    let [other, stop, start] = [publish(0x30, "a", "x", 0), publish(0x30, STOP, "", 0), publish(0x30, START, "", 0)];
    let waiting = [&other[..], &stop, &start, &stop].concat();
    for round in 0..2 {
        let begins = round * u64::try_from(waiting.len()).unwrap();
        scene.connection.handle_mark(Mark { begins: begins + other.len() as u64, epoch: Epoch(1), heard_ahead: true });
        scene.client(&waiting).unwrap();
        assert_eq!(scene.heard(), [format!("{START} "), format!("{STOP} ")], "one of the two had halted in round {round}");
        assert_eq!(scene.router_got().len(), 4, "everybody is told of both");
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
    assert!(matches!(ended, Err(Ended::TooMuch { most: UNRELEASED, .. })), "{ended:?}");
    assert_eq!(scene.heard().len(), 1);
}

/// One key's topics and filters leave room for those of others, and for what is urgent.
#[test]
fn a_key_has_so_many_topics_the_rest_is_acknowledged_and_dropped_and_a_stop_is_heard_all_the_same() {
    let broker = broker();
    let mut scene = Scene::at_broker(&broker, OPERATOR, |terms| terms.has_key = true);
    for n in 0..SHARE_TOPICS {
        scene.client(&publish(0x30, &format!("a/{n}"), "", 0)).unwrap();
    }
    assert_eq!(scene.router_got().len(), SHARE_TOPICS);
    for n in SHARE_TOPICS..75_000 {
        scene.client(&publish(0x33, &format!("a/{n}"), "x", 7)).unwrap();
        assert_eq!(scene.client_got(), ["Puback 7"]);
    }
    assert_eq!((scene.router_got().len(), broker.retained.count()), (0, 0));
    scene.client(&[publish(0x30, STOP, "", 0), publish(0x30, "a/0", "", 0)].concat()).unwrap();
    assert_eq!((scene.heard().len(), scene.router_got()), (1, vec!["Publish a/0= q0".to_owned()]));
    assert!(!broker.budget.is_exhausted());
    let mut other = Scene::at_broker(&broker, OPERATOR, |terms| (terms.has_key, terms.name) = (true, "another".into()));
    other.client(&publish(0x30, "b", "", 0)).unwrap();
    assert_eq!(other.router_got().len(), 1, "another key has its own");
}

/// Not even topics of commands, of which a limited client may name as many as he likes.
#[test]
fn a_viewer_wears_no_router_out_with_topics_that_he_may_not_publish_on_or_may() {
    let broker = broker();
    let mut scene = Scene::at_broker(&broker, VIEWER, |terms| terms.has_key = true);
    for n in 0..75_000 {
        let (mine, old, command) = (format!("a/{n}"), format!("old/{n}"), format!("site/robot/command/{n}"));
        let said = [publish(0x30, &mine, "", 0), publish(0x30, &old, "", 0), publish(0x30, &command, "forbidden", 0)];
        scene.client(&said.concat()).unwrap();
    }
    assert_eq!((scene.router_got().len(), scene.heard().len()), (SHARE_TOPICS / LIMITED_SHARE, 150_000));
    assert!(!broker.budget.is_exhausted());
}

#[test]
fn what_nobody_reads_does_not_reach_the_router_and_is_kept_all_the_same() {
    let broker = Arc::new(Broker::new(TestRights));
    let mut scene = Scene::at_broker(&broker, OPERATOR, |_| {});
    let said = [publish(0x31, "a", "1", 0), publish(0x33, "b", "2", 7), publish(0x30, STOP, "", 0)].concat();
    scene.client(&said).unwrap();
    assert_eq!((scene.router_got(), scene.client_got(), scene.heard().len()), (vec![], vec!["Puback 7".to_owned()], 1));
    assert_eq!(broker.retained.count(), 2);
    let mut reader = Scene::at_broker(&broker, OPERATOR, |_| {});
    reader.client(&subscribe(1, &[("a", Qos::Zero)])).unwrap();
    scene.client(&said).unwrap();
    assert_eq!(scene.router_got(), ["Publish a=1 q0"], "also while the router has not answered the newcomer");
    reader.router_answers();
    let session = reader.connection.into_session();
    scene.client(&said).unwrap();
    assert_eq!(scene.router_got(), ["Publish a=1 q0"], "and for somebody who is remembered");
    drop(session);
    scene.client(&said).unwrap();
    assert_eq!(scene.router_got(), NONE, "until he is forgotten");
}

/// What the router holds of a message beside its bytes is to be no more than the bytes that it counts.
#[test]
fn short_messages_are_padded_on_their_way_through_the_router_and_nobody_sees_it() {
    let mut scene = Scene::of(OPERATOR);
    for length in [0, 1, 80, 90, 91, 92, 300] {
        let payload = "x".repeat(length);
        scene.client(&publish(0x30, "a", &payload, 0)).unwrap();
        let through = std::mem::take(scene.connection.to_router());
        assert!(through.len() >= PADDED, "{length}");
        scene.router(&through).unwrap();
        assert_eq!(taken(scene.connection.to_client()), publish(0x30, "a", &payload, 0), "{length}");
    }
    assert!(matches!(scene.router(&[0x38, 3, 0, 1, b'a']), Err(Ended::RouterMalformed(_))), "padding without an end");
    assert!(matches!(scene.router(&[0x38, 4, 0, 1, b'a', 9]), Err(Ended::RouterMalformed(_))), "more than there is");
}

/// The router copies what it sends for every reader, and keeps the room for that; a long message is there once.
#[test]
fn a_long_message_goes_past_the_router_and_nobody_sees_it() {
    let broker = broker();
    let mut readers = [Qos::Zero, Qos::One].map(|qos| {
        let mut reader = Scene::at_broker(&broker, OPERATOR, |_| {});
        reader.subscribe(&[("a", qos)]);
        reader
    });
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let payload = "x".repeat(CLIENT_PACKET / 2);
    writer.client(&publish(0x31, "a", &payload, 0)).unwrap();
    let through = std::mem::take(writer.connection.to_router());
    assert!((PADDED..2 * PADDED).contains(&through.len()), "{}", through.len());
    assert_eq!(broker.retained.beside(), 0, "what is kept is the same");
    for (reader, first) in readers.iter_mut().zip([0x30, 0x32]) {
        // The router gives it the id, and keeps the mark.
        let [at_qos_0, at_qos_1] = [&[][..], &[0, 7]].map(|id| [&through[2..5], id, &through[5..]].concat());
        let body = if first == 0x30 { at_qos_0 } else { at_qos_1 };
        reader.router(&[&[first | 8, u8::try_from(body.len()).unwrap()][..], &body].concat()).unwrap();
        assert!(reader.connection.to_client().own() < PADDED);
        assert_eq!(taken(reader.connection.to_client()), publish(first, "a", &payload, 7));
    }
    let [first, second] = readers;
    assert_eq!((first.connection.elsewhere().0, second.connection.elsewhere().0), (0, payload.len()), "not acknowledged yet");
    let mut again = Scene::at_broker(&broker, OPERATOR, |terms| terms.session = second.connection.into_session());
    again.router_answers();
    again.client_got();
    let body = [&through[2..5], &[0, 9], &through[5..]].concat();
    again.router(&[&[0x3A, u8::try_from(body.len()).unwrap()][..], &body].concat()).unwrap();
    assert_eq!(taken(again.connection.to_client()), publish(0x3A, "a", &payload, 9), "it may know it");
    again.client(&[0x40, 2, 0, 9]).unwrap();
    assert_eq!((again.router_got(), again.connection.elsewhere().0), (vec!["Puback 9".to_owned()], 0));
    again.router(&[&[0x3A, u8::try_from(body.len()).unwrap()][..], &body].concat()).unwrap();
    assert_eq!((again.client_got(), again.router_got().len()), (vec![], 1), "one that was lost is acknowledged for it");
}

/// Whoever is away cannot read, and may be many.
#[test]
fn long_messages_wait_for_a_client_that_is_away_only_while_little_waits() {
    let broker = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let long = "x".repeat(SHARED);
    for (unread, comes, comes_later) in
        [(PARCELS_AWAY + 1, &[][..], &["a/kept"][..]), (PARCELS_AWAY - SHARED, &["a/said", "a/kept"], &[])]
    {
        let mut reader = Scene::at_broker(&broker, OPERATOR, |_| {});
        reader.subscribe(&[("a/#", Qos::Zero)]);
        let session = reader.connection.into_session();
        let unread = broker.retained.share(&vec![0; unread]);
        writer.client(&[publish(0x30, "a/said", &long, 0), publish(0x31, "a/kept", &long, 0)].concat()).unwrap();
        drop(unread);
        let mut again = Scene::at_broker(&broker, OPERATOR, |terms| terms.session = session);
        again.router_answers();
        again.router(&std::mem::take(writer.connection.to_router())).unwrap();
        let words = |topics: &[&str]| topics.iter().map(|topic| format!("Publish {topic}={long} q0")).collect::<Vec<_>>();
        assert_eq!(again.client_got(), words(comes));
        let at = Duration::from_secs(10);
        assert!(again.connection.poll_behind(at).is_empty());
        again.connection.handle_timeout(at + QUIET).unwrap();
        assert_eq!(again.client_got(), words(comes_later), "the newest of what is kept");
    }
}

#[test]
fn a_router_that_can_remember_no_more_gets_no_new_topics() {
    let mut scene = Scene::of(OPERATOR);
    for n in 0..ROUTER_TOPICS {
        assert!(scene.broker.budget.admits_topic(&Payer::Anybody, format!("b/{n}").as_bytes()));
    }
    scene.client(&[publish(0x33, "new", "x", 7), publish(0x30, STOP, "x", 0)].concat()).unwrap();
    assert_eq!((scene.router_got(), scene.client_got()), (vec![], vec!["Puback 7".to_owned()]));
    assert_eq!((scene.heard().len(), scene.broker.retained.count()), (1, 0));
    assert!(scene.broker.budget.is_exhausted());
}

#[test]
fn guests_send_packets_of_256_kib_and_the_program_larger_ones() {
    let payload = "x".repeat(CLIENT_PACKET);
    let too_long = publish(0x30, "a", &payload, 0);
    assert!(matches!(Scene::of(OPERATOR).client(&too_long), Err(Ended::Malformed(_))));
    let mut program = Scene::of(Principal::Program);
    program.client(&too_long).unwrap();
    assert_eq!(program.router_got().len(), 1);
    let fitting = publish(0x30, "a", &payload[..CLIENT_PACKET - 7], 0);
    assert_eq!(fitting.len(), CLIENT_PACKET);
    assert!(Scene::of(OPERATOR).client(&fitting).is_ok());
}
