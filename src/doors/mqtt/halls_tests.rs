//! Tests of a broker with several halls: each command and each STOP reaches the hall that its topic names, and nobody
//! learns anything of a hall that he may not see.

use std::collections::BTreeSet;

use bytes::BytesMut;
use rumqttc::{Connect, ConnectReturnCode, LastWill, Packet, QoS};
use tokio::net::TcpListener;
use tokio::runtime::Handle;
use tokio::sync::mpsc;

use super::*;
use crate::access::{Access, Caller, Keyring, Keys, OPERATOR, Role};
use crate::api::tests::fixture::{idle, touch};
use crate::doors::mqtt::commands::ResultMessage;
use crate::doors::mqtt::hearing::Hearing;
use crate::doors::mqtt::identity::Identity;
use crate::doors::mqtt::read_ahead::{Pool, Taker, read_ahead};
use crate::doors::mqtt::session::OwnSession;
use crate::doors::mqtt::session::testing::{Album, Peer, hall, map, publish, topics};
use crate::doors::mqtt::topics::Topics;
use crate::doors::mqtt::{Clients, Ways, serve};
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::clock::Clock;
use crate::runtime::tests::obedient::{Script, obedient};
use crate::runtime::tests::within::within;
use hallsweep_core::command::Command;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::resource::Resource;
use mqtt_gate::packet::{Qos, Version, write};
use mqtt_gate::{AnswerTo, Broker, CommandDecision, Listener, Said};

/// The halls `main` and `south`, and a key for each way of seeing them.
struct Scene {
    halls: Halls,
    main: Script,
    south: Script,
    topics: Topics,
    results: mpsc::Receiver<ResultMessage>,
    keyring: Keyring,
}

impl Scene {
    fn new() -> Scene {
        let (handle, main) = obedient(idle());
        let map = map(&[]);
        let halls = Halls::new(map.clone(), Commands::new(handle, topics(), true, mpsc::channel(16).0));
        let (handle, south) = obedient(idle());
        let topics = map.add(&hall("south"));
        let (answers, results) = mpsc::channel(16);
        halls.add(&hall("south"), Commands::new(handle, topics.clone(), true, answers));
        let mut keys = Keys::first().unwrap();
        for only in ["south", "main", "north"] {
            keys.add(&format!("only-{only}"), Role::Operator, Some([hall(only)].into())).unwrap();
        }
        keys.add("wall", Role::Viewer, None).unwrap();
        Scene { halls, main, south, topics, results, keyring: Keyring::of(keys).unwrap() }
    }

    fn token(&self, name: &str) -> String {
        self.keyring.keys().named(name).unwrap().token.reveal().to_owned()
    }

    fn listener(&self, name: &str) -> Arc<dyn Listener> {
        let caller = Caller::Known(self.keyring.check(&self.token(name)).unwrap());
        Identity(caller).listener(&self.halls, [127, 0, 0, 1].into())
    }

    /// Returns the numbers of STOPs that reached the two halls.
    async fn halted(&self) -> (usize, usize) {
        for _ in 0..8 {
            tokio::task::yield_now().await;
        }
        let stops = |script: &Script| script.given.lock().unwrap().iter().filter(|given| given.command == Command::Stop).count();
        (stops(&self.main), stops(&self.south))
    }
}

/// Hears these bytes as those of a client of this listener. Returns how many packets were marked as heard.
async fn hear(listener: Arc<dyn Listener>, bytes: &[u8]) -> usize {
    fn marks(taker: &Taker) -> usize {
        let mut halted = 0;
        while taker.take(&mut BytesMut::new(), |mark| halted += usize::from(mark.heard_ahead)) {}
        halted
    }
    let (feeder, taker) = read_ahead(&Pool::default());
    let mut hearing = Hearing::new(Version::Three, listener, feeder, Clock::default(), Handle::current());
    hearing.begin(bytes).await;
    marks(&taker)
}

fn packet(topic: &str, payload: &[u8]) -> BytesMut {
    let mut out = BytesMut::new();
    write::publish(&mut out, topic.as_bytes(), payload, Qos::Zero, 0, false);
    out
}

/// Ways to say STOP below the base of a hall.
const STOPS: [(&str, &str); 6] = [
    ("/command/stop", "x"),
    ("/command/move", r#"{"move":"h"}"#),
    ("/command", "STOP"),
    ("//command/+/stop", ""),
    ("/command/stop\u{1}", ""),
    ("/command/stop/#", ""),
];

/// Safety S8.
#[tokio::test]
async fn a_stop_halts_the_hall_that_its_topic_names_whatever_else_is_wrong_with_it() {
    for (end, payload) in STOPS {
        for (base, expected) in
            [("hallsweep/discovery", (1, 0)), ("hallsweep/halls/south", (0, 1)), ("hallsweep//halls/south", (0, 1))]
        {
            for name in [OPERATOR, "wall"] {
                let scene = Scene::new();
                let heard = hear(scene.listener(name), &packet(&format!("{base}{end}"), payload.as_bytes())).await;
                assert_eq!((heard, scene.halted().await), (1, expected), "{base}{end} of {name}");
            }
        }
    }
    let scene = Scene::new();
    hear(scene.listener(OPERATOR), &packet("unibo/qak/robotmind", b"msg(stopCmd,event,js,none,stopCmd,1)")).await;
    assert_eq!(scene.halted().await, (1, 0), "the old words mean the default hall");
}

#[tokio::test]
async fn whoever_may_not_see_a_hall_does_not_stop_it_and_no_unknown_hall_halts_another() {
    let old = packet("unibo/qak/robotmind", b"msg(stopCmd,event,js,none,stopCmd,1)");
    for (end, payload) in STOPS {
        let stop = |base: &str| packet(&format!("{base}{end}"), payload.as_bytes());
        let scene = Scene::new();
        for (name, base) in
            [("only-south", "hallsweep/discovery"), ("only-main", "hallsweep/halls/south"), (OPERATOR, "hallsweep/halls/north")]
        {
            assert_eq!(hear(scene.listener(name), &stop(base)).await, 0, "{base}{end} of {name}");
        }
        assert_eq!(hear(scene.listener("only-south"), &old).await, 0);
        assert_eq!(scene.halted().await, (0, 0), "{end}");
        hear(scene.listener("only-main"), &[stop("hallsweep/discovery"), old.clone()].concat()).await;
        hear(scene.listener("only-south"), &stop("hallsweep/halls/south")).await;
        assert_eq!(scene.halted().await, (2, 1), "{end}");
    }
}

#[tokio::test]
async fn a_command_is_for_the_hall_that_its_topic_names_and_needs_the_right_to_see_it() {
    let scene = Scene::new();
    let says = |name: &str, topic: &str| {
        let said = Said { topic: topic.as_bytes(), payload: b"", answer_to: None };
        scene.listener(name).hear(topic, said, None, false)
    };
    let [main, south, north] = ["discovery", "halls/south", "halls/north"].map(|hall| format!("hallsweep/{hall}/command/start"));
    assert_eq!(says("only-south", &main), CommandDecision::Forbidden);
    assert_eq!(says("only-south", "unibo/qak/events"), CommandDecision::Forbidden);
    assert_eq!(says("only-main", &south), CommandDecision::Forbidden);
    assert_eq!(says("only-north", &north), CommandDecision::Forbidden, "there is no such hall");
    scene.halted().await;
    assert!(scene.main.given.lock().unwrap().is_empty() && scene.south.given.lock().unwrap().is_empty());
    assert_eq!([says("only-south", &south), says(OPERATOR, &south)], [CommandDecision::Pass; 2]);
    assert_eq!(says(OPERATOR, &main), CommandDecision::Pass);
    scene.halted().await;
    assert_eq!((scene.main.given.lock().unwrap().len(), scene.south.given.lock().unwrap().len()), (1, 2));
}

/// Safety S4: a STOP in one hall makes no command of another hall outdated.
#[tokio::test]
async fn a_command_is_as_old_as_the_last_stop_of_its_own_hall() {
    let scene = Scene::new();
    let listener = scene.listener(OPERATOR);
    let start = "hallsweep/halls/south/command/start";
    let stop = |topic: &str| assert!(listener.hear_urgent(Said { topic: topic.as_bytes(), payload: b"", answer_to: None }));
    let epoch = || scene.halls.on(start).unwrap().1.epoch();
    let (came, first) = (listener.epoch(), epoch());
    stop("hallsweep/discovery/command/stop");
    let between = listener.epoch();
    stop("hallsweep/halls/south/command/stop");
    assert!(listener.epoch() != between && between != came && epoch() > first);
    for (arrived, expected) in
        [(came, first), (between, first), (listener.epoch(), epoch()), (mqtt_gate::Epoch(0), units::Epoch(0))]
    {
        listener.hear(start, Said { topic: start.as_bytes(), payload: b"", answer_to: None }, Some(arrived), false);
        scene.halted().await;
        assert_eq!(scene.south.given.lock().unwrap().last().unwrap().arrived, Some(expected));
    }
    for _ in 0..2 * REMEMBERED {
        stop("hallsweep/discovery/command/stop");
        listener.epoch();
    }
    assert_eq!(scene.halls.0.epochs.lock().unwrap().len(), REMEMBERED);
}

/// With a response topic nobody makes the program publish where he may not publish himself.
#[tokio::test]
async fn an_answer_is_not_sent_to_a_topic_of_another_hall() {
    let mut scene = Scene::new();
    let start = "hallsweep/halls/south/command/start";
    let result = scene.topics.result("start");
    for (name, wanted, is_allowed) in [
        ("only-south", "panel/answers", true),
        (OPERATOR, "panel/answers", true),
        (OPERATOR, "hallsweep/discovery/state/robot", false),
        (OPERATOR, "unibo/qak/events", false),
        (OPERATOR, "hallsweep/halls/south/event", false),
        (OPERATOR, "hallsweep/halls/north/event", false),
        (OPERATOR, "homeassistant/device/south/config", false),
        (OPERATOR, "homeassistant/device/lamp/config", true),
        ("only-south", "homeassistant/device/lamp/config", false),
    ] {
        let answer_to = Some(AnswerTo { topic: wanted, correlation: None });
        let said = Said { topic: start.as_bytes(), payload: b"", answer_to };
        assert_eq!(scene.listener(name).hear(start, said, None, false), CommandDecision::Pass);
        let answer = within("an answer", scene.results.recv()).await.unwrap().taken();
        assert_eq!(answer.topic, if is_allowed { wanted } else { &result }, "{name}");
    }
}

/// The doors of a program with the halls `main` and `south`, for clients over TCP.
async fn open() -> (Scene, std::net::SocketAddr) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let (address, scene) = (listener.local_addr().unwrap(), Scene::new());
    let broker = Arc::new(Broker::new(scene.halls.topics().clone()));
    let archive = || ArchiveReader::new(Arc::new(Album));
    for (topics, script) in [(topics(), &scene.main), (scene.topics.clone(), &scene.south)] {
        let answers = mpsc::channel(16).1;
        let session = OwnSession::new(Arc::clone(&broker), topics, true, script.publish.subscribe(), answers, archive());
        tokio::spawn(session.run(std::future::pending()));
    }
    let clients = Clients::new(broker, scene.halls.clone());
    let (access, web_clients) = (Access::Keys(scene.keyring.clone()), mpsc::channel(1).1);
    tokio::spawn(serve(
        clients,
        Ways { listeners: listener.into(), access, web_clients, hearing: Handle::current() },
        std::future::pending(),
    ));
    (scene, address)
}

async fn client(
    scene: &Scene,
    address: std::net::SocketAddr,
    name: &str,
    will: Option<&str>,
) -> (Peer, Option<ConnectReturnCode>) {
    let mut connect = Connect::new(name);
    connect.set_login(name, scene.token(name));
    connect.last_will = will.map(|topic| LastWill::new(topic, "x", QoS::AtLeastOnce, false));
    let mut peer = Peer::come(address).await;
    let greeting = peer.introduces(Packet::Connect(connect)).await;
    (peer, greeting)
}

#[tokio::test]
async fn a_client_of_one_hall_gets_its_topics_and_no_others_by_any_filter() {
    let (scene, address) = open().await;
    for (name, base, id, old) in
        [("only-south", "hallsweep/halls/south", "south", false), ("only-main", "hallsweep/discovery", "discovery", true)]
    {
        let (mut peer, _) = client(&scene, address, name, None).await;
        peer.asks_for(["#", "hallsweep/discovery/#", "hallsweep/halls/south/#", "unibo/qak/+", "homeassistant/device/+/config"])
            .await;
        let own = |state| format!("{base}/state/{state}");
        let wanted = ["robot", "map", "log"].map(own).into_iter().chain([format!("homeassistant/device/{id}/config")]);
        let mut wanted: BTreeSet<String> = wanted.chain(old.then(|| "unibo/qak/events".to_owned())).collect();
        for script in [&scene.main, &scene.south] {
            let mut newer = Snapshot::clone(&script.publish.borrow());
            let next = newer.revision.0 + 1;
            touch(&mut newer, next, &Resource::ALL);
            newer.robot.pose.cell.x += 1;
            script.publish.send_replace(newer.into());
        }
        let mut seen = BTreeSet::new();
        while !wanted.is_empty() {
            let topic = peer.hears_message().await.topic;
            wanted.remove(&topic);
            seen.insert(topic);
        }
        let (mut sender, _) = client(&scene, address, OPERATOR, None).await;
        for topic in ["hallsweep/discovery/command/start", "hallsweep/halls/south/command/start", "open/to/all"] {
            sender.says(Packet::Publish(publish(topic, "", 1))).await;
        }
        loop {
            let topic = peer.hears_message().await.topic;
            seen.insert(topic.clone());
            if topic == "open/to/all" {
                break;
            }
        }
        let is_own = |topic: &String| {
            topic.starts_with(&format!("{base}/")) || topic.contains(&format!("/{id}/")) || topic == "open/to/all"
        };
        assert!(seen.contains(&format!("{base}/command/start")), "its commands can be read: {seen:?}");
        let others: Vec<_> = seen.iter().filter(|topic| !(is_own(topic) || old && topic.starts_with("unibo/qak/"))).collect();
        assert!(others.is_empty(), "{name} has seen {others:?}");
    }
}

/// A will is refused in the same way on a topic of a hall and of no hall, if the client may see neither.
#[tokio::test]
async fn a_will_does_not_tell_which_halls_there_are() {
    let (scene, address) = open().await;
    for name in ["south", "north"] {
        let topic = format!("homeassistant/device/{name}/config");
        let (_, greeting) = client(&scene, address, "only-main", Some(&topic)).await;
        assert_eq!(greeting, Some(ConnectReturnCode::NotAuthorized), "{name}");
    }
    let (_, greeting) = client(&scene, address, "only-main", Some("open/to/all")).await;
    assert_eq!(greeting, Some(ConnectReturnCode::Success));
}
