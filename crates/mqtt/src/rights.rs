//! What clients may do: who may publish, leave a will or share a filter where, and where commands are accepted. Whether
//! a command is allowed is decided by the listener that hears it.

use std::fmt::Debug;
use std::sync::Arc;

/// How far a client is trusted. The [`Rights`] are asked with it, and a program may bound its share of resources by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tier {
    /// All rights, and a full share. Only its commands go on to subscribers with their properties.
    Full,
    /// Few rights, and a small share of a part that all such clients have in common. Clients that only watch are an
    /// example.
    Limited,
}

/// The account to which a retained message is charged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Payer {
    /// The program that runs the broker, which has its own room.
    Program,
    /// Clients of a broker without authentication, which cannot be told apart.
    Anybody,
    /// All clients with this key together: they have one share (`limits::KEPT_SHARE`).
    Key(Arc<str>),
}

/// The program's rules about topics. They are asked once for each topic that a client changes to, must not block, and
/// do not apply to the program itself.
pub trait Rights: Debug + Send + Sync {
    /// Whether commands are accepted on this topic. Messages there are heard before they go on, and are never retained.
    fn is_for_commands(&self, topic: &str) -> bool;

    /// Whether a client may publish on this topic. Not asked for topics of commands, where the listener decides.
    fn may_publish(&self, who: Tier, topic: &str) -> bool;

    /// Whether a client may leave a will on this topic: wherever it may publish, but never a command, since nobody
    /// stands behind it when it is published.
    fn may_leave_will(&self, who: Tier, topic: &str) -> bool {
        !self.is_for_commands(topic) && self.may_publish(who, topic)
    }

    /// Whether a client may share this filter with others, each of which then gets only a part of the messages.
    fn may_share(&self, who: Tier, filter: &str) -> bool;
}
