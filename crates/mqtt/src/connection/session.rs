//! What is remembered of a client between its connections, for how long, and the will that waits until it is over or the client takes too
//! long to come back.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use super::sending::Unacknowledged;
use crate::broker::Broker;
use crate::packet::connect::Will;
use crate::rights::Payer;
use crate::subscription::Subscription;

/// What is remembered of a client between its connections. While it is away, what is to reach it surely waits for it here.
#[derive(Debug, Default)]
pub struct Session {
    /// Its filters, and its queue; `None`: it was never here.
    pub(crate) subscription: Option<Subscription>,
    /// The ids of its messages of QoS 2 that it has not released, and by what such a message is known.
    pub(crate) unreleased: BTreeMap<u16, u64>,
    /// Messages that were sent and that it has not acknowledged.
    pub(super) unacknowledged: Unacknowledged,
    /// When it is over, on the clock of all connections, if ever.
    pub(super) expires_at: Option<Duration>,
    pub(super) will: Option<LateWill>,
}

/// A will that waits for its client to come back (MQTT 5, section 3.1.3.2.2).
#[derive(Debug)]
pub struct LateWill {
    pub(super) will: Will,
    /// By then the client is to be back.
    pub(super) due: Duration,
    pub(super) payer: Payer,
    pub(super) broker: Arc<Broker>,
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

    /// When something is to be done about it, if its client does not come back: [`Session::handle_timeout`].
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.will.as_ref().map(|will| will.due).into_iter().chain(self.expires_at).min()
    }

    /// The time of [`Session::poll_timeout`] may have come: whether the session is over ([`Session::end`]), and a will that has waited long
    /// enough, which is to be published.
    pub fn handle_timeout(&mut self, now: Duration) -> (bool, Option<LateWill>) {
        let is_over = self.expires_at.is_some_and(|at| at <= now);
        (is_over, self.will.take_if(|will| will.due <= now))
    }

    /// The session is over: a will that waits is published.
    pub fn end(mut self, now: Duration) {
        self.will.take().into_iter().for_each(|will| will.publish(now));
    }

    /// Its client goes on in another way: a will that waits is not published.
    pub fn withdraw_will(&mut self) {
        self.will = None;
    }
}

impl LateWill {
    /// It is published.
    pub fn publish(self, now: Duration) {
        self.broker.publish_will(&self.will, &self.payer, now);
    }
}
