//! PUBLISH of a client, its will, and its acknowledgements. Which topics are whose stands in `routes`.

use super::routes::{Dropped, Route, is_for_commands};
use super::{Ended, Heard, Turnstile};
use crate::inbound::mqtt::gate::filter;
use crate::inbound::mqtt::gate::frame::{Frame, Kind};
use crate::inbound::mqtt::gate::limits::KEPT_IDS;
use crate::inbound::mqtt::gate::packet::connect::Will;
use crate::inbound::mqtt::gate::packet::publish::{self, Publish};
use crate::inbound::mqtt::gate::packet::{Qos, text, write};
use crate::inbound::mqtt::gate::rights::Guest;

/// The flag of a PUBLISH that is to be kept.
const RETAIN: u8 = 1;

impl Turnstile {
    /// A PUBLISH: `packet` is the whole of it. Whatever becomes of it, its sender is told that it has arrived (section 3.3.5).
    pub(super) fn publish(&mut self, frame: &Frame, packet: &[u8]) -> Result<(), Ended> {
        let publish = publish::read(frame, packet)?;
        match self.routes.route(publish.topic, self.guest, &self.gatehouse)? {
            Route::Pass if publish.qos == Qos::Zero => self.pass_as_it_is(&publish, packet),
            Route::Pass => self.pass(&publish)?,
            Route::Hear => self.hear(&publish)?,
            Route::Drop(why) => self.drop(&publish, why)?,
        }
        match publish.qos {
            Qos::Zero => {}
            Qos::One => write::ack(&mut self.to_client, Kind::Puback, publish.id),
            Qos::Two => write::ack(&mut self.to_client, Kind::Pubrec, publish.id),
        }
        Ok(())
    }

    /// The client acknowledged a message, of the engine or a kept one.
    pub(super) fn acknowledged(&mut self, id: u16) {
        if KEPT_IDS.contains(&id) {
            self.deliveries.acknowledged(id);
            return;
        }
        self.outstanding.acknowledged(id);
        self.acknowledge();
    }

    /// Tells the engine what it can be told of what it waits for.
    pub(super) fn acknowledge(&mut self) {
        while let Some(id) = self.outstanding.next() {
            write::ack(&mut self.to_engine, Kind::Puback, id);
        }
    }

    /// The client will not send a message of QoS 2 again.
    pub(super) fn released(&mut self, id: u16) {
        self.duplicates.released(id);
        write::ack(&mut self.to_client, Kind::Pubcomp, id);
    }

    /// What a client left for the time after it.
    pub(super) fn publish_will(&mut self, will: &Will) {
        let place = self.gatehouse.topics.place(&will.topic);
        let is_allowed = self.guest.may_leave_will(place) && !is_for_commands(place);
        let route = self.routes.route(will.topic.as_bytes(), self.guest, &self.gatehouse);
        if !is_allowed || route != Ok(Route::Pass) {
            self.refusals.note(will.topic.as_bytes(), "such a will");
            return;
        }
        self.routes.passed(will.payload.len());
        self.routes.settle();
        write::publish(&mut self.to_engine, will.topic.as_bytes(), &will.payload, Qos::Zero, 0, false);
        if will.retain {
            self.keep(&will.topic, &will.payload, will.qos);
        }
    }

    fn pass_as_it_is(&mut self, publish: &Publish<'_>, packet: &[u8]) {
        self.routes.passed(publish.payload.len());
        let start = self.to_engine.len();
        self.to_engine.extend_from_slice(packet);
        if publish.retain {
            self.to_engine[start] &= !RETAIN;
            self.retain(publish);
        }
    }

    fn pass(&mut self, publish: &Publish<'_>) -> Result<(), Ended> {
        if self.duplicates.is_unreleased(publish) {
            return Ok(());
        }
        self.duplicates.handled(publish, None)?;
        self.routes.passed(publish.payload.len());
        write::publish(&mut self.to_engine, publish.topic, publish.payload, Qos::Zero, 0, false);
        if publish.retain {
            self.retain(publish);
        }
        Ok(())
    }

    /// What may be a command is heard before anything can go wrong with it: a stop is heard even when there is no room left for it.
    fn hear(&mut self, publish: &Publish<'_>) -> Result<(), Ended> {
        let topic = text(publish.topic, "topic")?;
        let print = self.gatehouse.budget.print((publish.topic, publish.payload));
        let is_stop = self.has_halted() || self.listener.halts(publish.topic, publish.payload);
        if !is_stop && self.duplicates.was_heard(publish, print) {
            return Ok(());
        }
        let heard = if is_stop { Heard::Pass } else { self.listener.hear(topic, publish.payload) };
        let is_unreleased = self.duplicates.is_unreleased(publish);
        self.duplicates.handled(publish, Some(print))?;
        match heard {
            Heard::Forbidden => self.refusals.note(publish.topic, Dropped::Forbidden),
            Heard::Pass if is_unreleased => {}
            Heard::Pass => {
                if self.routes.admits_command(topic, &self.gatehouse)? {
                    self.routes.passed(publish.payload.len());
                    write::publish(&mut self.to_engine, publish.topic, publish.payload, Qos::Zero, 0, false);
                }
            }
        }
        Ok(())
    }

    /// Whether the packet that is taken just now has halted already when it came: it does not twice.
    fn has_halted(&mut self) -> bool {
        while self.halted.front().is_some_and(|begins| *begins < self.taken) {
            self.halted.pop_front();
        }
        self.halted.front() == Some(&self.taken)
    }

    fn drop(&mut self, publish: &Publish<'_>, why: Dropped) -> Result<(), Ended> {
        if !self.duplicates.is_unreleased(publish) {
            self.duplicates.handled(publish, None)?;
            self.refusals.note(publish.topic, why);
        }
        Ok(())
    }

    fn retain(&mut self, publish: &Publish<'_>) {
        if let Ok(topic) = text(publish.topic, "topic") {
            self.keep(topic, publish.payload, publish.qos);
        }
    }

    fn keep(&mut self, topic: &str, payload: &[u8], qos: Qos) {
        if is_for_commands(self.gatehouse.topics.place(topic)) || filter::topic(topic).is_err() {
            return;
        }
        let retained = &self.gatehouse.retained;
        let is_ours = self.guest == Guest::House;
        if !(if is_ours { retained.keep_ours(topic, payload, qos) } else { retained.keep(topic, payload, qos) }) {
            self.refusals.note(topic.as_bytes(), "it cannot be kept, there being too many kept messages; it was passed on");
        }
    }
}
