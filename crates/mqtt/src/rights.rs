//! Who is at the other end of a connection, and what the program has to say of topics: who may publish, subscribe and leave a will
//! where, and where commands are taken. What a command is good for is judged by whoever hears it.

use std::fmt::Debug;

/// Who is at the other end of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Principal {
    /// The program that runs the broker: it has room of its own, may send long packets, and waits for nobody.
    Program,
    /// Somebody who was let in.
    Client(Tier),
}

/// How large a part of what clients have in common one of them may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tier {
    /// A full share.
    Full,
    /// A small one, of a part that all such have together: for those who only look, say.
    Limited,
}

/// What the program has to say of topics. It is asked once for each topic that a client changes to, and must not block.
pub trait Rights: Debug + Send + Sync {
    /// Whether commands are taken there: such a message is heard before it goes on, and is never kept.
    fn is_for_commands(&self, topic: &str) -> bool;

    /// Whether one may publish there. Clients are not asked about where commands are taken: whoever hears those decides.
    fn may_publish(&self, who: Principal, topic: &str) -> bool;

    /// Whether one may subscribe to a filter.
    fn may_subscribe(&self, who: Principal, filter: &str) -> bool;

    /// Whether one sees what is published on a topic that a filter of his matches; everybody does, if nothing else is said.
    fn may_see(&self, who: Principal, topic: &[u8]) -> bool {
        let _ = (who, topic);
        true
    }

    /// Whether one may leave a will there: where he may publish, and never a command, since nobody stands behind it when it is read.
    fn may_leave_will(&self, who: Principal, topic: &str) -> bool {
        !self.is_for_commands(topic) && self.may_publish(who, topic)
    }
}
