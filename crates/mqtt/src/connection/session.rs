//! The session of a client between its connections, how long the session lasts, and a delayed will. Such a will is
//! published when the session ends or when the client has been away for the will's delay.

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
    /// The client's filters and its queue; `None` if the client was never connected.
    pub(crate) subscription: Option<Subscription>,
    /// Ids of the messages of QoS 2 that the client has not released. Each has a fingerprint by which the message is
    /// recognised.
    pub(crate) unreleased: BTreeMap<u16, u64>,
    pub(super) unacknowledged: Unacknowledged,
    /// When the session ends, on the clock of all connections; `None` if it never ends.
    pub(super) expires_at: Option<Duration>,
    pub(super) will: Option<LateWill>,
}

/// A will with a delay. Its client may come back before the delay is over (MQTT 5, section 3.1.3.2.2).
#[derive(Debug)]
pub struct LateWill {
    pub(super) will: Will,
    /// The time at which the will is published, unless the client is back by then.
    pub(super) due: Duration,
    pub(super) payer: Payer,
    pub(super) broker: Arc<Broker>,
}

impl Session {
    /// The filters that the client has subscribed to. Shared filters include their `$share/…`.
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

    /// Call this at the time of [`Session::poll_timeout`]. Returns whether the session is over, and the will if it is
    /// due. Call [`Session::end`] for a session that is over, and publish a returned will.
    pub fn handle_timeout(&mut self, now: Duration) -> (bool, Option<LateWill>) {
        let is_over = self.expires_at.is_some_and(|at| at <= now);
        (is_over, self.will.take_if(|will| will.due <= now))
    }

    /// Ends the session, and publishes its delayed will, if any, before the delay is over (MQTT 5, section
    /// 3.1.3.2.2).
    pub fn end(mut self, now: Duration) {
        self.will.take().into_iter().for_each(|will| will.publish(now));
    }

    /// Drops a delayed will, because a later connection of the client has resumed the session.
    pub fn withdraw_will(&mut self) {
        self.will = None;
    }
}

impl LateWill {
    /// Publishes the will, even if its delay is not over. `now` is on the clock of all connections.
    pub fn publish(self, now: Duration) {
        self.broker.publish_will(&self.will, &self.payer, now);
    }
}
