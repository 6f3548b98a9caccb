//! How connections end: silence, DISCONNECT, malformed packets, and wills.

use std::time::Duration;

use bytes::Bytes;

use super::scene::{OPERATOR, STOP, Scene, VIEWER, broker, publish};
use crate::Ended;
use crate::frame::{Malformed, PacketKind};
use crate::limits::SILENCE;
use crate::packet::Qos;
use crate::packet::connect::Will;
use crate::retained::Walk;
use crate::rights::Tier;

fn with_will(tier: Tier, topic: &str) -> Scene {
    let (topic, payload) = (topic.to_owned(), Bytes::from("gone"));
    let will = Will { topic, payload, qos: Qos::One, retain: true, delay_s: 0, expiry_s: None, properties: Bytes::new() };
    Scene::at_broker(&broker(), tier, |terms| terms.connect.will = Some(will))
}

#[test]
fn a_client_is_given_one_and_a_half_of_its_time() {
    let mut scene = Scene::of(OPERATOR);
    assert_eq!(scene.connection.poll_timeout(), Duration::from_secs(90));
    scene.client(&[0xC0, 0]).unwrap();
    assert_eq!(scene.connection.poll_timeout(), Duration::from_secs(91));
    scene.client(&[0xC0]).unwrap();
    assert_eq!(scene.connection.handle_timeout(Duration::from_secs(90)), Ok(()));
    assert_eq!(scene.connection.handle_timeout(Duration::from_secs(91)), Err(Ended::Idle));
}

#[test]
fn a_client_that_may_be_silent_for_ever_may_be_for_a_day() {
    for keep_alive_s in [0, u16::MAX] {
        let scene = Scene::at_broker(&broker(), OPERATOR, |terms| terms.connect.keep_alive_s = keep_alive_s);
        assert_eq!(scene.connection.poll_timeout(), SILENCE);
    }
}

#[test]
fn a_will_is_published_and_kept_when_its_client_goes_without_a_word() {
    for why in [Ended::Gone, Ended::Idle, Ended::TakenOver, Ended::Malformed(Malformed::Length)] {
        let mut scene = with_will(OPERATOR, "a/will");
        let mut everybody = scene.everybody();
        scene.connection.handle_end(why, scene.now);
        assert_eq!(everybody.read(), ["a/will=gone q1"], "{why}");
        assert_eq!(scene.broker.retained.next(&mut Walk::new("a/will".into(), 0), &mut 9, scene.now).unwrap().qos(), Qos::One);
    }
}

#[test]
fn a_client_that_takes_its_leave_has_no_will() {
    let mut scene = with_will(OPERATOR, "a/will");
    let mut everybody = scene.everybody();
    assert_eq!(scene.client(&[0xE0, 0]), Err(Ended::Left));
    scene.connection.handle_end(Ended::Left, scene.now);
    assert!(everybody.got().is_empty());
}

#[test]
fn when_the_program_ends_no_will_is_published() {
    let mut scene = with_will(OPERATOR, "a/will");
    let mut everybody = scene.everybody();
    scene.connection.handle_end(Ended::Closing, scene.now);
    assert!(everybody.got().is_empty() && scene.broker.retained.count() == 0);
}

#[test]
fn a_forbidden_will_goes_nowhere() {
    for (tier, topic) in [(OPERATOR, STOP), (OPERATOR, "old/x"), (OPERATOR, "site/robot/event"), (VIEWER, "a"), (OPERATOR, "$a")]
    {
        let mut scene = with_will(tier, topic);
        let mut everybody = scene.everybody();
        scene.connection.handle_end(Ended::Gone, scene.now);
        assert!(everybody.got().is_empty() && scene.heard().is_empty(), "{topic}");
        assert_eq!(scene.broker.retained.count(), 0);
    }
}

#[test]
fn packets_that_no_client_sends_end_its_connection() {
    let cases: [(&[u8], Ended); 13] = [
        (&[0x10, 0], Ended::Unexpected(PacketKind::Connect)),
        (&[0x20, 2, 0, 0], Ended::Unexpected(PacketKind::Connack)),
        (&[0x90, 3, 0, 1, 0], Ended::Unexpected(PacketKind::Suback)),
        (&[0xB0, 2, 0, 1], Ended::Unexpected(PacketKind::Unsuback)),
        (&[0xD0, 0], Ended::Unexpected(PacketKind::Pingresp)),
        (&[0x00], Ended::Malformed(Malformed::Kind(0))),
        (&[0xF0, 0], Ended::Unexpected(PacketKind::Auth)),
        (&[0xF1, 0], Ended::Malformed(Malformed::Kind(0xF1))),
        (&[0x80, 0], Ended::Malformed(Malformed::Kind(0x80))),
        (&[0xC0, 1, 0], Ended::Malformed(Malformed::Trailing(1))),
        (&[0xE0, 1, 0], Ended::Malformed(Malformed::Trailing(1))),
        (&[0x40, 2, 0, 0], Ended::Malformed(Malformed::Id)),
        (&[0x82, 2, 0, 1], Ended::Malformed(Malformed::Filters)),
    ];
    for (bytes, ended) in cases {
        let mut scene = Scene::of(OPERATOR);
        let mut everybody = scene.everybody();
        assert_eq!(scene.client(&[&publish(0x30, "a", "", 0)[..], bytes].concat()), Err(ended));
        assert_eq!(everybody.got(), ["Publish a= q0"], "what came before is done");
    }
}

#[test]
fn a_topic_that_is_none_ends_the_connection() {
    for topic in ["", "a/#", "+", "a\0"] {
        let ended = Scene::of(OPERATOR).client(&publish(0x30, topic, "", 0));
        assert!(matches!(ended, Err(Ended::Malformed(Malformed::Topic | Malformed::Text(_)))), "{topic:?} {ended:?}");
    }
    let ended = Scene::of(OPERATOR).client(&[0x30, 4, 0, 2, 0xC3, 0x28]);
    assert_eq!(ended, Err(Ended::Malformed(Malformed::Text("topic"))));
}
