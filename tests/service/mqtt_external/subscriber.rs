//! Somebody at a broker who listens and speaks, by rumqttc as well: that other clients understand the same is tested elsewhere.

use std::cell::RefCell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread::sleep;
use std::time::Duration;

use rumqttc::{Client, Event, MqttOptions, Packet, Publish, QoS};
use serde_json::Value;

use super::broker::{Broker, LOGIN};

/// How long anything is waited for: far longer than it takes, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Between two attempts to connect.
const PAUSE: Duration = Duration::from_millis(20);

/// Larger than any message here.
const LARGEST: usize = 4 << 20;

/// Somebody who listens.
pub(crate) struct TestSubscriber {
    client: Client,
    coming: mpsc::Receiver<Publish>,
    heard: RefCell<Vec<Publish>>,
}

impl TestSubscriber {
    /// Connects, as often as it takes, and listens to this filter from then on: first what the broker has kept, then what is said.
    pub(crate) fn at(broker: &Broker, filter: &str) -> TestSubscriber {
        static SUBSCRIBERS: AtomicUsize = AtomicUsize::new(0);
        let name = format!("subscriber-{}", SUBSCRIBERS.fetch_add(1, Ordering::Relaxed));
        let mut options = MqttOptions::new(name, "127.0.0.1", broker.port());
        options.set_credentials(LOGIN.0, LOGIN.1).set_max_packet_size(LARGEST, LARGEST);
        let (client, mut connection) = Client::new(options, 100);
        let (tell, coming) = mpsc::channel();
        let (begin, begun) = mpsc::channel();
        let (speaker, filter) = (client.clone(), filter.to_owned());
        std::thread::spawn(move || {
            for event in connection.iter() {
                let is_over = match event {
                    Ok(Event::Incoming(Packet::ConnAck(_))) => speaker.try_subscribe(&filter, QoS::AtLeastOnce).is_err(),
                    Ok(Event::Incoming(Packet::SubAck(_))) => {
                        // Nobody waits for it a second time.
                        let _ = begin.send(());
                        false
                    }
                    Ok(Event::Incoming(Packet::Publish(publish))) => tell.send(publish).is_err(),
                    Ok(Event::Incoming(_) | Event::Outgoing(_)) => false,
                    Err(_) => {
                        sleep(PAUSE);
                        false
                    }
                };
                if is_over {
                    return;
                }
            }
        });
        begun.recv_timeout(PATIENCE).expect("the broker takes a subscription");
        TestSubscriber { client, coming, heard: RefCell::default() }
    }

    /// The next message.
    pub(crate) fn next(&self, wanted: &str) -> Publish {
        let next = self.coming.recv_timeout(PATIENCE);
        next.unwrap_or_else(|error| panic!("never heard: {wanted} ({error})"))
    }

    /// The first message like this, of all that were heard and are to come: a state may be told before the result of the command
    /// that led to it.
    pub(crate) fn until(&self, wanted: &str, is_it: impl Fn(&Publish) -> bool) -> Publish {
        let mut heard = self.heard.borrow_mut();
        let mut place = 0;
        loop {
            if place == heard.len() {
                heard.push(self.next(wanted));
            }
            if is_it(&heard[place]) {
                return heard[place].clone();
            }
            place += 1;
        }
    }

    /// The first JSON on this topic that is like this.
    pub(crate) fn json(&self, topic: &str, is_it: impl Fn(&Value) -> bool) -> Value {
        let read = |publish: &Publish| serde_json::from_slice::<Value>(&publish.payload).unwrap_or_default();
        read(&self.until(topic, |publish| publish.topic == topic && is_it(&read(publish))))
    }

    /// Says something.
    pub(crate) fn say(&self, topic: &str, payload: &str) {
        self.client.publish(topic, QoS::AtLeastOnce, false, payload).expect("it is connected");
    }

    /// Says something that the broker is to keep; nothing: that it is to keep nothing.
    pub(crate) fn keep(&self, topic: &str, payload: &str) {
        self.client.publish(topic, QoS::AtLeastOnce, true, payload).expect("it is connected");
    }
}

impl Drop for TestSubscriber {
    fn drop(&mut self) {
        let _ = self.client.try_disconnect();
    }
}
