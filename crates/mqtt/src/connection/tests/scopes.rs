//! Tests scopes: a client gets no message on a topic outside of its scope, and cannot tell whether there is any.

use std::sync::Arc;

use proptest::prelude::*;

use super::scene::{OPERATOR, Scene, TestRights, broker, five, in_words, publish, subscribe, taken, unsubscribe};
use crate::broker::Announcement;
use crate::packet::Qos;
use crate::packet::connect::Will;
use crate::rights::Scope;
use crate::{Broker, Ended, PacketKind, Session, Terms};

/// All topics that begin with one of these letters.
fn beginning(letters: &'static str) -> Scope {
    Scope::of(move |topic| topic.starts_with(|first| letters.contains(first)))
}

fn scoped(broker: &Arc<Broker>, letters: &'static str) -> Scene {
    Scene::at_broker(broker, OPERATOR, |terms| terms.scope = beginning(letters))
}

#[test]
fn no_route_leads_to_a_topic_outside_of_the_scope() {
    let broker = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    writer.client(&[publish(0x31, "a/kept", "1", 0), publish(0x31, "b/kept", "1", 0)].concat()).unwrap();
    let mut reader = scoped(&broker, "a");
    for filters in [&["#"][..], &["b/kept", "b/#", "+/kept", "a/kept"]] {
        let filters: Vec<_> = filters.iter().map(|filter| (*filter, Qos::Two)).collect();
        let got = reader.subscribe(&filters);
        assert!(got[0].starts_with("Suback") && got.len() > 1 && got[1..].iter().all(|got| got.contains("a/kept=1")), "{got:?}");
    }
    writer
        .client(&[publish(0x30, "b/kept", "2", 0), publish(0x30, "b/new", "2", 0), publish(0x30, "a/new", "2", 0)].concat())
        .unwrap();
    assert!(broker.publish(&Announcement::passing("b/own", b"3")) && broker.publish(&Announcement::passing("a/own", b"3")));
    for topic in ["b/will", "a/will"] {
        let (topic, payload, properties) = (topic.to_owned(), "4".into(), bytes::Bytes::new());
        let will = Will { topic, payload, qos: Qos::Zero, retain: false, delay_s: 0, expiry_s: None, properties };
        let mut dying = Scene::at_broker(&broker, OPERATOR, |terms| terms.connect.will = Some(will));
        dying.connection.handle_end(Ended::Gone, dying.now);
    }
    assert_eq!(reader.read(), ["a/new=2 q0", "a/own=3 q1", "a/will=4 q0"]);
    assert_eq!(writer.subscribe(&[("#", Qos::Zero)]).len(), 1 + 2, "others get what is kept there");
}

/// Of a filter that is granted or refused, and of a message that is refused, the answer is the same whether the topic
/// is in use, is the program's own, takes commands, or is unknown.
#[test]
fn the_answers_do_not_tell_what_is_outside_of_the_scope() {
    let broker = broker();
    let mut reader = Scene::at_broker(&broker, OPERATOR, |_| {});
    reader.subscribe(&[("#", Qos::Zero)]);
    reader.client(&publish(0x31, "b/used", "1", 0)).unwrap();
    for is_five in [false, true] {
        let mut answers = Vec::new();
        for topic in ["b/used", "b/unknown", "site/robot/state", "site/robot/command/start", "site/robot/command/stop"] {
            let scene = |terms: &mut Terms| {
                terms.scope = beginning("a");
                terms.connect.reception.wants_words = true;
            };
            let mut scene = if is_five { five::scene(&broker, scene) } else { Scene::at_broker(&broker, OPERATOR, scene) };
            for first in [0x32, 0x3A, 0x34, 0x3C] {
                let said = if is_five { five::publish_with(first, topic, "x", 7, &[]) } else { publish(first, topic, "x", 7) };
                scene.client(&said).unwrap();
            }
            assert!(scene.heard().iter().all(|heard| topic.ends_with("stop") && heard.contains("stop")), "{topic}");
            scene
                .client(&if is_five { five::subscribe_with(topic, 1, &[]) } else { subscribe(7, &[(topic, Qos::One)]) })
                .unwrap();
            answers.push(taken(scene.connection.to_client()));
        }
        assert!(!answers[0].is_empty() && answers.iter().all(|answer| *answer == answers[0]), "{answers:?}");
    }
    reader.read();
    assert!(reader.read().is_empty(), "nobody got any of it");
}

/// The publisher of a message is not told that it has subscribers when only clients match that may not read it.
#[test]
fn a_subscriber_outside_of_its_scope_does_not_count() {
    let broker = broker();
    let mut reader = scoped(&broker, "b");
    reader.subscribe(&[("#", Qos::One)]);
    let mut writer = five::scene(&broker, |_| {});
    writer.client(&five::publish_with(0x32, "a", "x", 7, &[])).unwrap();
    assert_eq!(writer.told(), ["Puback 7 0x10"]);
}

/// A message for a group goes to a member that may read it, whosever turn it is.
#[test]
fn no_turn_of_a_group_is_lost_to_a_member_that_may_not_read_the_message() {
    let broker = broker();
    let mut members = ["a", "b", "b"].map(|letters| {
        let mut member = five::scene(&broker, |terms| terms.scope = beginning(letters));
        member.client(&five::subscribe_with("$share/g/+/x", 0, &[])).unwrap();
        member.told();
        member
    });
    for _ in 0..6 {
        assert!(broker.publish(&Announcement::passing("a/x", b"x")));
    }
    assert_eq!(members.each_mut().map(|member| member.told().len()), [6, 0, 0]);
}

/// What waits for a client of a session, and what it has not acknowledged, goes out only if it may still read it.
#[test]
fn a_session_that_is_resumed_with_fewer_rights_gets_less() {
    let broker = broker();
    let mut writer = Scene::at_broker(&broker, OPERATOR, |_| {});
    let mut reader = writer.reader(&[("#", Qos::One)]);
    writer.client(&[publish(0x32, "a/1", "x", 1), publish(0x32, "b/1", "x", 2)].concat()).unwrap();
    assert_eq!(reader.got(), ["Publish a/1=x q1 #1", "Publish b/1=x q1 #2"]);
    let session = reader.connection.into_session().unwrap();
    writer.client(&[publish(0x32, "b/2", "x", 3), publish(0x32, "a/2", "x", 4)].concat()).unwrap();
    let mut reader = Scene::at_broker(&broker, OPERATOR, |terms| {
        (terms.session, terms.scope) = (session, beginning("a"));
    });
    assert_eq!(reader.got(), ["Publish a/1=x q1 #1 again", "Publish a/2=x q1 #3"]);
    writer.client(&[publish(0x32, "a/3", "x", 5), publish(0x32, "b/3", "x", 6)].concat()).unwrap();
    assert_eq!(reader.got(), ["Publish a/3=x q1 #4"]);
    let session = reader.connection.into_session().unwrap();
    let mut reader = Scene::at_broker(&broker, OPERATOR, |terms| terms.session = session);
    reader.got();
    writer.client(&publish(0x32, "b/3", "y", 7)).unwrap();
    assert_eq!(reader.got(), ["Publish b/3=y q1 #5"], "rights may also grow");
}

/// Rights are asked again when they have changed, although the client publishes on the same topic.
#[test]
fn changed_rights_count_at_once() {
    #[derive(Debug)]
    struct Switch(Arc<std::sync::atomic::AtomicBool>);
    impl crate::Rights for Switch {
        fn is_for_commands(&self, _: &str) -> bool {
            false
        }
        fn may_publish(&self, _: crate::Tier, _: &str) -> bool {
            self.0.load(std::sync::atomic::Ordering::Relaxed)
        }
        fn may_share(&self, _: crate::Tier, _: &str) -> bool {
            false
        }
    }
    let is_open = Arc::<std::sync::atomic::AtomicBool>::default();
    let broker = Arc::new(Broker::new(Switch(Arc::clone(&is_open))));
    let mut writer = five::scene(&broker, |_| {});
    let mut says = || {
        writer.client(&five::publish_with(0x32, "a", "x", 7, &[])).unwrap();
        writer.told()
    };
    assert_eq!(says(), ["Puback 7 0x87"]);
    is_open.store(true, std::sync::atomic::Ordering::Relaxed);
    broker.rights_changed();
    assert_eq!(says(), ["Puback 7 0x10"]);
}

const CLIENTS: usize = 4;

const SCOPES: [&str; 5] = ["", "a", "b", "ab", "abs"];

#[derive(Clone, Debug)]
enum Act {
    Subscribe(&'static str, Qos),
    Unsubscribe(&'static str),
    /// Publishes as the client, or as the program.
    Publish(&'static str, Qos, bool, bool),
    Read(bool),
    /// Comes back with this scope, if scopes may change.
    Break(&'static str),
}

/// Runs a script. Returns everything that each client received. If `apart` is a client, that client has no scope, and
/// nobody publishes on the topics outside of the scope that it would have.
fn play(script: &[(usize, Act)], scopes: [&'static str; CLIENTS], apart: Option<usize>) -> [Vec<u8>; CLIENTS] {
    let broker = Arc::new(Broker::new(TestRights));
    let come = |client: usize, session: Session| {
        let change = |terms: &mut Terms| {
            terms.session = session;
            terms.connect.reception.aliases = 2;
            if apart != Some(client) {
                terms.scope = beginning(scopes[client]);
            }
        };
        if client.is_multiple_of(2) { Scene::at_broker(&broker, OPERATOR, change) } else { five::scene(&broker, change) }
    };
    let mut scenes: [Option<Scene>; CLIENTS] = std::array::from_fn(|client| Some(come(client, Session::default())));
    let mut got: [Vec<u8>; CLIENTS] = std::array::from_fn(|_| Vec::new());
    for (number, (client, act)) in script.iter().enumerate() {
        let (id, is_five) = (number as u16 + 1, !client.is_multiple_of(2));
        let scene = scenes[*client].as_mut().unwrap();
        match act {
            Act::Subscribe(filter, qos) if is_five => scene.client(&five::subscribe_with(filter, *qos as u8, &[])).unwrap(),
            Act::Subscribe(filter, qos) => scene.client(&subscribe(id, &[(filter, *qos)])).unwrap(),
            Act::Unsubscribe(filter) if is_five => scene.client(&five::unsubscribe_from(filter)).unwrap(),
            Act::Unsubscribe(filter) => scene.client(&unsubscribe(id, &[filter])).unwrap(),
            Act::Publish(topic, qos, retain, is_program) => {
                let is_hidden = apart.is_some_and(|apart| !beginning(scopes[apart]).contains(topic));
                let (topic, payload) = match (is_hidden, *is_program, apart == Some(*client)) {
                    (true, false, true) => ("site/robot/state", number.to_string()),
                    (true, _, _) => continue,
                    (false, _, _) => (*topic, number.to_string()),
                };
                if *is_program {
                    broker.publish(&Announcement { topic, payload: payload.as_bytes(), retain: *retain, properties: &[] });
                } else {
                    let first = 0x30 | (*qos as u8) << 1 | u8::from(*retain);
                    let five = || five::publish_with(first, topic, &payload, id, &[]);
                    scene.client(&if is_five { five() } else { publish(first, topic, &payload, id) }).unwrap();
                }
            }
            Act::Read(acknowledges) => got[*client].extend(read(scene, *acknowledges)),
            Act::Break(_) => {
                let session = scenes[*client].take().unwrap().connection.into_session().unwrap();
                scenes[*client] = Some(come(*client, session));
            }
        }
    }
    for (scene, got) in scenes.iter_mut().zip(&mut got) {
        got.extend(read(scene.as_mut().unwrap(), true));
    }
    got
}

/// Reads everything that waits for a client, which may acknowledge it.
fn read(scene: &mut Scene, acknowledges: bool) -> Vec<u8> {
    let mut all = Vec::new();
    loop {
        scene.connection.handle_come(scene.now);
        let got = taken(scene.connection.to_client());
        scene.connection.handle_drained(scene.now);
        if got.is_empty() {
            return all;
        }
        let mut rest = &got[..];
        while let Some(frame) = crate::frame(rest, usize::MAX).unwrap() {
            let (packet, others) = rest.split_at(frame.length);
            rest = others;
            let body = &packet[frame.head..];
            if frame.kind == PacketKind::Publish && frame.flags & 6 != 0 && acknowledges {
                let topic = usize::from(u16::from_be_bytes([body[0], body[1]]));
                let id = u16::from_be_bytes([body[2 + topic], body[3 + topic]]);
                scene.acknowledge(if frame.flags & 6 == 2 { PacketKind::Puback } else { PacketKind::Pubrec }, id);
            } else if frame.kind == PacketKind::Pubrel {
                scene.acknowledge(PacketKind::Pubcomp, u16::from_be_bytes([body[0], body[1]]));
            }
        }
        all.extend(got);
    }
}

fn act() -> impl Strategy<Value = Act> {
    let topic = || prop::sample::select(vec!["a", "a/x", "a/y", "b", "b/x", "b/y", "c/x"]);
    let filter = || prop::sample::select(vec!["#", "+", "+/x", "a/#", "b/#", "a/x", "b/x", "b/+", "c/x"]);
    let qos = || prop::sample::select(vec![Qos::Zero, Qos::One, Qos::Two]);
    prop_oneof![
        3 => (filter(), qos()).prop_map(|(filter, qos)| Act::Subscribe(filter, qos)),
        1 => filter().prop_map(Act::Unsubscribe),
        6 => (topic(), qos(), any::<bool>(), any::<bool>()).prop_map(|(topic, qos, retain, own)| Act::Publish(topic, qos, retain, own)),
        2 => any::<bool>().prop_map(Act::Read),
        2 => prop::sample::select(SCOPES.to_vec()).prop_map(Act::Break),
    ]
}

fn scopes() -> impl Strategy<Value = [&'static str; CLIENTS]> {
    prop::array::uniform4(prop::sample::select(SCOPES.to_vec()))
}

proptest! {
    /// For each client the world is, to the byte, as if the topics outside of its scope did not exist: it gets all
    /// messages that it would get without a scope, and neither ids, answers nor aliases tell of the others.
    #[test]
    fn a_client_cannot_tell_its_scope_from_the_whole_world(script in prop::collection::vec((0..CLIENTS, act()), 0..60), scopes in scopes()) {
        let got = play(&script, scopes, None);
        for client in 0..CLIENTS {
            let alone = play(&script, scopes, Some(client));
            prop_assert_eq!(&got[client], &alone[client], "client {} with the scope {:?}", client, scopes[client]);
        }
    }

    /// Whatever rights a client comes back with, it gets no message on a topic outside of them.
    #[test]
    fn nobody_ever_gets_a_topic_outside_of_its_scope(script in prop::collection::vec((0..CLIENTS, act()), 0..80), mut scopes in scopes()) {
        let broker = broker();
        let mut scenes: Vec<Scene> = scopes.iter().map(|letters| scoped(&broker, letters)).collect();
        for (number, (client, act)) in script.iter().enumerate() {
            let scene = &mut scenes[*client];
            match act {
                Act::Subscribe(filter, qos) => scene.client(&subscribe(1, &[(filter, *qos)])).unwrap(),
                Act::Unsubscribe(filter) => scene.client(&unsubscribe(1, &[filter])).unwrap(),
                Act::Publish(topic, _, retain, true) => {
                    broker.publish(&Announcement { topic, payload: b"own", retain: *retain, properties: &[] });
                }
                Act::Publish(topic, qos, retain, false) => {
                    let first = 0x30 | (*qos as u8) << 1 | u8::from(*retain);
                    scene.client(&publish(first, topic, &number.to_string(), number as u16 + 1)).unwrap();
                }
                Act::Read(acknowledges) => {
                    for words in in_words(&read(scene, *acknowledges)) {
                        let Some(topic) = words.strip_prefix("Publish ") else { continue };
                        prop_assert!(beginning(scopes[*client]).contains(topic), "{} in {:?}", words, scopes[*client]);
                    }
                }
                Act::Break(letters) => {
                    let end = Scene::at_broker(&broker, OPERATOR, |_| {});
                    let session = std::mem::replace(scene, end).connection.into_session().unwrap();
                    scopes[*client] = letters;
                    *scene = Scene::at_broker(&broker, OPERATOR, |terms| {
                        (terms.session, terms.scope) = (session, beginning(letters));
                    });
                }
            }
        }
    }
}
