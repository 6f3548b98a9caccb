//! Decides which clients may publish on which topics, or leave a last will there. Commands in messages are judged by
//! the listener of the connection.

use super::topics::{TopicKind, Topics};
use crate::access::Role;
use mqtt_gate::filter::overlap;
use mqtt_gate::{Rights, Tier};

pub(super) const fn tier(role: Role) -> Tier {
    match role {
        Role::Operator => Tier::Full,
        Role::Viewer => Tier::Limited,
    }
}

/// The rights at a broker with one hall. `topic_map` has the rights at a broker with several.
impl Rights for Topics {
    fn is_for_commands(&self, topic: &str) -> bool {
        is_for_commands(self.kind_of(topic))
    }

    fn may_publish(&self, who: Tier, topic: &str) -> bool {
        may_publish(who, self.kind_of(topic))
    }

    fn may_leave_will(&self, who: Tier, topic: &str) -> bool {
        may_leave_will(who, self.kind_of(topic))
    }

    /// Subscriptions to the program's own topics may not be shared, because each reader must get all messages.
    /// Viewers may share no subscription at all, because they would take messages away from other readers.
    fn may_share(&self, who: Tier, filter: &str) -> bool {
        who == Tier::Full && !self.ours().iter().any(|ours| overlap(filter, ours))
    }
}

pub(super) const fn is_for_commands(kind: TopicKind<'_>) -> bool {
    matches!(kind, TopicKind::Command(_) | TopicKind::Word | TopicKind::Old)
}

/// A will on a command topic is refused, because its sender is absent when it is published.
pub(super) fn may_leave_will(who: Tier, kind: TopicKind<'_>) -> bool {
    kind == TopicKind::Elsewhere && who == Tier::Full
}

pub(super) const fn may_publish(who: Tier, kind: TopicKind<'_>) -> bool {
    match kind {
        TopicKind::Command(_) | TopicKind::Word | TopicKind::Old => true,
        TopicKind::Elsewhere => matches!(who, Tier::Full),
        TopicKind::Ours => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_publishes_where_the_state_is_and_viewers_but_what_may_be_a_command() {
        let kinds = [TopicKind::Command("stop"), TopicKind::Word, TopicKind::Old, TopicKind::Ours, TopicKind::Elsewhere];
        assert_eq!(kinds.map(|kind| may_publish(tier(Role::Operator), kind)), [true, true, true, false, true]);
        assert_eq!(kinds.map(|kind| may_publish(tier(Role::Viewer), kind)), [true, true, true, false, false]);
    }

    #[test]
    fn a_will_is_never_a_command_nor_ours_and_viewers_leave_none() {
        let topics = Topics::new("hallsweep", "discovery", "unibo/qak");
        for (topic, is_allowed) in [
            ("hallsweep/discovery/command/stop", false),
            ("hallsweep/discovery/command", false),
            ("unibo/qak/events", false),
            ("hallsweep/discovery/state/robot", false),
            ("sensors/door", true),
        ] {
            assert_eq!(topics.may_leave_will(tier(Role::Operator), topic), is_allowed, "{topic}");
            assert!(!topics.may_leave_will(tier(Role::Viewer), topic), "{topic}");
        }
    }

    #[test]
    fn nobody_shares_what_the_program_says_with_others() {
        let topics = Topics::new("hallsweep", "discovery", "unibo/qak");
        let ours =
            ["#", "+/#", "hallsweep/#", "hallsweep/+/state/robot", "hallsweep/discovery", "unibo/+/events", "homeassistant/#"];
        assert_eq!(ours.map(|filter| topics.may_share(tier(Role::Operator), filter)), [false; 7]);
        for theirs in ["sensors/#", "+/door", "hallsweep/other/#"] {
            assert!(topics.may_share(tier(Role::Operator), theirs) && !topics.may_share(tier(Role::Viewer), theirs), "{theirs}");
        }
    }
}
