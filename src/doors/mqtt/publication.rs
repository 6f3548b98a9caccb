//! An outgoing message, ready to be published. Sending it to a broker is not here.

use std::sync::Arc;

use bytes::Bytes;

use mqtt_gate::packet::properties::Property;

/// Maximum size of a sent or received message in bytes: a photo and some room. rumqttc's default is 10 KiB, with
/// which the first map would end the connection.
pub(super) const LARGEST: usize = 2 << 20;

/// Maximum size of a publication's headers in bytes, not counting its topic and properties.
const HEADERS: usize = 16;

/// Content type of the payloads that are marked as JSON.
const JSON: &str = "application/json";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Publication {
    pub topic: String,
    pub payload: Bytes,
    pub retain: bool,
    pub beside: Beside,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Beside {
    pub is_json: bool,
    pub revision: Option<u64>,
    pub by: Option<Arc<str>>,
    pub correlation: Option<Bytes>,
}

/// Maximum size of a property in bytes, not counting its value.
const PROPERTY: usize = 16;

impl Beside {
    /// Maximum size of the properties in bytes.
    fn length(&self) -> usize {
        let said = self.correlation.as_ref().map_or(0, Bytes::len) + self.by.as_ref().map_or(0, |by| by.len());
        let json = if self.is_json { 2 * PROPERTY + JSON.len() } else { 0 };
        let notes = usize::from(self.correlation.is_some()) + usize::from(self.by.is_some());
        notes * PROPERTY + said + json + self.revision.map_or(0, |_| PROPERTY + 20)
    }

    pub(super) fn with_properties<T>(&self, take: impl FnOnce(&[Property<'_>]) -> T) -> T {
        let revision = self.revision.map(|revision| revision.to_string());
        let json = self.is_json.then_some([Property::PayloadFormat(1), Property::ContentType(JSON)]);
        let notes = [
            self.correlation.as_deref().map(Property::CorrelationData),
            self.by.as_deref().map(|by| Property::User("by", by)),
            revision.as_deref().map(|revision| Property::User("revision", revision)),
        ];
        take(&json.into_iter().flatten().chain(notes.into_iter().flatten()).collect::<Vec<_>>())
    }
}

impl Publication {
    /// Creates a publication of a state. The broker retains it, so that a new subscriber gets the state at once.
    pub fn kept(topic: String, payload: impl Into<Bytes>) -> Publication {
        Publication { topic, payload: payload.into(), retain: true, beside: Beside::default() }
    }

    /// Creates a publication of an event. Only clients that are subscribed already get it.
    pub fn passing(topic: String, payload: impl Into<Bytes>) -> Publication {
        Publication { topic, payload: payload.into(), retain: false, beside: Beside::default() }
    }

    pub(super) fn json_of(self, revision: u64) -> Publication {
        Publication { beside: Beside { is_json: true, revision: Some(revision), ..Beside::default() }, ..self }
    }

    /// Whether this publication fits into a packet of at most `largest` bytes, the broker's maximum. Without this
    /// check, a packet that is too large would end every new connection.
    pub(super) fn fits(&self, largest: Option<u32>) -> bool {
        let size = self.topic.len() + self.payload.len() + HEADERS + self.beside.length();
        size <= largest.map_or(LARGEST, |largest| LARGEST.min(largest as usize))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_fits_a_broker_that_takes_packets_of_its_length() {
        let (topic, payload) = ("a".repeat(100), "x".repeat(1000));
        let plain = Publication::passing(topic.clone(), payload.clone());
        let told =
            Beside { is_json: true, revision: Some(u64::MAX), by: Some(Arc::from("panel")), correlation: Some(Bytes::from("7")) };
        let told = Publication { beside: told, ..plain.clone() };
        assert!(plain.fits(Some(1120)) && !plain.fits(Some(1100)) && plain.fits(None));
        assert!(told.fits(Some(1270)) && !told.fits(Some(1200)), "what stands beside it counts");
        assert!(Publication::kept("hallsweep/discovery/availability".into(), "offline").fits(Some(60)));
        assert!(!Publication::passing(topic, "x".repeat(LARGEST)).fits(Some(u32::MAX)));
    }
}
