//! SUBSCRIBE and UNSUBSCRIBE: which filters a client holds, and what is remembered of it between its connections.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::sync::Arc;

use super::sending::Unacknowledged;
use super::{ClientConnection, Ended};
use crate::filter;
use crate::frame::{Kind, Malformed};
use crate::limits::FILTERS;
use crate::packet::filters::Filters;
use crate::packet::{Qos, write};
use crate::subscriber::Subscription;

/// What is remembered of a client between its connections. While it is away, what is to reach it surely waits for it here.
#[derive(Debug, Default)]
pub struct Session {
    /// Its filters, and its queue; `None`: it was never here.
    pub(crate) subscription: Option<Subscription>,
    /// The ids of its messages of QoS 2 that it has not released, and by what such a message is known.
    pub(crate) unreleased: BTreeMap<u16, u64>,
    /// Messages that were sent and that it has not acknowledged.
    pub(super) unacknowledged: Unacknowledged,
}

impl Session {
    /// The filters it holds.
    pub fn filters(&self) -> impl Iterator<Item = &str> {
        self.subscription.iter().flat_map(Subscription::held).map(|(filter, _)| &**filter)
    }

    /// How many messages of QoS 2 it has not released.
    #[must_use]
    pub fn unreleased(&self) -> usize {
        self.unreleased.len()
    }
}

impl ClientConnection {
    pub(super) fn subscribe(&mut self, body: &[u8]) -> Result<(), Ended> {
        let filters = self.few(Filters::of_subscribe(body))?;
        let (mut codes, mut accepted) = (Vec::new(), BTreeMap::new());
        for (filter, qos) in filters {
            match self.accept(filter, qos) {
                Ok(name) => {
                    accepted.insert(name, qos);
                    codes.push(qos as u8);
                }
                Err(why) => {
                    self.refusals.note(filter.as_bytes(), why);
                    codes.push(write::REFUSED);
                }
            }
        }
        // What was published before goes out before, and what is kept at once, so that it does not matter what came in the same piece.
        self.deliver();
        write::suback(self.to_client.end(), filters.id, &codes);
        for (filter, qos) in accepted {
            self.deliveries.start(filter, qos);
        }
        self.deliver();
        Ok(())
    }

    pub(super) fn unsubscribe(&mut self, body: &[u8]) -> Result<(), Ended> {
        let filters = self.few(Filters::of_unsubscribe(body))?;
        for (filter, _) in filters {
            if self.subscription.strike(filter) {
                self.deliveries.stop(filter);
            }
        }
        write::ack(self.to_client.end(), Kind::Unsuback, filters.id);
        Ok(())
    }

    /// A packet with more filters than are taken ends the connection, and that is said.
    fn few<'a>(&mut self, filters: Result<Filters<'a>, Malformed>) -> Result<Filters<'a>, Ended> {
        if let Err(wrong @ Malformed::ManyFilters) = filters {
            self.refusals.note(b"", wrong);
        }
        Ok(filters?)
    }

    /// Takes a filter, or says why not. When it is held at another QoS, that is changed.
    fn accept(&mut self, filter: &str, qos: Qos) -> Result<Arc<str>, Box<dyn Display>> {
        filter::filter(filter).map_err(|unfit| Box::new(unfit) as Box<dyn Display>)?;
        if self.subscription.held().len() >= FILTERS && !self.subscription.holds(filter) {
            return Err(Box::new(format!("one connection holds at most {FILTERS} filters")));
        }
        Ok(self.subscription.hold(filter, qos))
    }
}
