//! What becomes of a message by its topic, and who gets it.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use bytes::Bytes;

use super::Ended;
use crate::Broker;
use crate::budget::Payer;
use crate::filter::{self, Unfit};
use crate::frame::Malformed;
use crate::limits::{LONG, PADDED, PARCELS_AWAY, PIECE, SHARED};
use crate::packet::text;
use crate::parcels::Label;
use crate::readers::Reader;
use crate::rights::Principal;
use crate::subscriber_lag::{SubscriberLag, weight};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Route {
    Pass,
    /// It may be a command: whoever hears those decides.
    Hear,
    /// It is acknowledged, and that is all.
    Drop(Dropped),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Dropped {
    #[error("its sender may not publish there")]
    Forbidden,
    #[error(transparent)]
    Unfit(Unfit),
    #[error("more topics than there are for its sender")]
    Budget,
}

/// Whether there is a way to those who read a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// Nobody reads it: the router need not know of it.
    Unread,
    Open,
    /// It is one topic too many for its sender.
    Shut,
}

/// The topic before, since many clients have but one, and what became of it.
#[derive(Debug, Default)]
pub(super) struct Routes {
    topic: Vec<u8>,
    route: Option<Route>,
    /// Of it, as of this generation of readers.
    way: Option<(Way, u64)>,
    readers: Vec<Reader>,
    /// Bytes on it that were passed on and are not counted for its readers yet,
    unsettled: i64,
    /// none of which was kept before this stamp.
    stamp: u64,
    /// Messages that were passed on, or would have been, since somebody asked, and the bytes of those that were.
    passed: u64,
    piece: i64,
    /// Readers who were behind when something was published for them.
    behind: Vec<Arc<SubscriberLag>>,
}

impl Routes {
    pub(super) fn route(&mut self, topic: &[u8], principal: Principal, broker: &Broker) -> Result<Route, Ended> {
        if let Some(route) = self.route.filter(|_| self.topic == topic) {
            return Ok(route);
        }
        self.settle();
        let route = judge(topic, principal, broker)?;
        self.topic.clear();
        self.topic.extend_from_slice(topic);
        (self.route, self.way) = (Some(route), None);
        Ok(route)
    }

    /// To be told before a message is kept: it is later than what was kept until now.
    pub(super) fn begin(&mut self, broker: &Broker) {
        if self.unsettled == 0 {
            self.stamp = broker.retained.stamp();
        }
    }

    /// Whether there is a way for the topic of the last question, as of now.
    pub(super) fn way(&mut self, payer: &Payer, broker: &Broker) -> Way {
        let generation = broker.readers.generation();
        if let Some((way, _)) = self.way.filter(|(_, known)| *known == generation) {
            return way;
        }
        self.settle();
        self.readers = std::str::from_utf8(&self.topic).map(|topic| broker.readers.of(topic)).unwrap_or_default();
        let way = match &self.readers[..] {
            [] => Way::Unread,
            [..] if broker.budget.admits_topic(payer, &self.topic) => Way::Open,
            [..] => Way::Shut,
        };
        self.way = Some((way, generation));
        way
    }

    /// A message on the topic of the last question, with so long a payload, was passed on to the router.
    pub(super) fn passed(&mut self, payload: usize, broker: &Broker) {
        let bytes = weight(self.topic.len(), payload);
        let whole = if payload < SHARED { self.topic.len() + payload } else { 0 };
        let fed = whole.max(PADDED) * self.readers.len();
        broker.fed.fetch_add(fed as u64, Ordering::Relaxed);
        self.count(payload);
        self.piece += bytes;
        self.unsettled += bytes;
    }

    /// Whether nobody who reads the topic of the last question is waited for: a flood on it would be lost at the router, and cost the
    /// more on its way there, the less its sender is made to wait.
    pub(super) fn is_in_vain(&self, now: Duration) -> bool {
        self.readers.iter().all(|reader| reader.is_owed && reader.lag.is_given_up(now))
    }

    /// A message on the topic of the last question, with so long a payload, was not passed on: all who read it miss it.
    pub(super) fn lost(&mut self, payload: usize) {
        self.count(payload);
        for reader in &self.readers {
            reader.lag.miss(self.stamp);
        }
    }

    fn count(&mut self, payload: usize) {
        self.passed += 1 + (payload / LONG) as u64;
    }

    /// A long message on the topic of the last question is on its way to all who read it; by what it goes through the router.
    pub(super) fn send(&self, payload: &Bytes, broker: &Broker) -> Label {
        let number = broker.parcels.fetch_add(1, Ordering::Relaxed);
        let has_room = broker.retained.beside() <= PARCELS_AWAY;
        for reader in self.readers.iter().filter(|reader| reader.is_owed || has_room) {
            reader.lag.expect(number, payload);
        }
        Label { number, stamp: self.stamp, length: u32::try_from(payload.len()).unwrap_or(u32::MAX) }
    }

    /// Counts what was passed on for those who are to get it.
    pub(super) fn settle(&mut self) {
        let unsettled = std::mem::take(&mut self.unsettled);
        if unsettled == 0 {
            return;
        }
        for reader in self.readers.iter().filter(|reader| reader.is_owed) {
            let is_behind = reader.lag.owe(unsettled, self.stamp);
            if is_behind && !self.behind.iter().any(|known| Arc::ptr_eq(known, &reader.lag)) {
                self.behind.push(Arc::clone(&reader.lag));
            }
        }
    }

    /// Whether so much was passed on since this was asked that it is to be looked whether somebody lags.
    pub(super) const fn take_piece(&mut self) -> bool {
        let is_piece = self.piece >= PIECE;
        if is_piece {
            self.piece = 0;
        }
        is_piece
    }

    pub(super) fn take_passed(&mut self) -> u64 {
        std::mem::take(&mut self.passed)
    }

    pub(super) fn behind(&mut self, now: Duration) -> Vec<Arc<SubscriberLag>> {
        self.behind.retain(|reader| reader.is_behind(now));
        self.behind.clone()
    }
}

fn judge(topic: &[u8], principal: Principal, broker: &Broker) -> Result<Route, Ended> {
    let topic = text(topic, "topic")?;
    if topic.is_empty() || topic.contains(['+', '#']) {
        return Err(Malformed::Topic.into());
    }
    if principal != Principal::Program && broker.rights.is_for_commands(topic) {
        return Ok(Route::Hear);
    }
    if !broker.rights.may_publish(principal, topic) {
        return Ok(Route::Drop(Dropped::Forbidden));
    }
    Ok(filter::topic(topic).map_or_else(|unfit| Route::Drop(Dropped::Unfit(unfit)), |()| Route::Pass))
}
