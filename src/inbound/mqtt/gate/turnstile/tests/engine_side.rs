//! What comes from the engine, and what it is told of it.

use super::scene::{OPERATOR, Scene, publish, subscribe};
use crate::inbound::mqtt::gate::packet::Qos;
use crate::inbound::mqtt::gate::rights::Guest;
use crate::inbound::mqtt::gate::turnstile::Ended;
use crate::inbound::mqtt::topics::PULSE;

const NONE: [&str; 0] = [];

#[test]
fn messages_go_to_the_client_as_they_are() {
    let mut scene = Scene::of(OPERATOR);
    let script = [publish(0x30, "a", "1", 0), publish(0x32, "b", "2", 100), publish(0x30, "é", "3", 0)].concat();
    scene.engine(&script).unwrap();
    assert_eq!(scene.turnstile.to_client()[..], script);
}

#[test]
fn acknowledgements_reach_the_engine_in_order_and_only_those_it_waits_for() {
    let mut scene = Scene::of(OPERATOR);
    scene.engine(&[publish(0x32, "a", "", 1), publish(0x32, "a", "", 2)].concat()).unwrap();
    scene.client(&[0x40, 2, 0, 2, 0x40, 2, 0, 9, 0x40, 2, 0, 2, 0x40, 2, 3, 233]).unwrap();
    scene.client(&[0x50, 2, 0, 1, 0x70, 2, 0, 1]).unwrap();
    assert_eq!(scene.engine_got(), NONE);
    scene.client(&[0x40, 2, 0, 1]).unwrap();
    assert_eq!(scene.engine_got(), ["Puback 1", "Puback 2"]);
    scene.client(&[0x40, 2, 0, 1]).unwrap();
    assert_eq!(scene.engine_got(), NONE);
}

#[test]
fn the_pulse_is_for_the_program_alone_and_acknowledged_for_others() {
    let script =
        [publish(0x30, "a", "1", 0), publish(0x30, PULSE, "7", 0), publish(0x32, PULSE, "7", 1), publish(0x30, "b", "2", 0)];
    let mut scene = Scene::of(OPERATOR);
    scene.engine(&script.concat()).unwrap();
    assert_eq!(scene.client_got(), ["Publish a=1 q0", "Publish b=2 q0"]);
    assert_eq!(scene.engine_got(), ["Puback 1"]);
    let mut scene = Scene::of(Guest::House);
    scene.engine(&script.concat()).unwrap();
    assert_eq!(scene.client_got().len(), 4);
}

#[test]
fn an_engine_that_is_not_itself_is_found_out() {
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
        let ended = Scene::of(OPERATOR).engine(bytes);
        assert!(matches!(ended, Err(Ended::Engine(_) | Ended::EngineMalformed(_))), "{bytes:?} {ended:?}");
    }
    let mut scene = Scene::of(OPERATOR);
    scene.client(&subscribe(1, &[("a", Qos::Zero)])).unwrap();
    assert!(matches!(scene.engine(&[0x90, 3, 0, 1, 0x80]), Err(Ended::Engine(_))));
}

#[test]
fn what_came_before_the_nonsense_still_arrives() {
    let mut scene = Scene::of(OPERATOR);
    let script = [&publish(0x30, "a", "1", 0)[..], &[0xE0, 0]].concat();
    assert!(scene.engine(&script).is_err());
    assert_eq!(scene.client_got(), ["Publish a=1 q0"]);
}

#[test]
fn the_engine_is_pinged_once_at_a_time_and_the_client_is_answered_at_once() {
    let mut scene = Scene::of(OPERATOR);
    scene.client(&[0xC0, 0, 0xC0, 0]).unwrap();
    assert_eq!(scene.client_got(), ["Pingresp", "Pingresp"]);
    assert_eq!(scene.engine_got(), ["Pingreq"]);
    scene.engine(&[0xD0, 0]).unwrap();
    assert_eq!(scene.client_got(), NONE);
    scene.client(&[0xC0, 0]).unwrap();
    assert_eq!(scene.engine_got(), ["Pingreq"]);
}
