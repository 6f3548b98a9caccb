//! The kept messages on their way to one client: those of one filter after the other, no more at once than the client takes. Which are
//! kept is looked up as they go, so that the newest goes out, and nothing is held back for a client that does not read.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::limits::{KEPT_IDS, KEPT_ROOM, KEPT_STEPS, KEPT_UNDER_WAY, SHARED};
use crate::outbox::Outbox;
use crate::packet::{Qos, write};
use crate::retained::{Retained, RetainedMessage, Walk};

#[derive(Debug, Default)]
pub(super) struct Deliveries {
    waiting: VecDeque<Delivery>,
    /// The ids of those of QoS 1 that are not acknowledged, and how many ever were given.
    under_way: Vec<u16>,
    given: u16,
    /// Whether the next one waits for acknowledgements.
    is_held_up: bool,
}

#[derive(Debug)]
struct Delivery {
    walk: Walk,
    qos: Qos,
    /// Whether the client has not asked for it just now, but missed it: then it is not said that it was kept.
    is_missed: bool,
}

impl Deliveries {
    /// All that is kept for a filter is to go out, at no more than this QoS.
    pub(super) fn start(&mut self, filter: Arc<str>, qos: Qos) {
        self.stop(&filter);
        self.waiting.push_back(Delivery { walk: Walk::new(filter, 0), qos, is_missed: false });
    }

    /// All that was kept for a filter after this stamp goes out anew, unless all of it is on its way anyhow.
    pub(super) fn repeat(&mut self, filter: Arc<str>, qos: Qos, since: u64) {
        if !self.waiting.iter().any(|delivery| delivery.walk.filter() == &*filter) {
            self.waiting.push_back(Delivery { walk: Walk::new(filter, since), qos, is_missed: true });
        }
    }

    pub(super) fn stop(&mut self, filter: &str) {
        self.waiting.retain(|delivery| delivery.walk.filter() != filter);
    }

    pub(super) fn acknowledged(&mut self, id: u16) {
        self.under_way.retain(|under_way| *under_way != id);
        // Half of them at once, so that they are not looked up for each.
        self.is_held_up &= self.under_way.len() > KEPT_UNDER_WAY / 2;
    }

    /// Whether there may be more for a client that has room.
    pub(super) fn goes_on(&self) -> bool {
        !self.waiting.is_empty() && !self.is_held_up
    }

    /// Puts before the client what there is room for, and what is found in one turn.
    pub(super) fn fill(&mut self, retained: &Retained, out: &mut Outbox) {
        let mut steps = KEPT_STEPS;
        while steps > 0 && out.len() < KEPT_ROOM {
            let Some(delivery) = self.waiting.front_mut() else { return };
            if delivery.qos > Qos::Zero && self.under_way.len() >= KEPT_UNDER_WAY {
                self.is_held_up = true;
            }
            if self.is_held_up {
                return;
            }
            let (qos, is_missed) = (delivery.qos, delivery.is_missed);
            let found = retained.next(&mut delivery.walk, &mut steps);
            if delivery.walk.is_over() {
                self.waiting.pop_front();
            }
            if let Some(kept) = found {
                self.send(&kept, qos, is_missed, out);
            }
        }
    }

    fn send(&mut self, kept: &RetainedMessage, granted: Qos, is_missed: bool, out: &mut Outbox) {
        let qos = kept.qos.min(granted);
        let id = if qos == Qos::Zero { 0 } else { self.next_id() };
        if kept.payload.len() < SHARED {
            return write::publish(out.end(), kept.topic.as_bytes(), &kept.payload, qos, id, !is_missed);
        }
        write::publish_head(out.end(), kept.topic.as_bytes(), kept.payload.len(), (qos, id, !is_missed));
        out.share(kept.payload.clone());
    }

    fn next_id(&mut self) -> u16 {
        loop {
            let id = KEPT_IDS.start() + self.given;
            self.given = (self.given + 1) % (KEPT_IDS.end() - KEPT_IDS.start() + 1);
            if !self.under_way.contains(&id) {
                self.under_way.push(id);
                return id;
            }
        }
    }
}
