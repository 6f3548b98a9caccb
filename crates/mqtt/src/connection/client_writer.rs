//! Writes packets for one client: in its version of MQTT, no longer than it accepts, and with topic aliases if it
//! accepts aliases.

use std::sync::Arc;
use std::time::Duration;

use crate::frame::PacketKind;
use crate::limits::{ALIASES, SHARED, WITH_WORDS};
use crate::outbox::Outbox;
use crate::packet::connect::Reception;
use crate::packet::reason::Reason;
use crate::packet::{Version, write};
use crate::rights::Scope;
use crate::subscriber::Delivery;

#[derive(Debug, Default)]
pub(super) struct ClientWriter {
    version: Version,
    reception: Reception,
    /// Topics that have an alias. The alias of a topic is its index plus 1.
    aliases: Vec<Arc<str>>,
    scope: Scope,
}

impl ClientWriter {
    pub(super) const fn new(version: Version, reception: Reception, scope: Scope) -> ClientWriter {
        ClientWriter { version, reception, aliases: Vec::new(), scope }
    }

    /// Whether the client may receive messages on this topic.
    pub(super) fn may_write(&self, topic: &str) -> bool {
        self.scope.contains(topic)
    }

    pub(super) const fn version(&self) -> Version {
        self.version
    }

    /// Writes a PUBLISH with its id and its DUP flag. Returns false when it is longer than the client accepts.
    pub(super) fn publish(&mut self, delivery: &Delivery, id: u16, is_duplicate: bool, now: Duration, out: &mut Outbox) -> bool {
        let Delivery { message, qos, retain, ids } = delivery;
        let (topic, payload) = (message.topic().as_bytes(), message.payload());
        let mut head = write::PublishHead { topic, qos: *qos, id, retain: *retain, is_duplicate, properties: None };
        if self.version == Version::Five {
            let known = self.aliases.iter().position(|known| **known == *message.topic());
            let is_new = known.is_none() && self.aliases.len() < usize::from(ALIASES.min(self.reception.aliases));
            let alias = known.or_else(|| is_new.then_some(self.aliases.len()));
            head.properties = Some(write::PublishProperties {
                expiry_s: message.good_for_s(now),
                alias: alias.map(|place| place as u16 + 1),
                ids: ids.as_deref().unwrap_or_default(),
                others: message.properties(),
            });
            if known.is_some() {
                head.topic = &[];
            }
            if head.length(payload.len()) > self.reception.largest as usize {
                return false;
            }
            if is_new {
                self.aliases.push(message.shared_topic());
            }
        }
        if payload.len() < SHARED {
            head.with(out.end(), payload);
        } else {
            head.before(out.end(), payload.len());
            out.share(message.shared_payload());
        }
        true
    }

    /// Writes a PUBACK, PUBREC, PUBREL or PUBCOMP. The reason code is left out in MQTT 3.1.1, which has none. It is
    /// also left out for a success without a reason in words.
    pub(super) fn ack(&self, kind: PacketKind, id: u16, reason: Reason, words: &str, out: &mut Outbox) {
        if self.version == Version::Three || reason == Reason::Success && words.is_empty() {
            return write::ack(out.end(), kind, id);
        }
        write::ack_with(out.end(), kind, id, reason, self.words(words));
    }

    pub(super) fn disconnect(&self, reason: Reason, words: &str, out: &mut Outbox) {
        if self.version == Version::Five {
            write::disconnect(out.end(), reason, self.words(words));
        }
    }

    /// Returns the reason in words if the client asked for such reasons and accepts packets of that length; otherwise
    /// `None`.
    pub(super) fn words<'a>(&self, words: &'a str) -> Option<&'a str> {
        let is_wanted = self.reception.wants_words && self.reception.largest > WITH_WORDS;
        (is_wanted && !words.is_empty()).then_some(words)
    }
}
