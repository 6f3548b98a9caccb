//! Handles a client's PUBLISH packets, its will, and its acknowledgements. `routes` decides where a message goes.

use std::sync::Arc;
use std::time::Duration;

use super::routes::{Dropped, Route};
use super::{AnswerTo, ClientConnection, CommandDecision, Ended, Mark, Said};
use crate::filter;
use crate::frame::{Frame, Malformed, PacketKind};
use crate::limits::{ALIASES, PROPERTIES, TOPIC};
use crate::message::Draft;
use crate::packet::connect::Will;
use crate::packet::properties::{Properties, Property, that_go_on};
use crate::packet::publish::{self, Publish};
use crate::packet::reason::Reason;
use crate::packet::{Qos, Version, text};
use crate::rights::Tier;

/// What became of a message: a reason code and a text, for a sender that uses MQTT 5.
#[derive(Clone, Debug)]
struct Told {
    reason: Reason,
    words: String,
}

const TAKEN: Told = Told { reason: Reason::Success, words: String::new() };

const NOT_KEPT: &str = "the message was delivered but not retained, because there are too many retained messages";

impl ClientConnection {
    /// Handles a PUBLISH; `packet` is the whole packet. An acknowledgement is sent even if the message is dropped
    /// (section 3.3.5). In MQTT 5 the acknowledgement says what became of the message.
    pub(super) fn publish(&mut self, frame: &Frame, packet: &[u8]) -> Result<(), Ended> {
        let publish = publish::read(frame, packet, self.writer.version())?;
        let named = self.named(publish)?;
        let publish = Publish { topic: named.as_deref().unwrap_or(publish.topic), ..publish };
        let told = match self.routes.route(publish.topic, self.tier, &self.scope, &self.broker)? {
            Route::Hear => self.hear(&publish)?,
            Route::Drop(why) => self.drop(&publish, why)?,
            Route::Pass if publish.properties.bytes().len() > PROPERTIES => self.drop(&publish, Dropped::Properties)?,
            Route::Pass => self.pass(&publish)?,
        };
        let kind = match publish.qos {
            Qos::Zero => return Ok(()),
            Qos::One => PacketKind::Puback,
            Qos::Two => PacketKind::Pubrec,
        };
        self.writer.ack(kind, publish.id, told.reason, &told.words, &mut self.to_client);
        Ok(())
    }

    /// Returns the topic that the packet's topic alias stands for (MQTT 5, section 3.3.2.3.4); `None` if the packet
    /// itself names its topic.
    fn named(&mut self, mut publish: Publish<'_>) -> Result<Option<Arc<[u8]>>, Malformed> {
        // A message with larger properties is refused, so it sets no alias.
        let is_taken = publish.properties.bytes().len() <= PROPERTIES;
        let alias =
            publish.properties.find_map(|property| if let Property::TopicAlias(alias) = property { Some(alias) } else { None });
        let alias = alias.filter(|_| is_taken);
        match (alias, publish.topic.is_empty()) {
            (Some(alias), _) if !(1..=ALIASES).contains(&alias) => Err(Malformed::Alias(alias)),
            (Some(alias), true) => self.aliases.get(&alias).map(Arc::clone).map(Some).ok_or(Malformed::NoTopic),
            (Some(alias), false) => {
                self.aliases.remove(&alias);
                // A longer topic is refused, so it is not stored either.
                if publish.topic.len() <= TOPIC {
                    self.aliases.insert(alias, publish.topic.into());
                }
                Ok(None)
            }
            (None, true) if self.writer.version() == Version::Five => Err(Malformed::NoTopic),
            (None, _) => Ok(None),
        }
    }

    pub(super) fn released(&mut self, id: u16) {
        let reason = if self.duplicates.released(id) { Reason::Success } else { Reason::UnknownId };
        self.writer.ack(PacketKind::Pubcomp, id, reason, "", &mut self.to_client);
    }

    /// Whether this will may be published on its topic. A refusal is logged.
    pub(super) fn may_publish(&mut self, will: &Will) -> bool {
        let route = self.routes.route(will.topic.as_bytes(), self.tier, &self.scope, &self.broker);
        let is_allowed = self.broker.rights.may_leave_will(self.tier, &will.topic) && route == Ok(Route::Pass);
        if !is_allowed {
            self.refusals.note(will.topic.as_bytes(), "this will is not allowed", &self.broker.lines, self.now);
        }
        is_allowed
    }

    fn pass(&mut self, publish: &Publish<'_>) -> Result<Told, Ended> {
        if self.duplicates.is_unreleased(publish) {
            return Ok(TAKEN);
        }
        self.duplicates.handled(publish, None)?;
        Ok(self.forward(publish, publish.retain))
    }

    /// Passes a message on to the readers of the topic that was routed last. If `retain` is set, the message is
    /// retained before it is sent, so that a client that subscribes in between gets it.
    fn forward(&mut self, publish: &Publish<'_>, retain: bool) -> Told {
        let publisher = self.subscription.subscriber().id();
        let is_read = self.routes.is_read(publisher, &self.broker);
        let reason = if is_read { Reason::Success } else { Reason::NoSubscribers };
        if !retain && !is_read {
            return Told { reason, ..TAKEN };
        }
        let mut expires_at = None;
        for property in publish.properties {
            if let Property::MessageExpiry(seconds) = property {
                expires_at = Some(self.now + Duration::from_secs(u64::from(seconds)));
            }
        }
        let properties = that_go_on(publish.properties);
        let topic = self.routes.topic();
        let (payload, qos) = (publish.payload, publish.qos);
        let draft = Draft { topic, payload, qos, retain, properties: &properties, expires_at, publisher: Some(publisher) };
        let message = self.broker.message(draft);
        let is_kept = !retain || self.broker.retained.keep(&self.payer, &message, self.now);
        self.routes.send(&message, publisher, &self.broker);
        if is_kept {
            return Told { reason, ..TAKEN };
        }
        self.refusals.note(message.topic().as_bytes(), NOT_KEPT, &self.broker.lines, self.now);
        Told { reason, words: NOT_KEPT.to_owned() }
    }

    /// Passes a message on a topic of commands to the listener. Checks that could fail for lack of room come later,
    /// so an urgent command always takes effect.
    fn hear(&mut self, publish: &Publish<'_>) -> Result<Told, Ended> {
        let topic = text(publish.topic, "topic")?;
        let print = self.broker.print((publish.topic, publish.payload));
        let said = Said { topic: publish.topic, payload: publish.payload, answer_to: answer_to(publish) };
        let is_urgent = self.heard_ahead() || self.listener.hear_urgent(said);
        if !is_urgent && self.duplicates.was_heard(publish, print) {
            return Ok(TAKEN);
        }
        let heard =
            if is_urgent { CommandDecision::Pass } else { self.listener.hear(topic, said, self.arrived, publish.is_duplicate) };
        let is_unreleased = self.duplicates.is_unreleased(publish);
        if !self.need_not_be_released(publish, heard == CommandDecision::Forbidden) {
            self.duplicates.handled(publish, Some(print))?;
        }
        let refused = match heard {
            CommandDecision::Forbidden => Some(Dropped::Forbidden),
            CommandDecision::Keep => None,
            CommandDecision::Pass if is_unreleased => None,
            CommandDecision::Pass => self.pass_on(publish, topic).err(),
        };
        let told = refused.filter(|_| heard == CommandDecision::Forbidden).map_or(TAKEN, Dropped::told);
        refused.into_iter().for_each(|why| self.refusals.note(publish.topic, why, &self.broker.lines, self.now));
        Ok(told)
    }

    /// Passes a command on to its readers. A failure does not affect the command itself, which the listener already
    /// has.
    fn pass_on(&mut self, publish: &Publish<'_>, topic: &str) -> Result<(), Dropped> {
        filter::topic(topic).map_err(Dropped::Unfit)?;
        if publish.properties.bytes().len() > PROPERTIES {
            return Err(Dropped::Properties);
        }
        // Only commands of `Tier::Full` keep their properties: the commands of other clients need none.
        let properties = if self.tier == Tier::Full { publish.properties } else { Properties::default() };
        self.forward(&Publish { properties, ..*publish }, false);
        Ok(())
    }

    /// Returns whether the listener acted on this packet on arrival, so that it does not get the packet again. Notes
    /// the packet's epoch.
    fn heard_ahead(&mut self) -> bool {
        let mut heard_ahead = false;
        while let Some(mark) = self.next_mark(|begins, taken| begins <= taken) {
            heard_ahead = mark.heard_ahead && mark.begins == self.taken;
        }
        heard_ahead
    }

    /// Removes and returns the next mark if `is_there(mark.begins, taken)` holds. Packets handled from here on get
    /// the epoch of that mark.
    pub(super) fn next_mark(&mut self, is_there: impl Fn(u64, u64) -> bool) -> Option<Mark> {
        let mark = self.marks.front().copied().filter(|mark| is_there(mark.begins, self.taken))?;
        self.marks.pop_front();
        self.arrived = Some(mark.epoch);
        Some(mark)
    }

    fn drop(&mut self, publish: &Publish<'_>, why: Dropped) -> Result<Told, Ended> {
        if !self.duplicates.is_unreleased(publish) {
            if !self.need_not_be_released(publish, true) {
                self.duplicates.handled(publish, None)?;
            }
            self.refusals.note(publish.topic, why, &self.broker.lines, self.now);
        }
        Ok(why.told())
    }

    /// Whether a message of QoS 2 needs no PUBREL. In MQTT 5 a refused message ends at once, because the PUBREC
    /// contains the refusal (section 4.3.3).
    fn need_not_be_released(&self, publish: &Publish<'_>, is_refused: bool) -> bool {
        is_refused && publish.qos == Qos::Two && self.writer.version() == Version::Five
    }
}

impl Dropped {
    fn told(self) -> Told {
        Told { reason: self.reason(), words: self.to_string() }
    }
}

fn answer_to<'a>(publish: &Publish<'a>) -> Option<AnswerTo<'a>> {
    let (mut at, mut correlation) = (None, None);
    for property in publish.properties {
        if let Property::ResponseTopic(topic) = property {
            at = Some(topic);
        } else if let Property::CorrelationData(data) = property {
            correlation = Some(data);
        }
    }
    at.map(|topic| AnswerTo { topic, correlation })
}
