//! Tests clients of MQTT 5: what they send, what others receive in either version, and the answers.

use std::time::Duration;

use super::scene::five::{ack, disconnect_with, publish_with, scene, subscribe_with, unsubscribe_from};
use super::scene::{OPERATOR, START, STOP, Scene, VIEWER, broker, publish, taken};
use crate::Ended;
use crate::frame::{Malformed, PacketKind};
use crate::limits::{FILTERS, PROPERTIES, TOPIC};
use crate::packet::connect::Reception;
use crate::packet::properties::Property;

#[test]
fn properties_go_on_to_those_of_mqtt_5_and_leave_others_alone() {
    let broker = broker();
    let (mut writer, mut reader) = (scene(&broker, |_| {}), scene(&broker, |_| {}));
    reader.client(&subscribe_with("a/#", 1, &[])).unwrap();
    reader.told();
    let mut old = writer.reader(&[("a/#", crate::packet::Qos::One)]);
    let properties = [
        Property::PayloadFormat(1),
        Property::ContentType("text/plain"),
        Property::ResponseTopic("b"),
        Property::CorrelationData(b"7"),
        Property::User("who", "panel"),
        Property::User("who", "again"),
    ];
    writer.client(&publish_with(0x32, "a/x", "hi", 3, &properties)).unwrap();
    assert_eq!(reader.told(), [format!("Publish a/x=hi q1 #1 {properties:?}")]);
    assert_eq!(old.got(), ["Publish a/x=hi q1 #1"]);
    assert_eq!(writer.told(), ["Puback 3"]);
}

/// Tests MQTT 5, section 3.4.2.1.
#[test]
fn whoever_publishes_is_told_what_became_of_it() {
    let broker = broker();
    let mut writer = scene(&broker, |_| {});
    let mut say = |topic: &str, properties: &[Property<'_>]| {
        writer.client(&publish_with(0x32, topic, "x", 3, properties)).unwrap();
        writer.told()
    };
    let long = "x".repeat(PROPERTIES);
    assert_eq!(say("a", &[]), ["Puback 3 0x10"], "nobody reads it");
    assert_eq!(say("site/robot/state/robot", &[]), ["Puback 3 0x87"]);
    assert_eq!(say("$SYS/x", &[]), ["Puback 3 0x90"]);
    assert_eq!(say("a", &[Property::User("x", &long)]), ["Puback 3 0x97"]);
    assert_eq!(say(START, &[]), ["Puback 3"], "it was heard");
    writer.client(&publish_with(0x32, START, "forbidden", 3, &[])).unwrap();
    assert_eq!(writer.told(), ["Puback 3 0x87"]);
    for (wants_words, is_told) in [(true, true), (false, false)] {
        let mut writer = scene(&broker, |terms| terms.connect.reception.wants_words = wants_words);
        writer.client(&publish_with(0x32, START, "forbidden", 3, &[])).unwrap();
        let told = taken(writer.connection.to_client());
        assert_eq!(String::from_utf8_lossy(&told).contains("the sender may not publish on this topic"), is_told);
    }
}

/// Tests MQTT 5, section 4.3.3: a refused message need not be released, and its id is free.
#[test]
fn a_message_of_qos_2_that_is_refused_is_over() {
    let broker = broker();
    let (mut writer, mut reader) = (scene(&broker, |_| {}), Scene::at_broker(&broker, OPERATOR, |_| {}));
    reader.subscribe(&[("a", crate::packet::Qos::Two)]);
    writer.client(&publish_with(0x34, "site/robot/state/robot", "x", 3, &[])).unwrap();
    assert_eq!(writer.told(), ["Pubrec 3 0x87"]);
    writer.client(&publish_with(0x34, "a", "x", 3, &[])).unwrap();
    writer.client(&publish_with(0x3C, "a", "x", 3, &[])).unwrap();
    writer.client(&[ack(PacketKind::Pubrel, 3, 0), ack(PacketKind::Pubrel, 3, 0)].concat()).unwrap();
    assert_eq!(writer.told(), ["Pubrec 3", "Pubrec 3", "Pubcomp 3", "Pubcomp 3 0x92"]);
    writer.client(&publish_with(0x34, "a", "y", 4, &[])).unwrap();
    writer.client(&publish_with(0x34, "site/robot/state/robot", "x", 4, &[])).unwrap();
    writer.client(&publish_with(0x3C, "a", "y", 4, &[])).unwrap();
    assert_eq!(reader.read(), ["a=x q2", "a=y q2"], "another one of its id was refused, and it is known still");
}

/// Tests MQTT 5, section 3.3.2.3.4, for aliases that a client sets.
#[test]
fn a_number_stands_for_a_topic_and_one_that_does_not_ends_the_connection() {
    let broker = broker();
    let (mut writer, mut reader) = (scene(&broker, |_| {}), Scene::at_broker(&broker, OPERATOR, |_| {}));
    reader.subscribe(&[("#", crate::packet::Qos::Zero)]);
    let alias = |topic: &str, alias| publish_with(0x30, topic, "x", 0, &[Property::TopicAlias(alias)]);
    writer.client(&[alias("a", 1), alias("b", 10), alias("", 1), alias("c", 1), alias("", 1), alias("", 10)].concat()).unwrap();
    assert_eq!(reader.read(), ["a=x q0", "b=x q0", "a=x q0", "c=x q0", "c=x q0", "b=x q0"]);
    let ends = |packet: &[u8]| scene(&broker, |_| {}).client(packet).unwrap_err();
    assert_eq!(ends(&alias("a", 11)), Ended::Malformed(Malformed::Alias(11)));
    assert_eq!(ends(&alias("a", 0)), Ended::Malformed(Malformed::Alias(0)));
    assert_eq!(ends(&alias("", 1)), Ended::Malformed(Malformed::NoTopic));
    assert_eq!(ends(&publish_with(0x30, "", "x", 0, &[])), Ended::Malformed(Malformed::NoTopic));
    let long = alias(&"x".repeat(TOPIC + 1), 1);
    assert_eq!(ends(&[alias("a", 1), long, alias("", 1)].concat()), Ended::Malformed(Malformed::NoTopic), "it is not a any more");
}

/// The properties are too long, so the message sets no alias. The search for urgent messages has the same rule.
#[test]
fn a_message_with_too_many_properties_names_no_topic() {
    let (long, mut scene) = ("x".repeat(PROPERTIES), scene(&broker(), |_| {}));
    scene.client(&publish_with(0x30, "a", "x", 0, &[Property::User("k", &long), Property::TopicAlias(1)])).unwrap();
    let ended = scene.client(&publish_with(0x30, "", "x", 0, &[Property::TopicAlias(1)]));
    assert_eq!(ended, Err(Ended::Malformed(Malformed::NoTopic)));
}

/// A STOP is forwarded to all subscribers of the command topic, which may trust its properties. So the properties of
/// a viewer's STOP are left out.
#[test]
fn what_a_viewer_says_beside_a_stop_goes_no_further() {
    let broker = broker();
    let mut reader = scene(&broker, |_| {});
    reader.client(&subscribe_with("site/#", 0, &[])).unwrap();
    reader.told();
    for (tier, beside) in [(VIEWER, ""), (OPERATOR, " [ResponseTopic(\"b\")]")] {
        let mut sender = scene(&broker, |terms| terms.tier = tier);
        sender.client(&publish_with(0x30, STOP, "x", 0, &[Property::ResponseTopic("b")])).unwrap();
        assert_eq!(reader.told(), [format!("Publish {STOP}=x q0{beside}")]);
    }
}

/// A STOP whose topic is given by an alias is still a STOP.
#[test]
fn a_command_is_heard_though_a_number_stands_for_its_topic() {
    let mut scene = scene(&broker(), |_| {});
    scene.client(&publish_with(0x30, STOP, "1", 0, &[Property::TopicAlias(4)])).unwrap();
    scene.client(&publish_with(0x30, "", "2", 0, &[Property::TopicAlias(4)])).unwrap();
    assert_eq!(scene.heard(), [format!("{STOP} 1"), format!("{STOP} 2")]);
}

/// Tests MQTT 5, section 3.3.2.3.4, for aliases that the broker sets: no more than the client wants.
#[test]
fn topics_are_given_numbers_for_those_who_want_some() {
    let broker = broker();
    let mut reader = scene(&broker, |terms| terms.connect.reception = Reception { aliases: 1, ..Reception::default() });
    reader.client(&subscribe_with("#", 0, &[])).unwrap();
    reader.told();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    for topic in ["a", "b", "a", "b"] {
        writer.client(&publish(0x30, topic, "x", 0)).unwrap();
    }
    let alias = format!("{:?}", [Property::TopicAlias(1)]);
    assert_eq!(
        reader.told(),
        [format!("Publish a=x q0 {alias}"), "Publish b=x q0".into(), format!("Publish =x q0 {alias}"), "Publish b=x q0".into()]
    );
}

/// Tests MQTT 5, section 3.1.2.11.4.
#[test]
fn nobody_gets_a_longer_packet_than_he_takes() {
    let broker = broker();
    let mut reader = scene(&broker, |terms| terms.connect.reception = Reception { largest: 20, ..Reception::default() });
    reader.client(&subscribe_with("#", 1, &[])).unwrap();
    reader.told();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    for length in [12, 13, 1] {
        writer.client(&publish(0x32, "a", &"x".repeat(length), 1)).unwrap();
    }
    let told = reader.told();
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].starts_with("Publish a=xxxxxxxxxxxx q1") && told[1].starts_with("Publish a=x q1"));
    reader.client(&subscribe_with("$SYS/#", 1, &[])).unwrap();
    assert_eq!(reader.told(), ["Suback [8f]"], "why stands in words only where there is room");
}

/// Tests MQTT 5, section 4.9.
#[test]
fn so_many_messages_are_unacknowledged_as_the_client_bears_and_no_more() {
    let broker = broker();
    let mut reader = scene(&broker, |terms| terms.connect.reception = Reception { receive_maximum: 2, ..Reception::default() });
    reader.client(&subscribe_with("#", 2, &[])).unwrap();
    reader.told();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    for id in 1..=5 {
        writer.client(&publish(if id % 2 == 0 { 0x32 } else { 0x34 }, "a", &id.to_string(), id)).unwrap();
    }
    assert_eq!(reader.told(), ["Publish a=1 q2 #1", "Publish a=2 q1 #2"]);
    reader.client(&ack(PacketKind::Pubrec, 1, 0)).unwrap();
    assert_eq!(reader.told(), ["Pubrel 1"], "it counts until it is over");
    reader.client(&ack(PacketKind::Pubcomp, 1, 0)).unwrap();
    assert_eq!(reader.told(), ["Publish a=3 q2 #3"]);
    reader.client(&[ack(PacketKind::Puback, 2, 0x97), ack(PacketKind::Pubrec, 3, 0x97)].concat()).unwrap();
    assert_eq!(reader.told(), ["Publish a=4 q1 #4", "Publish a=5 q2 #5"], "what it does not want is over, too");
    reader.client(&ack(PacketKind::Pubrec, 99, 0)).unwrap();
    assert_eq!(reader.told(), ["Pubrel 99 0x92"]);
}

/// Tests MQTT 5, section 3.3.2.3.3.
#[test]
fn a_message_is_good_for_as_long_as_its_publisher_says() {
    let broker = broker();
    let (mut writer, mut reader) = (scene(&broker, |_| {}), scene(&broker, |_| {}));
    let late = |scene: &mut Scene, seconds: u64| scene.now = Duration::from_millis(1000 * seconds + 1);
    let expires = |seconds| [Property::MessageExpiry(seconds)];
    reader.client(&subscribe_with("a", 1, &[])).unwrap();
    reader.told();
    writer
        .client(&[publish_with(0x33, "a", "short", 1, &expires(3)), publish_with(0x33, "b", "long", 2, &expires(9))].concat())
        .unwrap();
    late(&mut reader, 2);
    assert_eq!(reader.told(), [format!("Publish a=short q1 #1 {:?}", expires(2))], "how long it is good still");
    writer.client(&publish_with(0x32, "a", "over", 1, &expires(1))).unwrap();
    late(&mut reader, 4);
    assert!(reader.told().is_empty(), "it came too late");
    let mut newcomer = scene(&broker, |_| {});
    late(&mut newcomer, 7);
    newcomer.client(&subscribe_with("#", 1, &[])).unwrap();
    assert_eq!(newcomer.told(), ["Suback [01]".to_owned(), format!("Publish b=long q1 #1 kept {:?}", expires(3))]);
    late(&mut newcomer, 20);
    newcomer.client(&subscribe_with("#", 1, &[])).unwrap();
    assert_eq!(newcomer.told(), ["Suback [01]"]);
}

/// Tests MQTT 5, section 3.8.3.1.
#[test]
fn a_subscription_is_as_its_options_say() {
    let broker = broker();
    let mut both = scene(&broker, |_| {});
    both.client(&subscribe_with("a", 0x04, &[])).unwrap();
    both.client(&subscribe_with("b", 0x08, &[Property::SubscriptionId(5)])).unwrap();
    both.client(&subscribe_with("+", 0x01, &[Property::SubscriptionId(300)])).unwrap();
    both.told();
    both.client(&publish_with(0x31, "b", "x", 0, &[])).unwrap();
    let ids = [Property::SubscriptionId(5), Property::SubscriptionId(300)];
    let other = [ids[1], ids[0]];
    let told = both.told();
    assert!([format!("Publish b=x q0 kept {ids:?}"), format!("Publish b=x q0 kept {other:?}")].contains(&told[0]), "{told:?}");
    both.client(&unsubscribe_from("+")).unwrap();
    both.client(&unsubscribe_from("never")).unwrap();
    assert_eq!(both.told(), ["Unsuback [00]", "Unsuback [11]"]);
    both.client(&publish_with(0x30, "a", "x", 0, &[])).unwrap();
    assert!(both.told().is_empty(), "its own is left out");
    let mut other = Scene::at_broker(&broker, OPERATOR, |_| {});
    other.client(&publish(0x31, "a", "y", 0)).unwrap();
    assert_eq!(both.told(), ["Publish a=y q0"], "and not told that it is kept");
    both.client(&publish_with(0x31, "own", "1", 0, &[])).unwrap();
    both.client(&subscribe_with("own", 0x04, &[])).unwrap();
    assert_eq!(both.told().len(), 1, "what is kept of its own is left out, too");
    for (options, told) in [(0x10, 1), (0x20, 1), (0x00, 2)] {
        both.client(&subscribe_with("a", options, &[])).unwrap();
        assert_eq!(both.told().len(), told, "{options:#x}");
    }
    let mut newcomer = scene(&broker, |_| {});
    newcomer
        .client(&[subscribe_with("a", 0x20, &[]), subscribe_with("b", 0x18, &[Property::SubscriptionId(5)])].concat())
        .unwrap();
    assert_eq!(newcomer.told()[2..], ["Publish b=x q0 kept [SubscriptionId(5)]"], "one that is new");
}

#[test]
fn whoever_subscribes_is_told_why_not() {
    let broker = broker();
    let mut reader = scene(&broker, |_| {});
    let mut code = |filter: &str| {
        reader.client(&subscribe_with(filter, 0, &[])).unwrap();
        reader.told()[0].split(' ').nth(1).unwrap().to_owned()
    };
    assert_eq!(code("a"), "[00]");
    assert_eq!(code("a/#/b"), "[8f]");
    assert_eq!(code("$SYS/#"), "[8f]");
    assert_eq!(code("$share/g"), "[8f]");
    assert_eq!(code("$share//a"), "[8f]");
    assert_eq!(code("$share/g+/a"), "[8f]");
    assert_eq!(code("$share/g/a/#/b"), "[8f]");
    for ours in ["#", "+/robot/state/robot", "site/#", "site/robot"] {
        assert_eq!(code(&format!("$share/g/{ours}")), "[9e]", "{ours}");
    }
    assert_eq!(code("$share/g/b"), "[00]");
    (0..FILTERS - 2).for_each(|n| assert_eq!(code(&format!("f/{n}")), "[00]"));
    assert_eq!(code("one/more"), "[97]");
    let mut viewer = scene(&broker, |terms| terms.tier = VIEWER);
    viewer.client(&subscribe_with("$share/g/b", 1, &[])).unwrap();
    assert!(viewer.told()[0].starts_with("Suback [9e]"), "whoever only looks takes nothing from others");
    let three = Scene::at_broker(&broker, OPERATOR, |_| {}).subscribe(&[("$share/g/b", crate::packet::Qos::One)]);
    assert_eq!(three, ["Suback (1, [128])"]);
}

/// Tests MQTT 5, section 4.8.2.
#[test]
fn of_those_who_share_a_subscription_each_message_goes_to_one() {
    let broker = broker();
    let member = || {
        let mut member = scene(&broker, |_| {});
        member.client(&subscribe_with("$share/workers/a/+", 1, &[])).unwrap();
        member.told();
        member
    };
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    writer.client(&publish(0x33, "a/kept", "k", 1)).unwrap();
    let (mut one, mut other, mut all) = (member(), member(), writer.everybody());
    all.got();
    for n in 0..10 {
        writer.client(&publish(0x32, "a/x", &n.to_string(), 1)).unwrap();
    }
    let (got, others) = (one.told(), other.told());
    assert_eq!((got.len(), others.len(), all.read().len()), (5, 5, 10), "what is kept is not for groups");
    one.client(&unsubscribe_from("$share/workers/a/+")).unwrap();
    (0..3).for_each(|_| writer.client(&publish(0x32, "a/x", "more", 1)).unwrap());
    assert_eq!((one.told(), other.told().len()), (vec!["Unsuback [00]".to_owned()], 3));
}

/// Tests MQTT 5, sections 3.14 and 4.13.
#[test]
fn whoever_is_sent_away_is_told_why() {
    let broker = broker();
    let told = |change: &dyn Fn(&mut Scene), ended| {
        let mut scene = scene(&broker, |_| {});
        change(&mut scene);
        scene.connection.handle_end(ended, scene.now);
        scene.told()
    };
    let nothing = |_: &mut Scene| {};
    for (ended, reason) in [
        (Ended::Idle, "0x8d"),
        (Ended::TakenOver, "0x8e"),
        (Ended::Closing, "0x8b"),
        (Ended::NotKnown, "0x87"),
        (Ended::GaveWay, "0x89"),
        (Ended::Unreleased, "0x93"),
        (Ended::Unexpected(PacketKind::Auth), "0x82"),
        (Ended::Malformed(Malformed::TooLong { length: 2, limit: 1 }), "0x95"),
        (Ended::Malformed(Malformed::Qos(3)), "0x81"),
        (Ended::Malformed(Malformed::Alias(11)), "0x94"),
        (Ended::Malformed(Malformed::Topic), "0x90"),
        (Ended::TooMuch { what: "bytes", most: 1 }, "0x97"),
    ] {
        assert_eq!(told(&nothing, ended), [format!("Disconnect {reason}")], "{ended}");
    }
    for ended in [Ended::Left, Ended::LeftWithWill, Ended::Gone] {
        assert!(told(&nothing, ended).is_empty(), "{ended}");
    }
    let busy = |scene: &mut Scene| scene.client(&[0xC0, 0]).unwrap();
    assert!(told(&busy, Ended::GaveWay).is_empty(), "nothing is said behind half a message");
    assert_eq!(told(&busy, Ended::Idle), ["Pingresp", "Disconnect 0x8d"]);
    let mut three = Scene::at_broker(&broker, OPERATOR, |_| {});
    three.connection.handle_end(Ended::Idle, three.now);
    assert!(three.got().is_empty(), "MQTT 3.1.1 knows no such packet");
}

#[test]
fn what_is_not_of_this_version_ends_the_connection() {
    let broker = broker();
    let ends = |packet: &[u8]| scene(&broker, |_| {}).client(packet).unwrap_err();
    assert_eq!(ends(&[0xF0, 0]), Ended::Unexpected(PacketKind::Auth));
    assert_eq!(ends(&disconnect_with(0, &[])), Ended::Left);
    assert_eq!(ends(&disconnect_with(4, &[])), Ended::LeftWithWill);
    assert_eq!(Scene::of(OPERATOR).client(&[0xF0, 0]), Err(Ended::Unexpected(PacketKind::Auth)));
    assert_eq!(Scene::of(OPERATOR).client(&[0xE0, 1, 4]), Err(Ended::Malformed(Malformed::Trailing(1))));
}
