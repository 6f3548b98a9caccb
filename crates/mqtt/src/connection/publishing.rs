//! PUBLISH of a client, its will, and its acknowledgements. Which topics are whose stands in `routes`.

use bytes::Bytes;

use super::routes::{Dropped, Route, Way};
use super::{ClientConnection, CommandDecision, Ended, Mark};
use crate::filter;
use crate::frame::{Frame, Kind, frame};
use crate::limits::{KEPT_IDS, PADDED, PROGRAM_PACKET, SHARED};
use crate::packet::connect::Will;
use crate::packet::publish::{self, Publish};
use crate::packet::{Qos, text, write};
use crate::subscriber_lag::COUNTED;

impl ClientConnection {
    /// Whether messages wait for the router.
    #[must_use]
    pub fn has_messages(&self) -> bool {
        let mut rest = &self.to_router[..];
        while let Ok(Some(packet)) = frame(rest, PROGRAM_PACKET) {
            if packet.kind == Kind::Publish {
                return true;
            }
            rest = &rest[packet.length..];
        }
        false
    }

    /// A PUBLISH: `packet` is the whole of it. Whatever becomes of it, its sender is told that it has arrived (section 3.3.5).
    pub(super) fn publish(&mut self, frame: &Frame, packet: &[u8]) -> Result<(), Ended> {
        let publish = publish::read(frame, packet)?;
        match self.routes.route(publish.topic, self.principal, &self.broker)? {
            Route::Pass => self.pass(&publish)?,
            Route::Hear => self.hear(&publish)?,
            Route::Drop(why) => self.drop(&publish, why)?,
        }
        match publish.qos {
            Qos::Zero => {}
            Qos::One => write::ack(self.to_client.end(), Kind::Puback, publish.id),
            Qos::Two => write::ack(self.to_client.end(), Kind::Pubrec, publish.id),
        }
        Ok(())
    }

    /// The client acknowledged a message, of the router or a kept one.
    pub(super) fn acknowledged(&mut self, id: u16) {
        if KEPT_IDS.contains(&id) {
            self.deliveries.acknowledged(id);
            return;
        }
        if let Some(parcel) = self.outstanding.acknowledged(id) {
            self.lag_guard.lag().received(parcel);
        }
        self.acknowledge();
    }

    /// Tells the router what it can be told of what it waits for.
    pub(super) fn acknowledge(&mut self) {
        while let Some(id) = self.outstanding.next() {
            write::ack(&mut self.to_router, Kind::Puback, id);
        }
    }

    /// The client will not send a message of QoS 2 again.
    pub(super) fn released(&mut self, id: u16) {
        self.duplicates.released(id);
        write::ack(self.to_client.end(), Kind::Pubcomp, id);
    }

    pub(super) fn publish_will(&mut self, will: &Will) {
        let rights = &self.broker.rights;
        let is_allowed = rights.may_leave_will(self.principal, &will.topic) && !rights.is_for_commands(&will.topic);
        let route = self.routes.route(will.topic.as_bytes(), self.principal, &self.broker);
        if !is_allowed || route != Ok(Route::Pass) {
            self.refusals.note(will.topic.as_bytes(), "such a will");
            return;
        }
        self.forward(will.topic.as_bytes(), &will.payload, will.retain.then_some(will.qos));
        self.routes.settle();
    }

    fn pass(&mut self, publish: &Publish<'_>) -> Result<(), Ended> {
        if self.duplicates.is_unreleased(publish) {
            return Ok(());
        }
        self.duplicates.handled(publish, None)?;
        self.forward(publish.topic, publish.payload, publish.retain.then_some(publish.qos));
        Ok(())
    }

    /// A message on the topic of the last route goes on to whoever reads it, and is kept, if it is to be kept at a QoS. Kept first: a
    /// newcomer that nobody knew of yet finds it there.
    fn forward(&mut self, topic: &[u8], payload: &[u8], retain: Option<Qos>) {
        self.routes.begin(&self.broker);
        if self.routes.way(&self.payer, &self.broker) == Way::Shut {
            return self.refusals.note(topic, Dropped::Budget);
        }
        let retained = &self.broker.retained;
        let is_shared = payload.len() >= SHARED;
        let shared = if retain.is_some() || is_shared { retained.share(payload) } else { Bytes::new() };
        if let Some(qos) = retain
            && let Ok(topic) = text(topic, "topic")
        {
            self.keep(topic, shared.clone(), qos);
        }
        match self.routes.way(&self.payer, &self.broker) {
            Way::Unread => {}
            Way::Shut => self.refusals.note(topic, Dropped::Budget),
            Way::Open if self.flooding.is_some_and(|now| self.routes.is_in_vain(now)) => self.routes.lost(payload.len()),
            Way::Open => {
                self.routes.passed(payload.len(), &self.broker);
                let length = PADDED.saturating_sub(COUNTED + topic.len());
                if is_shared {
                    let label = self.routes.send(&shared, &self.broker);
                    write::label(&mut self.to_router, topic, label, length);
                } else {
                    write::publish_padded(&mut self.to_router, topic, payload, length);
                }
            }
        }
    }

    /// What may be a command is heard before anything can go wrong with it: what is urgent is heard even when there is no room left for it.
    fn hear(&mut self, publish: &Publish<'_>) -> Result<(), Ended> {
        let topic = text(publish.topic, "topic")?;
        let print = self.broker.budget.print((publish.topic, publish.payload));
        let is_urgent = self.heard_ahead() || self.listener.hear_urgent(publish.topic, publish.payload);
        if !is_urgent && self.duplicates.was_heard(publish, print) {
            return Ok(());
        }
        let came = (self.arrived, publish.is_duplicate);
        let heard = if is_urgent { CommandDecision::Pass } else { self.listener.hear(topic, publish.payload, came) };
        let is_unreleased = self.duplicates.is_unreleased(publish);
        self.duplicates.handled(publish, Some(print))?;
        match heard {
            CommandDecision::Forbidden => self.refusals.note(publish.topic, Dropped::Forbidden),
            CommandDecision::Pass if is_unreleased => {}
            CommandDecision::Pass => match filter::topic(topic) {
                Ok(()) => self.forward(publish.topic, publish.payload, None),
                Err(unfit) => self.refusals.note(publish.topic, unfit),
            },
        }
        Ok(())
    }

    /// Looks up what is known of the packet that is taken just now: its epoch, and whether it was heard ahead when it came, which is
    /// not done twice.
    fn heard_ahead(&mut self) -> bool {
        let mut heard_ahead = false;
        while let Some(mark) = self.next_mark(|begins, taken| begins <= taken) {
            heard_ahead = mark.heard_ahead && mark.begins == self.taken;
        }
        heard_ahead
    }

    /// The next mark, if it stands where this is so; its epoch is that of what comes behind it.
    pub(super) fn next_mark(&mut self, is_there: impl Fn(u64, u64) -> bool) -> Option<Mark> {
        let mark = self.marks.front().copied().filter(|mark| is_there(mark.begins, self.taken))?;
        self.marks.pop_front();
        self.arrived = Some(mark.epoch);
        Some(mark)
    }

    fn drop(&mut self, publish: &Publish<'_>, why: Dropped) -> Result<(), Ended> {
        if !self.duplicates.is_unreleased(publish) {
            self.duplicates.handled(publish, None)?;
            self.refusals.note(publish.topic, why);
        }
        Ok(())
    }

    fn keep(&mut self, topic: &str, payload: Bytes, qos: Qos) {
        if self.broker.rights.is_for_commands(topic) || filter::topic(topic).is_err() {
            return;
        }
        if !self.broker.retained.keep_shared(&self.payer, topic, payload, qos) {
            self.refusals.note(topic.as_bytes(), "it cannot be kept, there being too many kept messages; it was passed on");
        }
    }
}
