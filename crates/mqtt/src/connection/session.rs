//! The session of a client between its connections, how long it lasts, and the will that waits until the session ends
//! or the client has been away for its delay.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use super::sending::Unacknowledged;
use crate::broker::Broker;
use crate::packet::connect::Will;
use crate::rights::Payer;
use crate::subscription::Subscription;

/// What the broker stores of a client between its connections. While the client is away, messages of QoS 1 and 2 wait
/// for it here.
#[derive(Debug, Default)]
pub struct Session {
    /// Its filters and its queue; `None`: it was never here.
    pub(crate) subscription: Option<Subscription>,
    /// Ids of its messages of QoS 2 that it has not released, with the fingerprints by which such a message is
    /// recognised.
    pub(crate) unreleased: BTreeMap<u16, u64>,
    pub(super) unacknowledged: Unacknowledged,
    /// When the session ends, on the clock of all connections; `None`: never.
    pub(super) expires_at: Option<Duration>,
    pub(super) will: Option<LateWill>,
}

/// A will that waits for its client to come back (MQTT 5, section 3.1.3.2.2).
#[derive(Debug)]
pub struct LateWill {
    pub(super) will: Will,
    /// When the will is published, unless the client is back.
    pub(super) due: Duration,
    pub(super) payer: Payer,
    pub(super) broker: Arc<Broker>,
}

impl Session {
    /// The filters that the client holds, shared ones with their `$share/…`.
    pub fn filters(&self) -> impl Iterator<Item = &str> {
        self.subscription.iter().flat_map(Subscription::held).map(|(filter, _)| &**filter)
    }

    /// How many messages of QoS 2 wait for the client's PUBREL, `limits::UNRELEASED` at most.
    #[must_use]
    pub fn unreleased(&self) -> usize {
        self.unreleased.len()
    }

    /// When to call [`Session::handle_timeout`], if the client does not come back.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.will.as_ref().map(|will| will.due).into_iter().chain(self.expires_at).min()
    }

    /// Call this at the time of [`Session::poll_timeout`]. Returns whether the session is over, in which case
    /// [`Session::end`] is to be called, and a will that is due, which is to be published.
    pub fn handle_timeout(&mut self, now: Duration) -> (bool, Option<LateWill>) {
        let is_over = self.expires_at.is_some_and(|at| at <= now);
        (is_over, self.will.take_if(|will| will.due <= now))
    }

    /// Ends the session, and publishes a will that waits, even before its delay is over (MQTT 5, section 3.1.3.2.2).
    pub fn end(mut self, now: Duration) {
        self.will.take().into_iter().for_each(|will| will.publish(now));
    }

    /// Drops a waiting will, because its client has connected again in another way.
    pub fn withdraw_will(&mut self) {
        self.will = None;
    }
}

impl LateWill {
    /// Publishes the will, whatever is left of its delay. `now` is on the clock of all connections.
    pub fn publish(self, now: Duration) {
        self.broker.publish_will(&self.will, &self.payer, now);
    }
}
