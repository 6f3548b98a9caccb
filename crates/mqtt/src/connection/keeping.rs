//! Sends retained messages to one client, one filter after the other, and only while the client has room. Each
//! message is looked up just before it is sent. So the client gets the newest one, and nothing is stored for a client
//! that does not read.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use super::client_writer::ClientWriter;
use super::sending::{Cause, Unacknowledged};
use crate::grant::Grant;
use crate::limits::{KEPT_ROOM, KEPT_STEPS, KEPT_UNDER_WAY};
use crate::message::SubscriberId;
use crate::outbox::Outbox;
use crate::packet::Qos;
use crate::retained::{Retained, Walk};
use crate::subscriber;

#[derive(Debug, Default)]
pub(super) struct Deliveries {
    waiting: VecDeque<Delivery>,
    /// Whether the next message has to wait until earlier ones are acknowledged.
    is_held_up: bool,
}

#[derive(Debug)]
struct Delivery {
    walk: Walk,
    grant: Grant,
    /// Whether the client was subscribed when the messages were published, and missed some of them.
    is_missed: bool,
}

impl Deliveries {
    /// Starts to send all retained messages that match a filter. An unfinished delivery for the same filter is
    /// stopped.
    pub(super) fn start(&mut self, filter: Arc<str>, grant: Grant) {
        self.stop(&filter);
        self.waiting.push_back(Delivery { walk: Walk::new(filter, 0), grant, is_missed: false });
    }

    /// Starts to send the messages again that match a filter and were retained after the stamp `since`. Does nothing
    /// if a delivery for the filter is under way.
    pub(super) fn repeat(&mut self, filter: Arc<str>, grant: Grant, since: u64) {
        if !self.waiting.iter().any(|delivery| delivery.walk.filter() == &*filter) {
            self.waiting.push_back(Delivery { walk: Walk::new(filter, since), grant, is_missed: true });
        }
    }

    pub(super) fn stop(&mut self, filter: &str) {
        self.waiting.retain(|delivery| delivery.walk.filter() != filter);
    }

    /// Whether `fill` may have more messages for a client that has room.
    pub(super) fn goes_on(&self) -> bool {
        !self.waiting.is_empty() && !self.is_held_up
    }

    /// Sends as many messages as the client has room for. Examines at most `KEPT_STEPS` retained messages.
    pub(super) fn fill(
        &mut self,
        retained: &Retained,
        unacknowledged: &mut Unacknowledged,
        writer: &mut ClientWriter,
        out: &mut Outbox,
        whose: SubscriberId,
        now: Duration,
    ) {
        // Refills only when half of the messages are acknowledged, which saves a look-up for each acknowledgement.
        self.is_held_up &= unacknowledged.kept() > KEPT_UNDER_WAY / 2 || !unacknowledged.has_window();
        let mut steps = KEPT_STEPS;
        while steps > 0 && out.len() < KEPT_ROOM {
            let Some(delivery) = self.waiting.front_mut() else { return };
            let has_window = unacknowledged.kept() < KEPT_UNDER_WAY && unacknowledged.has_window();
            let Grant { options, .. } = delivery.grant;
            self.is_held_up |= options.qos > Qos::Zero && !has_window;
            if self.is_held_up {
                return;
            }
            let (ids, retain) = (delivery.grant.ids(), !delivery.is_missed || options.as_published);
            let found = retained.next(&mut delivery.walk, &mut steps, now);
            if delivery.walk.is_over() {
                self.waiting.pop_front();
            }
            if let Some(message) = found.filter(|message| !(options.no_local && message.is_by(whose))) {
                let qos = message.qos().min(options.qos);
                unacknowledged.send(subscriber::Delivery { message, qos, retain, ids }, Cause::Kept, writer, out, now);
            }
        }
    }
}
