//! One connection to a broker, made anew each time: rumqttc can stay mute for ever after a lost one. What is said on it and what
//! follows from its end are not here.

use std::pin::Pin;

use futures_util::stream::{self, Stream, StreamExt};
use rumqttc::{AsyncClient, ConnectionError, Event, MqttOptions, NetworkOptions, QoS, SubscribeFilter};

use super::super::publication::Publication;
use super::link::IN_FLIGHT;
use super::lost::Lost;
use super::times::Times;

/// Beside what is in flight, room for a subscription, a beat and two last words.
const BESIDE: usize = 8;

pub(super) struct Transport {
    client: AsyncClient,
    /// rumqttc's own loop must not be dropped halfway, or it forgets what it was about to write; so it lives here between looks.
    events: Pin<Box<dyn Stream<Item = Result<Event, ConnectionError>> + Send>>,
}

impl Transport {
    /// Nothing is connected before the first event is waited for.
    pub(super) fn new(options: MqttOptions, times: &Times) -> Transport {
        let (client, mut events) = AsyncClient::new(options, IN_FLIGHT + BESIDE);
        let mut network = NetworkOptions::new();
        network.set_tcp_nodelay(true);
        // Its own bounds lie above ours.
        network.set_connection_timeout((times.greeting * 2).as_secs().max(1));
        events.set_network_options(network);
        let events = stream::unfold(events, async |mut events| Some((events.poll().await, events)));
        Transport { client, events: Box::pin(events) }
    }

    /// What happens next. May be dropped while it waits.
    ///
    /// # Errors
    /// When the connection has ended; there is no use in asking again.
    pub(super) async fn next(&mut self) -> Result<Event, Lost> {
        match self.events.next().await {
            Some(event) => Ok(event?),
            None => Err(Lost::Broken("the connection has ended".to_owned())),
        }
    }

    pub(super) fn subscribe(&self, filters: Vec<String>) -> bool {
        let filters = filters.into_iter().map(|path| SubscribeFilter { path, qos: QoS::AtLeastOnce });
        self.client.try_subscribe_many(filters).is_ok()
    }

    /// Whether this goes out.
    pub(super) fn publish(&self, publication: &Publication) -> bool {
        if !publication.fits() {
            return false;
        }
        let (topic, payload) = (publication.topic.as_str(), Vec::from(publication.payload.clone()));
        let given = self.client.try_publish(topic, QoS::AtLeastOnce, publication.retain, payload);
        if given.is_err() {
            tracing::warn!(topic, "a message is not published, because there is no room for it");
        }
        given.is_ok()
    }

    /// Takes leave, so that the broker does not speak our last will.
    pub(super) fn hang_up(&self) -> bool {
        self.client.try_disconnect().is_ok()
    }
}
