//! Who somebody is, and what the program has to say of topics: who may publish and leave a will where, and where commands are taken.
//! What a command is good for is judged by whoever hears it.

use std::fmt::Debug;
use std::sync::Arc;

/// How large a part of what clients have in common one of them may use, and what he may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tier {
    /// A full share.
    Full,
    /// A small one, of a part that all such have together: for those who only look, say.
    Limited,
}

/// At whose cost something is kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Payer {
    /// The program that runs the broker: it has room of its own.
    Program,
    /// Somebody where nobody signs in: no share can be told from another.
    Anybody,
    /// Whoever has this key.
    Key(Arc<str>),
}

/// What the program has to say of topics, which is asked once for each topic that a client changes to, and must not block. The program
/// itself is asked nothing.
pub trait Rights: Debug + Send + Sync {
    /// Whether commands are taken there: such a message is heard before it goes on, and is never kept.
    fn is_for_commands(&self, topic: &str) -> bool;

    /// Whether one may publish there. Nobody is asked about where commands are taken: whoever hears those decides.
    fn may_publish(&self, who: Tier, topic: &str) -> bool;

    /// Whether one may leave a will there: where he may publish, and never a command, since nobody stands behind it when it is read.
    fn may_leave_will(&self, who: Tier, topic: &str) -> bool {
        !self.is_for_commands(topic) && self.may_publish(who, topic)
    }

    /// Whether one may share this filter with others, each of whom gets then only a part of what is published there.
    fn may_share(&self, who: Tier, filter: &str) -> bool;
}
