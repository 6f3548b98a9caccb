//! The rights of clients: on which topics they may publish, leave a will or share a filter. The rights also say on
//! which topics commands are accepted. The listener that hears a command decides whether it is allowed.

use std::fmt::Debug;
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

/// The program's rules about topics. The answer for a topic is cached until the client publishes on another topic.
/// The rules must not block. The program itself may publish anywhere.
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
