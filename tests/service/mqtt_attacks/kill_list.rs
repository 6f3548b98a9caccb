//! Input that crashes or blocks brokers which trust their clients, case by case, through the public port.

use std::io::Write;

use super::client::{Came, Client};
use super::packets::{
    CONNACK, DISCONNECT, PUBACK, PUBCOMP, PUBREC, PUBREL, RETAIN, SUBACK, UNSUBACK, ack, connect, connect_with, packet, publish,
    subscribe, text, unsubscribe,
};
use super::siege::Siege;

#[test]
fn client_ids_of_whatever_characters_are_as_good_as_others() {
    Siege::in_both(|mut siege| {
        let long = "x".repeat(256);
        for id in ["a+", "$SYS", "#", "/", "a/b/+", "$share/a/#", "ü", "\u{feff}", " ", "slot0", "'; --", &long] {
            for _ in 0..20 {
                siege.client(id).settle();
            }
            let twice = [siege.client(id), siege.client(id)];
            drop(twice);
        }
        siege.stands();
    });
}

#[test]
fn a_client_that_greets_the_broker_is_sent_away() {
    Siege::in_both(|mut siege| {
        let greetings = [packet(CONNACK, &[0, 0]), packet(CONNACK, &[0, 0, 0]), packet(CONNACK, &[1, 0, 3, 0x22, 0, 10])];
        for greeting in &greetings {
            for _ in 0..3 {
                let mut stranger = siege.stranger();
                stranger.say(greeting);
                assert_eq!(stranger.next(), None);
                let mut guest = siege.client("greeter");
                guest.say(greeting);
                assert_eq!(guest.next(), None);
            }
        }
        siege.stands();
    });
}

#[test]
fn whoever_shares_a_subscription_and_leaves_with_what_it_has_not_acknowledged_breaks_nothing() {
    Siege::in_both(|mut siege| {
        for _ in 0..3 {
            let mut member = siege.client("member");
            assert_eq!(member.subscribe("$share/group/bags/#", 1), if siege.is_five { 1 } else { 0x80 });
            assert_eq!(member.subscribe("bags/#", 1), 1);
            let mut other = siege.client("other");
            for n in 0..200_u16 {
                other.say(&publish("bags/1", b"x", 1, 0, n + 1));
            }
            assert_eq!(member.message().topic, "bags/1", "and it is never acknowledged");
            drop(member);
            other.settle();
        }
        siege.stands();
    });
}

#[test]
fn whoever_asks_for_the_brokers_own_topics_is_told_no_and_stays() {
    Siege::in_both(|mut siege| {
        let mut explorer = siege.client("explorer");
        for filter in ["$SYS/#", "$SYS/broker/uptime", "$", "$share/a/#", "$queue/a"] {
            assert_eq!(explorer.subscribe(filter, 0), 0x80, "{filter}");
        }
        explorer.publish("$SYS/broker/uptime", b"0");
        explorer.say(&publish("$SYS/broker/uptime", b"0", 1, RETAIN, 7));
        assert_eq!(explorer.until(PUBACK).body, [0, 7]);
        assert_eq!(explorer.subscribe("#", 0), 0);
        siege.stands();
    });
}

#[test]
fn a_client_without_keep_alive_stays() {
    Siege::in_both(|mut siege| {
        let mut quiet = siege.stranger();
        quiet.say(&connect("quiet", 0));
        assert_eq!(quiet.next(), Some(Came { first: CONNACK, body: vec![0, 0] }));
        assert_eq!(quiet.subscribe("a", 0), 0);
        siege.client("other").publish("a", b"1");
        assert_eq!(quiet.message().payload, b"1");
        siege.stands();
    });
}

#[test]
fn an_empty_message_takes_a_kept_one_away_only_when_it_is_to_be_kept_itself() {
    Siege::in_both(|mut siege| {
        let mut sensor = siege.client("sensor");
        sensor.say(&publish("sensor/1", b"12", 0, RETAIN, 0));
        sensor.publish("sensor/1", b"");
        sensor.publish("hallsweep/discovery/state/temperature", b"");
        sensor.say(&publish("hallsweep/discovery/state/temperature", b"", 0, RETAIN, 0));
        sensor.settle();
        let mut reader = siege.client("reader");
        reader.subscribe("sensor/#", 0);
        let message = reader.message();
        assert_eq!((message.topic.as_str(), &*message.payload, message.is_kept), ("sensor/1", &b"12"[..], true));
        sensor.say(&publish("sensor/1", b"", 0, RETAIN, 0));
        sensor.settle();
        let mut late = siege.client("late");
        late.subscribe("sensor/#", 0);
        sensor.publish("sensor/2", b"13");
        assert_eq!(late.message().topic, "sensor/2", "nothing was kept");
        siege.stands();
    });
}

#[test]
fn whoever_lets_go_of_what_it_does_not_hold_is_answered() {
    Siege::in_both(|mut siege| {
        let mut client = siege.client("forgetful");
        for (id, filter) in [(7, "never/seen"), (8, "#"), (9, "$SYS/#"), (10, "a/#/b"), (11, "ü")] {
            client.say(&unsubscribe(id, filter));
            assert_eq!(client.until(UNSUBACK).body, id.to_be_bytes(), "{filter}");
        }
        siege.stands();
    });
}

#[test]
fn topics_that_are_none_here_are_acknowledged_and_go_nowhere_and_all_others_go_on() {
    Siege::in_both(|mut siege| {
        let mut listener = siege.client("listener");
        assert_eq!(listener.subscribe("#", 0), 0);
        let mut client = siege.client("foreigner");
        let deep = "/".repeat(400);
        for (id, topic) in (1..).zip(["$", "$a", "$ü", &deep]) {
            for qos in 0..3 {
                client.say(&publish(topic, b"x", qos, RETAIN, id));
            }
            assert_eq!(client.until(PUBACK).body, id.to_be_bytes(), "{topic}");
            client.until(PUBREC);
            client.say(&ack(PUBREL, id));
            client.until(PUBCOMP);
            client.subscribe(topic, 1);
        }
        for topic in ["ü", "über/alles", "日本", "😀", "\u{80}"] {
            client.publish(topic, b"x");
            let mut all = std::iter::from_fn(|| Some(listener.message().topic));
            assert_eq!(all.find(|topic| !topic.starts_with("hallsweep")).as_deref(), Some(topic));
        }
        siege.stands();
    });
}

#[test]
fn clients_of_other_versions_are_told_so() {
    let mut siege = Siege::begin();
    for level in [3, 6] {
        let mut client = siege.stranger();
        client.say(&connect_with(level, 2, 60, &text("other")));
        assert_eq!(client.next(), Some(Came { first: CONNACK, body: vec![0, 1] }));
        assert_eq!(client.next(), None);
    }
    siege.stands();
}

#[test]
fn acknowledgements_of_nothing_and_in_any_order_are_borne() {
    Siege::in_both(|mut siege| {
        let mut client = siege.client("muddled");
        for id in [1, 2, 3, 100, 101, 1001, 2000, u16::MAX] {
            for first in [PUBACK, PUBREC, PUBREL, PUBCOMP] {
                client.say(&ack(first, id));
            }
            assert_eq!(client.until(PUBCOMP).body, id.to_be_bytes());
        }
        assert_eq!(client.subscribe("muddle", 1), 1);
        let mut other = siege.client("other");
        for id in 1..=50 {
            other.say(&publish("muddle", &[0], 1, 0, id));
        }
        let ids: Vec<u16> =
            (0..50).map(|_| client.until(0x32)).map(|came| u16::from_be_bytes([came.body[8], came.body[9]])).collect();
        for id in ids.iter().rev().chain(&ids) {
            client.say(&ack(PUBACK, *id));
            client.say(&ack(PUBCOMP, *id));
        }
        client.settle();
        for qos_two in [3, 1, 2, 1, 3] {
            client.say(&publish("two", b"x", 2, 0, qos_two));
        }
        for id in [2, 2, 9, 1, 3] {
            client.say(&ack(PUBREL, id));
        }
        client.settle();
        siege.stands();
    });
}

#[test]
fn a_client_that_takes_its_leave_in_the_middle_of_a_burst_is_gone_and_no_more() {
    Siege::in_both(|mut siege| {
        for n in 0..50 {
            let mut client = siege.client(&format!("burst-{}", n % 3));
            let mut burst = subscribe(1, "burst/#", 1);
            for id in 1..200 {
                burst.extend(publish("burst/1", b"x", u8::try_from(id % 3).unwrap(), 0, id));
                if id == 100 + n {
                    burst.extend(DISCONNECT);
                }
            }
            let _ = client.try_say(&burst);
            drop(client);
        }
        siege.stands();
    });
}

/// A STOP is recognised before its packet is checked, so it may still contain errors.
#[test]
fn a_stop_that_wants_its_answer_where_no_topic_is_gets_it_where_answers_are() {
    let mut siege = Siege::begin();
    for wanted in ["", "panel/#", "panel/+/x", "$SYS/x", "hallsweep/discovery/state/robot"] {
        let mut listener = siege.client("listener");
        assert_eq!(listener.subscribe("#", 0), 0);
        let stop = "hallsweep/discovery/command/stop";
        let properties = [&[8][..], &text(wanted)].concat();
        let length = u8::try_from(properties.len()).expect("it is short");
        let said = packet(0x30, &[&text(stop)[..], &[length], &properties].concat());
        let client = Client::try_speaking(siege.broker, &connect("asker", 60), true).expect("it is let in");
        client.mouth().write_all(&said).expect("the broker takes it");
        loop {
            let message = listener.message();
            assert!(!message.topic.is_empty() && !message.topic.contains(['+', '#']), "{message:?}");
            if message.topic == format!("{stop}/result") {
                break;
            }
        }
        drop(client);
    }
    siege.stands();
}

#[test]
fn wills_of_all_kinds_end_nobody() {
    Siege::in_both(|mut siege| {
        let will = |topic: &str, flags: u8| connect_with(4, flags, 60, &[text("mortal"), text(topic), text("gone")].concat());
        for topic in ["ü", "$SYS/a", "a/+", "#", "", "hallsweep/discovery/state/robot", "unibo/qak/robotmind", "wills/1"] {
            for flags in [0x06, 0x0E, 0x16, 0x26, 0x2E, 0x36, 0x1E, 0x3E] {
                let mut mortal = siege.stranger();
                mortal.say(&will(topic, flags));
                let _ = mortal.next();
            }
        }
        siege.stands();
    });
}

#[test]
fn packets_that_cannot_be_end_their_own_connection_only() {
    Siege::in_both(|mut siege| {
        let nonsense: [Vec<u8>; 14] = [
            vec![0x30, 0x80, 0x80, 0x80, 0x80, 1],
            vec![0x30, 0xFF, 0xFF, 0xFF, 0x7F],
            vec![0x10, 0xFF, 0xFF, 0xFF, 0x7F],
            vec![0, 0],
            vec![0xF0, 0],
            vec![0x36, 0],
            packet(0x36, &[text("a"), vec![0, 1]].concat()),
            packet(0x38, &text("a")),
            packet(0x80, &[0, 1, 0, 1, b'a', 0]),
            packet(0x82, &[0, 1]),
            packet(0x82, &[0, 1, 0, 1, b'a', 3]),
            packet(SUBACK, &[0, 1, 0]),
            packet(0x32, &[text("a"), vec![0, 0]].concat()),
            connect("again", 60),
        ];
        for bytes in &nonsense {
            let mut stranger = siege.stranger();
            stranger.say(bytes);
            if bytes[..] != connect("again", 60) {
                assert_eq!(stranger.next(), None, "{bytes:?}");
            }
            let mut guest = siege.client("nonsense");
            guest.say(bytes);
            assert_eq!(guest.next(), None, "{bytes:?}");
        }
        siege.stands();
    });
}
