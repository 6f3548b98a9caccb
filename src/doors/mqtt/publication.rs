//! One message that goes out, ready to be published. How it gets to a broker is not here.

use std::sync::Arc;

use bytes::Bytes;

use mqtt_gate::packet::properties::Property;

/// No message is larger, in either direction: a photo with some room. At rumqttc's own 10 KiB the first map ends a connection.
pub(super) const LARGEST: usize = 2 << 20;

/// A publication's headers are never longer than this, its topic and what stands beside it aside.
const HEADERS: usize = 16;

/// What everything of ours is that is neither a photo nor a word.
const JSON: &str = "application/json";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Publication {
    pub topic: String,
    pub payload: Bytes,
    /// Whether a broker keeps it for whoever subscribes later.
    pub retain: bool,
    /// What those of MQTT 5 are told beside it.
    pub beside: Beside,
}

/// What those of MQTT 5 are told beside a message.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Beside {
    /// Whether it is JSON.
    pub is_json: bool,
    /// Of which revision of our state it tells.
    pub revision: Option<u64>,
    /// Who has commanded what it answers,
    pub by: Option<Arc<str>>,
    /// and by what he knows the answer.
    pub correlation: Option<Bytes>,
}

/// Each property has so many bytes beside what it says, or fewer.
const PROPERTY: usize = 16;

impl Beside {
    /// How many bytes that takes, at the most.
    fn length(&self) -> usize {
        let said = self.correlation.as_ref().map_or(0, Bytes::len) + self.by.as_ref().map_or(0, |by| by.len());
        let json = if self.is_json { 2 * PROPERTY + JSON.len() } else { 0 };
        let notes = usize::from(self.correlation.is_some()) + usize::from(self.by.is_some());
        notes * PROPERTY + said + json + self.revision.map_or(0, |_| PROPERTY + 20)
    }

    /// The same as properties of MQTT 5.
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
    /// The state of something: kept by the broker, so that a newcomer sees it at once.
    pub fn kept(topic: String, payload: impl Into<Bytes>) -> Publication {
        Publication { topic, payload: payload.into(), retain: true, beside: Beside::default() }
    }

    /// Something that happened: for those who listen now.
    pub fn passing(topic: String, payload: impl Into<Bytes>) -> Publication {
        Publication { topic, payload: payload.into(), retain: false, beside: Beside::default() }
    }

    /// It is JSON, and tells of this revision of our state.
    pub(super) fn json_of(self, revision: u64) -> Publication {
        Publication { beside: Beside { is_json: true, revision: Some(revision), ..Beside::default() }, ..self }
    }

    /// Whether a broker takes it, that takes no longer packets than `largest`, in bytes: sent to one that does not, it would end every
    /// connection anew.
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
