//! Retained messages of clients: all of them reach a later client, however many there are, and they can be removed.

use super::client::Client;
use super::running::RunningClient;
use super::told::{Hello, Say};
use super::with_each;
use crate::program::Program;

/// Number of topics, many times more than the router and the clients process at once.
const TOPICS: usize = 5_000;

fn topic(number: usize) -> String {
    format!("site/shelf/{}/{number:04}", number % 7)
}

#[test]
fn five_thousand_kept_messages_reach_a_newcomer() {
    // Mosquitto's command publishes one message at a time, which is too slow here.
    let Some(client) = [Client::Paho, Client::MqttJs].into_iter().find(|client| client.is_here()) else { return };
    let program = Program::serve("empty-8x8", "max");
    let mut writer = RunningClient::begin(client, &program, Hello::speaking());
    let topics: Vec<String> = (0..TOPICS).map(topic).collect();
    let all: Vec<Say> = topics.iter().map(|topic| Say::plain(topic, topic).at(1).kept()).collect();
    writer.say_all(&all);
    with_each(|client| {
        for qos in [0, 1] {
            let reader = RunningClient::begin(client, &program, Hello::following(&["site/shelf/#"], qos));
            let heard = reader.until("all of them", |heard| (heard.len() >= TOPICS).then(|| heard.to_vec()));
            let mut seen: Vec<&str> = heard.iter().map(|message| message.topic.as_str()).collect();
            seen.sort_unstable();
            seen.dedup();
            assert_eq!(seen.len(), TOPICS, "each once");
            let fits = heard.iter().all(|it| it.kept && it.payload == it.topic && it.qos == u64::from(qos));
            assert!(fits && heard.len() == TOPICS, "{client:?} at QoS {qos}");
            reader.leave();
        }
    });
    let empty: Vec<Say> = topics[1..].iter().map(|topic| Say::plain(topic, "").at(1).kept()).collect();
    writer.say_all(&empty);
    writer.say(Say::plain("site/shelf/last", "last").at(1).kept());
    with_each(|client| {
        let reader = RunningClient::begin(client, &program, Hello::following(&["site/shelf/#"], 1));
        reader.until_newest("site/shelf/last", "there", |message| message.kept);
        let left: Vec<String> = reader.heard().into_iter().map(|message| message.topic).collect();
        assert_eq!(left, [topics[0].as_str(), "site/shelf/last"], "{client:?}");
        reader.leave();
    });
    writer.leave();
}
