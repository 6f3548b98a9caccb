//! One connection to a broker. Each connection uses a new rumqttc client, because after a lost connection rumqttc can
//! stay silent for ever. The messages, and the reaction to the end of a connection, are elsewhere. The protocol
//! versions are in `three` and `five`.

use std::pin::Pin;

use futures_util::stream::{Stream, StreamExt};

use super::super::publication::Publication;
use super::event::Event;
use super::five::Five;
use super::link::SessionLink;
use super::lost::Lost;
use super::three::Three;
use super::times::Times;
use crate::doors::log_throttle::LogThrottle;
use mqtt_gate::packet::Version;

pub(super) struct Transport {
    client: Client,
    events: Pin<Box<dyn Stream<Item = Result<Event, Lost>> + Send>>,
    /// Maximum packet size that the broker accepts, in bytes. `None` if the broker names no maximum.
    largest: Option<u32>,
    left_out: LogThrottle,
}

enum Client {
    Three(Three),
    Five(Five),
}

impl Transport {
    /// Prepares a connection. The connection is made when the first event is awaited.
    pub(super) fn new(link: &SessionLink, will: Publication, times: &Times) -> Transport {
        let (client, events): (_, Pin<Box<dyn Stream<Item = _> + Send>>) = match link.version {
            Version::Three => {
                let (client, events) = Three::begin(link, will, times);
                (Client::Three(client), Box::pin(events))
            }
            Version::Five => {
                let (client, events) = Five::begin(link, will, times);
                (Client::Five(client), Box::pin(events))
            }
        };
        Transport { client, events, largest: None, left_out: LogThrottle::default() }
    }

    /// Waits for the next event. Safe to cancel.
    ///
    /// # Errors
    /// When the connection has ended. After an error, do not call this again.
    pub(super) async fn next(&mut self) -> Result<Event, Lost> {
        let Some(event) = self.events.next().await else { return Err(Lost::Broken("the connection has ended".to_owned())) };
        let event = event?;
        if let Event::Greeted { largest, .. } = event {
            self.largest = largest;
        }
        Ok(event)
    }

    pub(super) fn subscribe(&self, filters: Vec<String>, kept: Vec<String>) -> bool {
        match &self.client {
            Client::Three(client) => client.subscribe(filters, kept),
            Client::Five(client) => client.subscribe(filters, kept),
        }
    }

    /// Passes a message to the MQTT client library. Returns false when the message is too large for the broker, or
    /// when the library has no room. Such a message is logged and lost.
    pub(super) fn publish(&self, publication: &Publication) -> bool {
        let fits = publication.fits(self.largest);
        let is_given = fits
            && match &self.client {
                Client::Three(client) => client.publish(publication),
                Client::Five(client) => client.publish(publication),
            };
        if !is_given && let Some(left_out) = self.left_out.one_more() {
            let (topic, largest) = (&publication.topic, self.largest);
            let why = if fits { "there is no room for them" } else { "they are too large for the broker" };
            tracing::warn!(topic, largest, left_out, "messages were not published, because {why}; the latest is on this topic");
        }
        is_given
    }

    /// Disconnects, so that the broker does not publish our last will.
    pub(super) fn hang_up(&self) -> bool {
        match &self.client {
            Client::Three(client) => client.hang_up(),
            Client::Five(client) => client.hang_up(),
        }
    }
}
