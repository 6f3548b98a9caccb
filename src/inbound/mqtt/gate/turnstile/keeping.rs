//! The kept messages on their way to one client: those of one filter after the other, no more at once than the client takes. Which are
//! kept is looked up as they go, so that the newest goes out, and nothing is held back for a client that does not read.

use std::collections::VecDeque;
use std::sync::Arc;

use bytes::BytesMut;

use crate::inbound::mqtt::gate::limits::{CLIENT_ROOM, KEPT_IDS, KEPT_UNDER_WAY};
use crate::inbound::mqtt::gate::packet::{Qos, write};
use crate::inbound::mqtt::gate::retained::{Kept, Retained};

/// How many are looked up at a time.
const AT_A_TIME: usize = 64;

/// What is on its way.
#[derive(Debug, Default)]
pub(super) struct Deliveries {
    waiting: VecDeque<Delivery>,
    /// The ids of those of QoS 1 that are not acknowledged, and how many ever were given.
    under_way: Vec<u16>,
    given: u16,
    /// Whether the next one waits for acknowledgements.
    is_held_up: bool,
}

/// What is kept for one filter, from behind a topic on.
#[derive(Debug)]
struct Delivery {
    filter: Arc<str>,
    qos: Qos,
    behind: Option<Arc<Kept>>,
}

impl Deliveries {
    /// All that is kept for a filter is to go out, at no more than this QoS.
    pub(super) fn start(&mut self, filter: Arc<str>, qos: Qos) {
        self.stop(&filter);
        self.waiting.push_back(Delivery { filter, qos, behind: None });
    }

    /// Nothing more is to go out for a filter.
    pub(super) fn stop(&mut self, filter: &str) {
        self.waiting.retain(|delivery| &*delivery.filter != filter);
    }

    /// The client acknowledged one.
    pub(super) fn acknowledged(&mut self, id: u16) {
        self.under_way.retain(|under_way| *under_way != id);
        // Half of them at once, so that they are not looked up for each.
        self.is_held_up &= self.under_way.len() > KEPT_UNDER_WAY / 2;
    }

    /// Puts before the client what there is room for.
    pub(super) fn fill(&mut self, retained: &Retained, out: &mut BytesMut) {
        while !self.is_held_up && out.len() < CLIENT_ROOM {
            let Some(delivery) = self.waiting.front() else { return };
            let (qos, behind) = (delivery.qos, delivery.behind.as_ref().map(|kept| &*kept.topic));
            let found = retained.matching(&delivery.filter, behind, AT_A_TIME);
            let gone = found.iter().take_while(|kept| out.len() < CLIENT_ROOM && self.send(kept, qos, out)).count();
            if let Some(delivery) = self.waiting.front_mut().filter(|_| gone > 0) {
                delivery.behind = found.get(gone - 1).cloned();
            }
            if found.is_empty() {
                self.waiting.pop_front();
            }
        }
    }

    /// Puts one before the client, unless it must wait for an acknowledgement.
    fn send(&mut self, kept: &Kept, granted: Qos, out: &mut BytesMut) -> bool {
        let qos = kept.qos.min(granted);
        let id = match qos {
            Qos::Zero => 0,
            Qos::One | Qos::Two if self.under_way.len() >= KEPT_UNDER_WAY => {
                self.is_held_up = true;
                return false;
            }
            Qos::One | Qos::Two => self.next_id(),
        };
        write::publish(out, kept.topic.as_bytes(), &kept.payload, qos, id, true);
        true
    }

    /// An id that is not under way.
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
