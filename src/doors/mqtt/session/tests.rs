//! Tests of the session with a broker that does what the test says.

use std::time::Duration;

use rumqttc::{ConnectReturnCode, Packet, PubAck};

use super::super::topics::HOME_ASSISTANT_STATUS;
use super::Times;
use super::testing::{TestApp, TestBroker, hall, map, publish, topics};
use crate::api::tests::fixture::{idle, searching, touch};
use hallsweep_core::command::Command;
use hallsweep_core::world::resource::Resource;

/// A time limit that the test reaches at once.
const SHORT: Duration = Duration::from_millis(50);

fn others(broker: &TestBroker) -> TestApp {
    TestApp::run(idle(), broker.address(), Times::default())
}

#[tokio::test]
async fn whoever_greets_us_is_told_everything_and_again_on_the_next_connection() {
    let broker = TestBroker::open().await;
    let app = others(&broker);
    for revision in 2..4 {
        let (mut peer, connect, filters) = broker.principal().await;
        assert_eq!((connect.client_id.as_str(), connect.clean_session), ("hallsweep-discovery", true));
        let will = connect.last_will.expect("a broker says that we are gone");
        assert_eq!((will.topic, &will.message[..], will.retain), (topics().availability(), &b"offline"[..], true));
        assert!(filters.contains(&topics().command("+")) && filters.contains(&HOME_ASSISTANT_STATUS.to_owned()), "{filters:?}");
        let online = peer.until(&topics().availability()).await;
        assert_eq!((&online.payload[..], online.retain), (&b"online"[..], true));
        for resource in Resource::ALL {
            assert!(peer.until(&topics().state(resource)).await.retain);
        }
        drop(peer);
        let mut newer = idle();
        touch(&mut newer, revision, &Resource::ALL);
        app.script.publish.send_replace(newer.into());
    }
}

#[tokio::test]
async fn a_command_is_heard_once_and_what_was_kept_or_comes_again_is_not() {
    let broker = TestBroker::open().await;
    let app = others(&broker);
    let (mut peer, ..) = broker.principal().await;
    let mut kept = publish(&topics().command("backHome"), "", 4);
    kept.retain = true;
    let (start, mut again) = (publish(&topics().command("start"), "", 5), publish(&topics().command("start"), "", 5));
    again.dup = true;
    let mut late = publish(&topics().command("reset"), "", 6);
    late.dup = true;
    for said in [kept, start, again, late] {
        peer.says(Packet::Publish(said)).await;
    }
    let result = peer.until(&topics().result("reset")).await;
    assert!(!result.retain && String::from_utf8_lossy(&result.payload).contains("\"accepted\":true"), "{:?}", result.payload);
    let given: Vec<_> = app.script.given.lock().unwrap().iter().map(|request| request.command.clone()).collect();
    assert_eq!(given, [Command::Start, Command::Reset]);
}

/// Safety S1.
#[tokio::test]
async fn a_stop_is_taken_as_often_as_it_comes() {
    let broker = TestBroker::open().await;
    let app = others(&broker);
    let (mut peer, ..) = broker.principal().await;
    let stop = publish("unibo/qak/events", "msg(stopCmd,event,js,none,stopCmd,1)", 5);
    let again = rumqttc::Publish { dup: true, ..stop.clone() };
    for said in [stop, again, publish(&topics().command("reset"), "", 6)] {
        peer.says(Packet::Publish(said)).await;
    }
    peer.until(&topics().result("reset")).await;
    let given: Vec<_> = app.script.given.lock().unwrap().iter().map(|request| request.command.clone()).collect();
    assert_eq!(given, [Command::Stop, Command::Stop, Command::Reset]);
}

#[tokio::test]
async fn an_answer_that_may_not_have_arrived_is_said_again_and_old_messages_keep_their_numbers() {
    let broker = TestBroker::open().await;
    let _app = others(&broker);
    let (mut peer, ..) = broker.principal().await;
    let old = |said: &rumqttc::Publish| said.topic == topics().old_events();
    let first = peer.unacknowledged(old).await;
    peer.says(Packet::Publish(publish(&topics().command("start"), r#"{"id":"a"}"#, 1))).await;
    let answer = peer.unacknowledged(|said| said.topic == topics().result("start")).await;
    drop(peer);
    let (mut peer, ..) = broker.principal().await;
    let (mut answered, mut numbered) = (false, None);
    while !answered || numbered.is_none() {
        let said = peer.unacknowledged(|_| true).await;
        peer.says(Packet::PubAck(PubAck::new(said.pkid))).await;
        answered |= (said.topic == answer.topic) && said.payload == answer.payload;
        numbered = numbered.or_else(|| old(&said).then(|| number(&said.payload)));
    }
    assert_eq!((number(&first.payload), numbered), (1, Some(1)), "it was never acknowledged");
}

fn number(message: &[u8]) -> u64 {
    let text = String::from_utf8_lossy(message);
    text.trim_end_matches(')').rsplit(',').next().and_then(|number| number.trim().parse().ok()).expect("it is numbered")
}

#[tokio::test]
async fn a_broker_that_does_not_greet_us_is_tried_again() {
    let broker = TestBroker::open().await;
    let times = Times { greeting: SHORT, ..Times::default() };
    let _app = TestApp::run(idle(), broker.address(), times);
    let mut mute = broker.peer().await;
    mute.is_left().await;
    let mut half = broker.peer().await;
    half.answers(ConnectReturnCode::Success).await;
    half.is_left().await;
    drop(broker.peer().await);
}

#[tokio::test]
async fn a_broker_that_acknowledges_nothing_is_left_for_a_new_connection() {
    let broker = TestBroker::open().await;
    let times = Times { acknowledgement: SHORT, ..Times::default() };
    let _app = TestApp::run(idle(), broker.address(), times);
    let (mut mute, ..) = broker.principal().await;
    mute.is_left().await;
    let (mut peer, ..) = broker.principal().await;
    peer.until(&topics().availability()).await;
}

#[tokio::test]
async fn at_the_end_it_is_said_that_we_are_gone() {
    let broker = TestBroker::open().await;
    let mut app = others(&broker);
    let (mut peer, ..) = broker.principal().await;
    peer.until(&topics().availability()).await;
    app.shut_down();
    let mut last = peer.until(&topics().availability()).await;
    while &last.payload[..] != b"offline" {
        last = peer.until(&topics().availability()).await;
    }
    assert!(last.retain);
    assert!(matches!(peer.hears().await, Some(Packet::Disconnect)), "else the broker would say our last will");
    app.ended().await;
}

#[tokio::test]
async fn the_end_does_not_wait_for_a_broker_that_is_not_there() {
    let broker = TestBroker::open().await;
    let mut app = others(&broker);
    let (mut peer, ..) = broker.principal().await;
    peer.unacknowledged(|_| true).await;
    app.shut_down();
    app.ended().await;
    drop((broker, peer));
}

#[tokio::test]
async fn home_assistant_is_shown_the_last_photo_and_told_of_the_robot_when_it_starts() {
    let broker = TestBroker::open().await;
    let _app = TestApp::run(searching(), broker.address(), Times::default());
    let (mut peer, ..) = broker.principal().await;
    let photo = peer.until(&topics().photo()).await;
    assert_eq!((&photo.payload[..], photo.retain), (&b"\x89PNG"[..], true));
    peer.says(Packet::Publish(publish(HOME_ASSISTANT_STATUS, "online", 1))).await;
    assert!(peer.until(&topics().discovery()).await.retain);
}

#[tokio::test]
async fn a_further_hall_publishes_and_obeys_under_its_own_topics() {
    let broker = TestBroker::open().await;
    let topics = map(&[]).add(&hall("south"));
    let app = TestApp::run_for(topics.clone(), idle(), broker.address(), Times::default());
    let (mut peer, connect, filters) = broker.principal().await;
    assert_eq!(connect.last_will.map(|will| will.topic), Some("hallsweep/halls/south/availability".to_owned()));
    let all = ["hallsweep/halls/south/command", "hallsweep/halls/south/command/+", HOME_ASSISTANT_STATUS];
    assert_eq!(filters[..3], all, "and nothing of the old topics");
    peer.until(&topics.discovery()).await;
    peer.says(Packet::Publish(publish(&topics.command("stop"), "", 7))).await;
    peer.until(&topics.result("stop")).await;
    assert_eq!(app.script.given.lock().unwrap().len(), 1);
}
