//! PUBLISH of a client, its will, and its acknowledgements. Which topics are whose stands in `routes`.

use super::routes::{Dropped, Route};
use super::{ClientConnection, CommandDecision, Ended, Mark};
use crate::filter;
use crate::frame::{Frame, Kind};
use crate::packet::connect::Will;
use crate::packet::publish::{self, Publish};
use crate::packet::{Qos, text, write};

impl ClientConnection {
    /// A PUBLISH: `packet` is the whole of it. Whatever becomes of it, its sender is told that it has arrived (section 3.3.5).
    pub(super) fn publish(&mut self, frame: &Frame, packet: &[u8]) -> Result<(), Ended> {
        let publish = publish::read(frame, packet)?;
        match self.routes.route(publish.topic, self.tier, &self.broker)? {
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

    /// The client will not send a message of QoS 2 again.
    pub(super) fn released(&mut self, id: u16) {
        self.duplicates.released(id);
        write::ack(self.to_client.end(), Kind::Pubcomp, id);
    }

    pub(super) fn publish_will(&mut self, will: &Will) {
        let route = self.routes.route(will.topic.as_bytes(), self.tier, &self.broker);
        if !self.broker.rights.may_leave_will(self.tier, &will.topic) || route != Ok(Route::Pass) {
            self.refusals.note(will.topic.as_bytes(), "such a will");
            return;
        }
        self.forward(&will.payload, will.qos, will.retain);
    }

    fn pass(&mut self, publish: &Publish<'_>) -> Result<(), Ended> {
        if self.duplicates.is_unreleased(publish) {
            return Ok(());
        }
        self.duplicates.handled(publish, None)?;
        self.forward(publish.payload, publish.qos, publish.retain);
        Ok(())
    }

    /// A message on the topic of the last route goes on to whoever reads it, and is kept, if it is to be. Kept first: a newcomer that
    /// nobody knew of yet finds it there.
    fn forward(&mut self, payload: &[u8], qos: Qos, retain: bool) {
        if !retain && !self.routes.is_read(&self.broker) {
            return;
        }
        let message = self.broker.message(self.routes.topic(), payload, qos);
        if retain && !self.broker.retained.keep(&self.payer, &message) {
            let why = "it cannot be kept, there being too many kept messages; it was passed on";
            self.refusals.note(message.topic().as_bytes(), why);
        }
        self.routes.send(&message, &self.broker);
    }

    /// What may be a command is heard before anything can go wrong with it: what is urgent is heard even when there is no room left for it.
    fn hear(&mut self, publish: &Publish<'_>) -> Result<(), Ended> {
        let topic = text(publish.topic, "topic")?;
        let print = self.broker.print((publish.topic, publish.payload));
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
                Ok(()) => self.forward(publish.payload, publish.qos, false),
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
}
