//! What comes from the router, and what it is told of it.

use std::time::Duration;

use super::scene::{OPERATOR, PULSE, Scene, broker, publish, subscribe, taken};
use crate::Ended;
use crate::limits::{HEAVIEST, QUIET, ROUTER_KEEPS};
use crate::packet::Qos;
use crate::rights::Principal;

/// So many of the heaviest messages the router keeps.
const KEPT_THERE: usize = ROUTER_KEEPS as usize / HEAVIEST;

const NONE: [&str; 0] = [];

#[test]
fn messages_go_to_the_client_as_they_are() {
    let mut scene = Scene::of(OPERATOR);
    let script = [publish(0x30, "a", "1", 0), publish(0x32, "b", "2", 100), publish(0x30, "é", "3", 0)].concat();
    scene.router(&script).unwrap();
    assert_eq!(taken(scene.connection.to_client()), script);
}

#[test]
fn acknowledgements_reach_the_router_in_order_and_only_those_it_waits_for() {
    let mut scene = Scene::of(OPERATOR);
    scene.router(&[publish(0x32, "a", "", 1), publish(0x32, "a", "", 2)].concat()).unwrap();
    scene.client(&[0x40, 2, 0, 2, 0x40, 2, 0, 9, 0x40, 2, 0, 2, 0x40, 2, 3, 233]).unwrap();
    scene.client(&[0x50, 2, 0, 1, 0x70, 2, 0, 1]).unwrap();
    assert_eq!(scene.router_got(), NONE);
    scene.client(&[0x40, 2, 0, 1]).unwrap();
    assert_eq!(scene.router_got(), ["Puback 1", "Puback 2"]);
    scene.client(&[0x40, 2, 0, 1]).unwrap();
    assert_eq!(scene.router_got(), NONE);
}

#[test]
fn the_pulse_is_for_the_program_alone_and_acknowledged_for_others() {
    let script =
        [publish(0x30, "a", "1", 0), publish(0x30, PULSE, "7", 0), publish(0x32, PULSE, "7", 1), publish(0x30, "b", "2", 0)];
    let mut scene = Scene::of(OPERATOR);
    scene.router(&script.concat()).unwrap();
    assert_eq!(scene.client_got(), ["Publish a=1 q0", "Publish b=2 q0"]);
    assert_eq!(scene.router_got(), ["Puback 1"]);
    let mut scene = Scene::of(Principal::Program);
    scene.router(&script.concat()).unwrap();
    assert_eq!(scene.client_got().len(), 4);
}

#[test]
fn a_router_that_is_not_itself_is_found_out() {
    let cases: [&[u8]; 9] = [
        &[0x90, 3, 0, 1, 0],
        &[0xB0, 2, 0, 1],
        &[0x20, 2, 0, 0],
        &[0x40, 2, 0, 1],
        &[0xE0, 0],
        &[0x34, 5, 0, 1, b'a', 0, 1],
        &[0xFF],
        &[0x36, 5, 0, 1, b'a', 0, 1],
        &[0x62, 2, 0, 1],
    ];
    for bytes in cases {
        let ended = Scene::of(OPERATOR).router(bytes);
        assert!(matches!(ended, Err(Ended::Router(_) | Ended::RouterMalformed(_))), "{bytes:?} {ended:?}");
    }
    let mut scene = Scene::of(OPERATOR);
    scene.client(&subscribe(1, &[("a", Qos::Zero)])).unwrap();
    assert!(matches!(scene.router(&[0x90, 3, 0, 1, 0x80]), Err(Ended::Router(_))));
}

#[test]
fn what_came_before_the_nonsense_still_arrives() {
    let mut scene = Scene::of(OPERATOR);
    let script = [&publish(0x30, "a", "1", 0)[..], &[0xE0, 0]].concat();
    assert!(scene.router(&script).is_err());
    assert_eq!(scene.client_got(), ["Publish a=1 q0"]);
}

#[test]
fn the_router_is_pinged_once_at_a_time_and_the_client_is_answered_at_once() {
    let mut scene = Scene::of(OPERATOR);
    scene.client(&[0xC0, 0, 0xC0, 0]).unwrap();
    assert_eq!(scene.client_got(), ["Pingresp", "Pingresp"]);
    assert_eq!(scene.router_got(), ["Pingreq"]);
    scene.router(&[0xD0, 0]).unwrap();
    assert_eq!(scene.client_got(), NONE);
    scene.client(&[0xC0, 0]).unwrap();
    assert_eq!(scene.router_got(), ["Pingreq"]);
}

/// As MQTT-3.3.1-1 has it: whoever may have got a message already is told so.
#[test]
fn what_was_not_acknowledged_comes_marked_in_the_next_connection_of_a_session() {
    let broker = broker();
    let mut scene = Scene::at_broker(&broker, OPERATOR, |_| {});
    scene.subscribe(&[("a", Qos::One)]);
    scene.router(&[publish(0x32, "a", "1", 1), publish(0x32, "a", "2", 2), publish(0x32, "a", "2", 3)].concat()).unwrap();
    scene.client(&[0x40, 2, 0, 1]).unwrap();
    let session = scene.connection.into_session();
    let mut scene = Scene::at_broker(&broker, OPERATOR, |terms| terms.session = session);
    scene.router_answers();
    let again = [publish(0x32, "a", "2", 1), publish(0x32, "a", "2", 2), publish(0x32, "a", "3", 3), publish(0x32, "a", "2", 4)];
    scene.router(&again.concat()).unwrap();
    let expected = ["Publish a=2 q1 #1 again", "Publish a=2 q1 #2 again", "Publish a=3 q1 #3", "Publish a=2 q1 #4"];
    assert_eq!(scene.client_got(), expected);
}

/// What the router lost of a client's messages it gets once more as it is now, when nothing else comes.
#[test]
fn whoever_missed_messages_gets_the_newest_of_each_topic_when_the_router_has_no_more() {
    let broker = broker();
    let mut reader = Scene::at_broker(&broker, OPERATOR, |_| {});
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    writer.client(&[publish(0x31, "a/old", "old", 0), publish(0x31, "elsewhere", "x", 0)].concat()).unwrap();
    reader.subscribe(&[("a/#", Qos::One)]);
    let long = "x".repeat(HEAVIEST);
    writer.client(&publish(0x31, "a/state", "1", 0)).unwrap();
    for _ in 0..2 * KEPT_THERE {
        writer.client(&publish(0x30, "a/noise", &long, 0)).unwrap();
    }
    writer.client(&[publish(0x31, "a/state", "2", 0), publish(0x31, "elsewhere", "y", 0)].concat()).unwrap();
    let at = Duration::from_secs;
    assert!(reader.connection.poll_behind(at(10)).is_empty() && reader.connection.poll_timeout() == at(10) + QUIET);
    reader.router(&publish(0x30, "a/noise", &long, 0)).unwrap();
    reader.client_got();
    assert!(
        reader.connection.poll_behind(at(11)).is_empty() && reader.connection.poll_timeout() == at(11) + QUIET,
        "something came"
    );
    reader.connection.handle_timeout(at(11)).unwrap();
    assert_eq!(reader.client_got(), NONE, "there may be more");
    reader.connection.handle_timeout(at(11) + QUIET).unwrap();
    assert_eq!(reader.client_got(), ["Publish a/state=2 q0"], "not said to be kept, and nothing that it knows");
    assert!(reader.connection.poll_behind(at(13)).is_empty() && reader.connection.poll_timeout() > at(60), "that was all");
}

#[test]
fn whoever_missed_nothing_gets_nothing_twice() {
    let broker = broker();
    let mut reader = Scene::at_broker(&broker, OPERATOR, |_| {});
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    reader.subscribe(&[("a/#", Qos::One)]);
    for n in 0..KEPT_THERE {
        writer.client(&publish(0x31, &format!("a/{n}"), &"x".repeat(HEAVIEST), 0)).unwrap();
    }
    reader.connection.poll_behind(Duration::from_secs(10));
    reader.connection.handle_timeout(Duration::from_secs(20)).unwrap();
    assert_eq!(reader.client_got(), NONE);
}
