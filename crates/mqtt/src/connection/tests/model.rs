//! Compares clients of both versions with a model of the standard. The programs are random: clients publish,
//! subscribe, read, break off and come back. The model has no queues, trees or connections.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use proptest::prelude::*;

use super::scene::{OPERATOR, Scene, broker, five, in_words, publish, subscribe, taken, unsubscribe};
use crate::filter::matches;
use crate::frame::PacketKind;
use crate::packet::Qos;
use crate::{Broker, Session, Terms};

const CLIENTS: usize = 4;

/// Clients from this index on speak MQTT 5.
const FIVE: usize = 2;

#[derive(Clone, Debug)]
enum Act {
    /// The last field is the option No Local, which only MQTT 5 has: the client does not get its own messages.
    Subscribe(&'static str, Qos, bool),
    Unsubscribe(&'static str),
    Publish(&'static str, Qos, bool),
    /// Removes the topic's retained message.
    Clear(&'static str),
    /// Reads all messages. The field says whether the client acknowledges them.
    Read(bool),
    Break,
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Said {
    topic: String,
    payload: String,
    qos: Qos,
}

#[derive(Debug, Default)]
struct Expected {
    held: BTreeMap<&'static str, (Qos, bool)>,
    is_here: bool,
    /// Messages that were published for the client, in order. The flag says whether the message may be lost.
    live: VecDeque<(Said, bool)>,
    /// Messages that were retained when the client subscribed.
    kept: BTreeSet<(String, String, Qos)>,
    unacknowledged: Vec<Said>,
}

#[derive(Debug, Default)]
struct Model {
    clients: [Expected; CLIENTS],
    /// The retained message of each topic. The last field is the client that published it.
    kept: BTreeMap<&'static str, (String, Qos, usize)>,
    /// All messages that were ever published.
    ever: BTreeSet<(String, String)>,
}

impl Model {
    fn publish(&mut self, by: usize, topic: &'static str, payload: &str, qos: Qos, retain: bool) {
        if retain {
            self.ever.insert((topic.to_owned(), payload.to_owned()));
            if payload.is_empty() {
                self.kept.remove(topic)
            } else {
                self.kept.insert(topic, (payload.to_owned(), qos, by))
            };
        }
        for (number, client) in self.clients.iter_mut().enumerate() {
            let matching =
                client.held.iter().filter(|(filter, (_, no_local))| matches(filter, topic) && !(*no_local && number == by));
            let Some(granted) = matching.map(|(_, (granted, _))| *granted).max() else { continue };
            let qos = granted.min(qos);
            if client.is_here || qos > Qos::Zero {
                client.live.push_back((Said { topic: topic.to_owned(), payload: payload.to_owned(), qos }, false));
            }
        }
    }

    fn subscribe(&mut self, client: usize, filter: &'static str, qos: Qos, no_local: bool) {
        let number = client;
        let client = &mut self.clients[client];
        client.held.insert(filter, (qos, no_local));
        let found = self.kept.iter().filter(|(topic, (_, _, by))| matches(filter, topic) && !(no_local && *by == number));
        client.kept.extend(found.map(|(topic, (payload, kept, _))| ((*topic).to_owned(), payload.clone(), qos.min(*kept))));
    }
}

/// A client of the tested broker: its connection, or its stored session.
enum Real {
    Here(Box<Scene>),
    Away(Box<Session>),
}

struct Play {
    broker: Arc<Broker>,
    model: Model,
    real: [Option<Real>; CLIENTS],
    said: u32,
}

impl Play {
    fn new() -> Play {
        let broker = broker();
        let mut model = Model::default();
        model.clients.iter_mut().for_each(|client| client.is_here = true);
        let real = std::array::from_fn(|client| Some(Real::Here(Box::new(come(&broker, client, Session::default())))));
        Play { model, real, said: 0, broker }
    }

    fn here(&mut self, client: usize) -> Option<&mut Scene> {
        match self.real[client].as_mut() {
            Some(Real::Here(scene)) => Some(scene),
            Some(Real::Away(_)) | None => None,
        }
    }

    fn act(&mut self, client: usize, act: &Act) {
        if self.here(client).is_none() && !matches!(act, Act::Break) {
            return;
        }
        match *act {
            Act::Subscribe(filter, qos, no_local) => {
                let no_local = no_local && client >= FIVE;
                // Earlier retained messages are read first, so that it is known to which subscription they belong.
                self.read(client, true);
                let packet = if client < FIVE {
                    subscribe(1, &[(filter, qos)])
                } else {
                    five::subscribe_with(filter, qos as u8 | u8::from(no_local) << 2, &[])
                };
                self.here(client).unwrap().client(&packet).unwrap();
                self.model.subscribe(client, filter, qos, no_local);
            }
            Act::Unsubscribe(filter) => {
                self.read(client, true);
                let packet = if client < FIVE { unsubscribe(1, &[filter]) } else { five::unsubscribe_from(filter) };
                self.here(client).unwrap().client(&packet).unwrap();
                self.model.clients[client].held.remove(filter);
            }
            Act::Publish(topic, qos, retain) => {
                self.said += 1;
                self.say(client, topic, &self.said.to_string(), qos, retain);
            }
            Act::Clear(topic) => self.say(client, topic, "", Qos::Zero, true),
            Act::Read(acknowledges) => self.read(client, acknowledges),
            Act::Break => self.break_off_or_come_back(client),
        }
    }

    fn say(&mut self, client: usize, topic: &'static str, payload: &str, qos: Qos, retain: bool) {
        let id = u16::from(qos > Qos::Zero) * 7;
        let first = 0x30 | (qos as u8) << 1 | u8::from(retain);
        let scene = self.here(client).unwrap();
        let packet =
            if client < FIVE { publish(first, topic, payload, id) } else { five::publish_with(first, topic, payload, id, &[]) };
        scene.client(&packet).unwrap();
        if qos == Qos::Two {
            scene.acknowledge(PacketKind::Pubrel, id);
        }
        self.model.publish(client, topic, payload, qos, retain);
    }

    fn break_off_or_come_back(&mut self, client: usize) {
        let expected = &mut self.model.clients[client];
        self.real[client] = Some(match self.real[client].take().unwrap() {
            Real::Here(scene) => {
                expected.is_here = false;
                expected.kept.clear();
                expected.live.iter_mut().for_each(|(said, may_be_lost)| *may_be_lost = said.qos == Qos::Zero);
                Real::Away(Box::new(scene.connection.into_session().unwrap()))
            }
            Real::Away(session) => {
                expected.is_here = true;
                let again = expected.unacknowledged.drain(..).map(|said| (said, false));
                let later = std::mem::take(&mut expected.live);
                expected.live = again.chain(later).collect();
                Real::Here(Box::new(come(&self.broker, client, *session)))
            }
        });
    }

    /// Reads everything, and compares it with what is expected.
    fn read(&mut self, client: usize, acknowledges: bool) {
        let (mut live, mut kept) = (Vec::new(), BTreeSet::new());
        loop {
            let scene = self.here(client).unwrap();
            scene.connection.handle_come(scene.now);
            let got = taken(scene.connection.to_client());
            let got = if client < FIVE { in_words(&got) } else { five::in_words(&got) };
            scene.connection.handle_drained(scene.now);
            if got.is_empty() {
                break;
            }
            for words in got {
                let Some((said, id, is_newly_kept)) = message(&words) else {
                    if let Some(id) = words.strip_prefix("Pubrel ") {
                        scene.acknowledge(PacketKind::Pubcomp, id.parse().unwrap());
                    }
                    continue;
                };
                if acknowledges && said.qos > Qos::Zero {
                    scene.acknowledge(if said.qos == Qos::One { PacketKind::Puback } else { PacketKind::Pubrec }, id);
                }
                if is_newly_kept {
                    kept.insert((said.topic, said.payload, said.qos));
                } else {
                    live.push(said);
                }
            }
        }
        let Model { clients, ever, .. } = &mut self.model;
        let expected = &mut clients[client];
        for said in live {
            let place = expected.live.iter().position(|(other, _)| *other == said);
            if let Some(place) = place.filter(|place| expected.live.iter().take(*place).all(|(_, may_be_lost)| *may_be_lost)) {
                expected.live.drain(..=place);
            } else {
                // A client that missed something gets the retained messages again. It has received some of these
                // messages before, and has left others unread.
                assert!(ever.contains(&(said.topic.clone(), said.payload.clone())), "{said:?} was not expected: {expected:?}");
                continue;
            }
            if !acknowledges && said.qos > Qos::Zero {
                expected.unacknowledged.push(said);
            }
        }
        expected.live.retain(|(_, may_be_lost)| !may_be_lost);
        assert!(expected.live.is_empty(), "it did not get {:?}", expected.live);
        assert!(kept.is_superset(&expected.kept), "{kept:?} is kept, and not {:?}", expected.kept);
        expected.kept.clear();
    }
}

/// Connects a client, in its own version of MQTT.
fn come(broker: &Arc<Broker>, client: usize, session: Session) -> Scene {
    let resume = |terms: &mut Terms| terms.session = session;
    if client < FIVE { Scene::at_broker(broker, OPERATOR, resume) } else { five::scene(broker, resume) }
}

/// Parses a line like `Publish a=x q1 #7 kept again`.
fn message(words: &str) -> Option<(Said, u16, bool)> {
    let (said, marks) = words.strip_prefix("Publish ")?.split_once(" q")?;
    let (topic, payload) = said.split_once('=')?;
    let qos = Qos::of(marks[..1].parse().ok()?).ok()?;
    let id = marks.split_once('#').map_or(0, |(_, rest)| rest.split(' ').next().unwrap().parse().unwrap());
    let is_newly_kept = marks.contains("kept") && !marks.contains("again");
    Some((Said { topic: topic.into(), payload: payload.into(), qos }, id, is_newly_kept))
}

fn act() -> impl Strategy<Value = Act> {
    let topic = || prop::sample::select(vec!["a", "a/b", "a/c", "b", "/", "a//b"]);
    let filter = || prop::sample::select(vec!["a", "a/b", "a/+", "a/#", "#", "+", "+/+", "b", "/#", "a/+/b"]);
    let qos = || prop::sample::select(vec![Qos::Zero, Qos::One, Qos::Two]);
    prop_oneof![
        3 => (filter(), qos(), any::<bool>()).prop_map(|(filter, qos, no_local)| Act::Subscribe(filter, qos, no_local)),
        1 => filter().prop_map(Act::Unsubscribe),
        6 => (topic(), qos(), any::<bool>()).prop_map(|(topic, qos, retain)| Act::Publish(topic, qos, retain)),
        1 => topic().prop_map(Act::Clear),
        2 => any::<bool>().prop_map(Act::Read),
        2 => Just(Act::Break),
    ]
}

proptest! {
    #[test]
    fn whatever_clients_do_they_get_what_the_standard_says(script in prop::collection::vec((0..CLIENTS, act()), 0..60)) {
        let mut play = Play::new();
        for (client, act) in &script {
            play.act(*client, act);
        }
        for client in 0..CLIENTS {
            if play.here(client).is_none() {
                play.break_off_or_come_back(client);
            }
            play.read(client, true);
        }
    }
}
