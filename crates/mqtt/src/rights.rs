//! The rights of clients: which topics exist for them, and on which of these they may publish, leave a will or share a
//! filter. The rights also say on which topics commands are accepted. The listener that hears a command decides
//! whether it is allowed.

use std::fmt::{self, Debug};
use std::sync::Arc;

/// How far a client is trusted. The [`Rights`] depend on this tier. A program may also use it to limit the client's
/// share of resources.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tier {
    /// All rights, and a full share. Only commands of these clients are forwarded with their MQTT properties.
    Full,
    /// Few rights, and a small share of resources that all such clients have in common. For example, clients that
    /// only watch.
    Limited,
}

/// The topics that exist for one client; by default all topics. The client receives no message on any other topic,
/// and what it publishes there is refused as on a topic where nobody may publish. A subscription to such a topic is
/// granted like any other, so that its answer does not tell whether the topic is in use.
#[derive(Clone, Default)]
pub struct Scope(Option<Contains>);

type Contains = Arc<dyn Fn(&str) -> bool + Send + Sync>;

impl Scope {
    /// The topics for which `contains` returns true. It is called for each message to the client, and must not block.
    pub fn of(contains: impl Fn(&str) -> bool + Send + Sync + 'static) -> Scope {
        Scope(Some(Arc::new(contains)))
    }

    /// Whether this topic exists for the client.
    #[must_use]
    pub fn contains(&self, topic: &str) -> bool {
        self.0.as_ref().is_none_or(|contains| contains(topic))
    }
}

impl Debug for Scope {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Scope(some topics)" } else { "Scope(all topics)" })
    }
}

/// The account to which a retained message is charged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Payer {
    /// The program that runs the broker, which has its own room.
    Program,
    /// Clients of a broker without authentication, which cannot be distinguished.
    Anybody,
    /// All clients with this key together, which have one share (`limits::KEPT_SHARE`).
    Key(Arc<str>),
}

/// The program's rules about topics. The answer for a topic is cached until the client publishes on another topic, or
/// until [`crate::Broker::rights_changed`]. The rules must not block. The program itself may publish anywhere.
pub trait Rights: Debug + Send + Sync {
    /// Whether commands are accepted on this topic. Messages on such a topic go to the listener before any subscriber
    /// gets them, and are never retained.
    fn is_for_commands(&self, topic: &str) -> bool;

    /// Whether a client may publish on this topic. This is not called for topics of commands, where the listener
    /// decides.
    fn may_publish(&self, who: Tier, topic: &str) -> bool;

    /// Whether a client may leave a will on this topic. By default this is allowed wherever the client may publish,
    /// but never for commands, since nobody is responsible for a command that is published later.
    fn may_leave_will(&self, who: Tier, topic: &str) -> bool {
        !self.is_for_commands(topic) && self.may_publish(who, topic)
    }

    /// Whether a client may share this filter with others, each of which then gets only a part of the messages.
    fn may_share(&self, who: Tier, filter: &str) -> bool;
}
