//! Tests sessions of MQTT 5: how long they last, and delayed wills.

use std::sync::Arc;
use std::time::Duration;

use bytes::Bytes;

use super::scene::five::{ack, disconnect_with, publish_with, scene, subscribe_with};
use super::scene::{OPERATOR, Scene, broker, publish};
use crate::frame::{Malformed, PacketKind};
use crate::packet::Qos;
use crate::packet::connect::{FOR_EVER_S, Reception, Will};
use crate::packet::properties::Property;
use crate::{Broker, Ended, Session, Terms};

fn lasting(seconds: u32) -> impl Fn(&mut Terms) {
    move |terms| terms.connect.session_expiry_s = seconds
}

fn with_will(delay_s: u32, lasts_s: u32) -> impl Fn(&mut Terms) {
    move |terms| {
        terms.connect.session_expiry_s = lasts_s;
        let (topic, payload, properties) = ("w/will".to_owned(), Bytes::from("gone"), Bytes::new());
        terms.connect.will = Some(Will { topic, payload, qos: Qos::One, retain: false, delay_s, expiry_s: Some(60), properties });
    }
}

fn gone(mut scene: Scene, why: Ended) -> Option<Session> {
    scene.connection.handle_end(why, scene.now);
    scene.connection.into_session()
}

/// Lets time pass. Returns whether the session is over, and publishes a will that is due.
fn is_over(session: &mut Session, now: Duration) -> bool {
    let (is_over, will) = session.handle_timeout(now);
    will.into_iter().for_each(|will| will.publish(now));
    is_over
}

fn watcher(broker: &Arc<Broker>) -> Scene {
    Scene::at_broker(broker, OPERATOR, |_| {}).reader(&[("w/#", Qos::One)])
}

/// Tests MQTT 5, section 3.1.2.11.2.
#[test]
fn a_client_is_remembered_for_as_long_as_it_says() {
    let broker = broker();
    let at = Duration::from_secs;
    assert!(gone(scene(&broker, lasting(0)), Ended::Gone).is_none());
    let mut session = gone(scene(&broker, lasting(10)), Ended::Gone).unwrap();
    assert_eq!(session.poll_timeout(), Some(at(11)));
    assert!(!is_over(&mut session, at(10)) && is_over(&mut session, at(11)));
    assert_eq!(gone(scene(&broker, lasting(FOR_EVER_S)), Ended::Gone).unwrap().poll_timeout(), None);
}

/// Tests MQTT 5, section 3.14.2.2.2.
#[test]
fn whoever_goes_may_change_for_how_long() {
    let broker = broker();
    let leave = |lasts_s, properties: &[Property<'_>]| {
        let mut scene = scene(&broker, lasting(lasts_s));
        let ended = scene.client(&disconnect_with(0, properties)).unwrap_err();
        (ended, gone(scene, ended).and_then(|session| session.poll_timeout()))
    };
    assert_eq!(leave(10, &[]), (Ended::Left, Some(Duration::from_secs(11))));
    assert_eq!(leave(10, &[Property::SessionExpiry(3)]), (Ended::Left, Some(Duration::from_secs(4))));
    assert_eq!(leave(10, &[Property::SessionExpiry(0)]), (Ended::Left, None));
    assert_eq!(leave(0, &[Property::SessionExpiry(0)]).0, Ended::Left);
    assert_eq!(leave(0, &[Property::SessionExpiry(3)]).0, Ended::Malformed(Malformed::SessionExpiry));
}

/// Tests MQTT 5, section 3.1.3.2.2.
#[test]
fn a_will_waits_for_its_client_as_long_as_it_says_and_no_longer_than_its_session() {
    let broker = broker();
    let (mut watcher, at) = (watcher(&broker), Duration::from_secs);
    let mut session = gone(scene(&broker, with_will(5, 100)), Ended::Gone).unwrap();
    assert_eq!((session.poll_timeout(), watcher.read().len()), (Some(at(6)), 0));
    assert!(!is_over(&mut session, at(5)) && watcher.read().is_empty());
    assert!(!is_over(&mut session, at(6)) && session.poll_timeout() == Some(at(101)));
    assert_eq!(watcher.read(), ["w/will=gone q1"]);
    session.end(at(7));
    assert!(watcher.read().is_empty(), "once");
    let session = gone(scene(&broker, with_will(50, 10)), Ended::Gone).unwrap();
    assert_eq!(session.poll_timeout(), Some(at(11)));
    session.end(at(2));
    assert_eq!(watcher.read(), ["w/will=gone q1"], "its session is over");
    assert!(gone(scene(&broker, with_will(50, 0)), Ended::Gone).is_none());
    assert_eq!(watcher.read().len(), 1, "there is no session that it could wait for");
}

#[test]
fn a_client_that_is_back_in_time_leaves_no_will_and_one_that_wants_it_leaves_it() {
    let broker = broker();
    let mut watcher = watcher(&broker);
    let session = gone(scene(&broker, with_will(5, 100)), Ended::Gone).unwrap();
    let back = scene(&broker, |terms| {
        terms.session = session;
        terms.connect.session_expiry_s = 9;
    });
    assert!(gone(back, Ended::Gone).is_some());
    assert!(watcher.read().is_empty());
    for (reason, left) in [(0, 0), (4, 1), (0x80, 1)] {
        let mut scene = scene(&broker, with_will(0, 0));
        let ended = scene.client(&disconnect_with(reason, &[])).unwrap_err();
        gone(scene, ended);
        assert_eq!(watcher.read().len(), left, "{reason:#x}");
    }
    gone(scene(&broker, with_will(5, 100)), Ended::Closing);
    assert!(watcher.read().is_empty(), "the program ends");
}

/// A will is published before its delay is over. Its expiry time begins when it is published. The will does not make
/// other messages expire earlier.
#[test]
fn a_will_that_comes_early_is_published_by_the_time_that_it_is() {
    let (broker, at) = (broker(), Duration::from_secs);
    let mut writer = scene(&broker, |_| {});
    writer.client(&publish_with(0x33, "k/other", "x", 1, &[Property::MessageExpiry(50)])).unwrap();
    let kept = |terms: &mut Terms| {
        with_will(1000, 2000)(terms);
        if let Some(will) = &mut terms.connect.will {
            will.retain = true;
        }
    };
    gone(scene(&broker, kept), Ended::Gone).unwrap().end(at(10));
    let found = |now| {
        let mut newcomer = scene(&broker, |_| {});
        newcomer.now = at(now);
        newcomer.client(&subscribe_with("#", 1, &[])).unwrap();
        newcomer.told().into_iter().filter(|told| told.starts_with("Publish")).collect::<Vec<_>>()
    };
    let will = |seconds| format!("Publish w/will=gone q1 #2 kept {:?}", [Property::MessageExpiry(seconds)]);
    assert_eq!(found(20), ["Publish k/other=x q1 #1 kept [MessageExpiry(31)]".to_owned(), will(50)]);
    assert_eq!(found(69), [will(1).replace("#2", "#1")]);
    assert!(found(70).is_empty());
}

#[test]
fn nobody_is_remembered_whose_key_is_gone() {
    let broker = broker();
    let mut watcher = watcher(&broker);
    assert!(gone(scene(&broker, with_will(50, FOR_EVER_S)), Ended::NotKnown).is_none());
    assert_eq!(watcher.read().len(), 1, "there is nothing that its will could wait for");
}

/// A message that was already sent once may expire before its client is back.
#[test]
fn what_is_over_is_not_sent_again() {
    let broker = broker();
    let (mut writer, mut reader) = (scene(&broker, |_| {}), scene(&broker, lasting(100)));
    reader.client(&subscribe_with("#", 1, &[])).unwrap();
    writer.client(&publish_with(0x32, "a", "short", 1, &[Property::MessageExpiry(5)])).unwrap();
    writer.client(&publish_with(0x32, "a", "long", 1, &[])).unwrap();
    assert_eq!(reader.told().len(), 3);
    let session = gone(reader, Ended::Gone).unwrap();
    let listener = |terms: &mut Terms| terms.session = session;
    let mut back = Scene::later(&broker, Duration::from_secs(9), listener);
    assert_eq!(back.told(), ["Publish a=long q1 #2 again"]);
}

/// Tests MQTT 5, section 4.9: the limit also holds for messages of earlier connections.
#[test]
fn what_was_not_acknowledged_comes_again_no_faster_than_the_client_bears() {
    let broker = broker();
    let mut reader = scene(&broker, lasting(100));
    reader.client(&subscribe_with("#", 2, &[Property::SubscriptionId(8)])).unwrap();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    for id in 1..=5 {
        writer.client(&publish(0x34, "a", &id.to_string(), id)).unwrap();
    }
    assert_eq!(reader.told().len(), 6);
    reader.client(&ack(PacketKind::Pubrec, 2, 0)).unwrap();
    let session = gone(reader, Ended::Gone).unwrap();
    writer.client(&publish(0x34, "a", "6", 6)).unwrap();
    let resume = |session| {
        move |terms: &mut Terms| {
            terms.session = session;
            terms.connect.session_expiry_s = 100;
            terms.connect.reception = Reception { receive_maximum: 2, ..Reception::default() };
        }
    };
    let mut back = scene(&broker, resume(session));
    assert_eq!(back.told(), ["Publish a=1 q2 #1 again [SubscriptionId(8)]", "Pubrel 2"]);
    let session = gone(back, Ended::Gone).unwrap();
    let mut back = scene(&broker, resume(session));
    assert_eq!(
        back.told(),
        ["Publish a=1 q2 #1 again [SubscriptionId(8)]", "Pubrel 2"],
        "in the same order, however often it breaks"
    );
    back.client(&ack(PacketKind::Pubcomp, 2, 0)).unwrap();
    assert_eq!(back.told(), ["Publish a=3 q2 #3 again [SubscriptionId(8)]"]);
    for (id, next) in [(1, "a=4 q2 #4 again"), (3, "a=5 q2 #5 again"), (4, "a=6 q2 #6")] {
        back.client(&[ack(PacketKind::Pubrec, id, 0), ack(PacketKind::Pubcomp, id, 0)].concat()).unwrap();
        assert_eq!(back.told(), [format!("Pubrel {id}"), format!("Publish {next} [SubscriptionId(8)]")]);
    }
}
