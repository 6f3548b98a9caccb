//! A client at a broker that subscribes and publishes. It uses rumqttc, as the program does; other clients are tested
//! elsewhere.

use std::cell::RefCell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread::sleep;
use std::time::Duration;

use rumqttc::{Client, Event, MqttOptions, Packet, Publish, QoS};
use serde_json::Value;

use super::broker::{Broker, LOGIN};

/// Longest wait for anything. It is far longer than needed, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Pause between two attempts to connect.
const PAUSE: Duration = Duration::from_millis(20);

/// Maximum packet size in bytes, larger than any message here.
const LARGEST: usize = 4 << 20;

pub(crate) struct TestSubscriber {
    client: Client,
    coming: mpsc::Receiver<Publish>,
    heard: RefCell<Vec<Publish>>,
}

impl TestSubscriber {
    /// Connects, after as many attempts as needed, and subscribes to this filter. The retained messages arrive first.
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
                        // Only the first subscription is awaited.
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

    pub(crate) fn next(&self, wanted: &str) -> Publish {
        let next = self.coming.recv_timeout(PATIENCE);
        next.unwrap_or_else(|error| panic!("never heard: {wanted} ({error})"))
    }

    /// First matching message among all received and future ones: a state may arrive before the result of the command
    /// that caused it.
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

    /// First JSON message on this topic that matches.
    pub(crate) fn json(&self, topic: &str, is_it: impl Fn(&Value) -> bool) -> Value {
        let read = |publish: &Publish| serde_json::from_slice::<Value>(&publish.payload).unwrap_or_default();
        read(&self.until(topic, |publish| publish.topic == topic && is_it(&read(publish))))
    }

    /// Publishes a message.
    pub(crate) fn say(&self, topic: &str, payload: &str) {
        self.client.publish(topic, QoS::AtLeastOnce, false, payload).expect("it is connected");
    }

    /// Publishes a retained message. An empty payload removes the retained message.
    pub(crate) fn keep(&self, topic: &str, payload: &str) {
        self.client.publish(topic, QoS::AtLeastOnce, true, payload).expect("it is connected");
    }
}

impl Drop for TestSubscriber {
    fn drop(&mut self) {
        let _ = self.client.try_disconnect();
    }
}
