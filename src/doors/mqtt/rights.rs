//! Who may publish, subscribe and leave a will where. What a command is good for is judged by whoever hears it.

use super::topics::{PULSE, TopicKind, Topics};
use crate::access::Role;
use mqtt_gate::{Principal, Rights, Tier};

/// What somebody of this role is to the gate.
pub(super) const fn principal(role: Role) -> Principal {
    match role {
        Role::Operator => Principal::Client(Tier::Full),
        Role::Viewer => Principal::Client(Tier::Limited),
    }
}

impl Rights for Topics {
    fn is_for_commands(&self, topic: &str) -> bool {
        match self.kind_of(topic) {
            TopicKind::Command(_) | TopicKind::Word | TopicKind::Old => true,
            TopicKind::Ours | TopicKind::Elsewhere => false,
        }
    }

    fn may_publish(&self, who: Principal, topic: &str) -> bool {
        may_publish(who, self.kind_of(topic))
    }

    /// To all but the broker's own pulse.
    fn may_subscribe(&self, who: Principal, filter: &str) -> bool {
        who == Principal::Program || filter != PULSE
    }

    fn may_see(&self, who: Principal, topic: &[u8]) -> bool {
        who == Principal::Program || topic != PULSE.as_bytes()
    }

    /// A will is no command: nobody stands behind it when it is read.
    fn may_leave_will(&self, who: Principal, topic: &str) -> bool {
        may_leave_will(who, self.kind_of(topic))
    }
}

const fn may_publish(who: Principal, kind: TopicKind<'_>) -> bool {
    match (who, kind) {
        (Principal::Program, _) | (Principal::Client(_), TopicKind::Command(_) | TopicKind::Word | TopicKind::Old) => true,
        (Principal::Client(tier), TopicKind::Elsewhere) => matches!(tier, Tier::Full),
        (Principal::Client(_), TopicKind::Ours) => false,
    }
}

const fn may_leave_will(who: Principal, kind: TopicKind<'_>) -> bool {
    match kind {
        TopicKind::Command(_) | TopicKind::Word | TopicKind::Old => false,
        TopicKind::Ours => matches!(who, Principal::Program),
        TopicKind::Elsewhere => matches!(who, Principal::Program | Principal::Client(Tier::Full)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [TopicKind<'static>; 5] =
        [TopicKind::Command("stop"), TopicKind::Word, TopicKind::Old, TopicKind::Ours, TopicKind::Elsewhere];

    fn of(what: impl Fn(TopicKind<'static>) -> bool) -> [bool; 5] {
        KINDS.map(what)
    }

    #[test]
    fn only_the_program_itself_publishes_where_the_state_is() {
        let [program, operator, viewer] = [Principal::Program, principal(Role::Operator), principal(Role::Viewer)];
        assert_eq!(of(|kind| may_publish(program, kind)), [true; 5]);
        assert_eq!(of(|kind| may_publish(operator, kind)), [true, true, true, false, true]);
        assert_eq!(of(|kind| may_publish(viewer, kind)), [true, true, true, false, false]);
    }

    #[test]
    fn a_will_is_never_a_command_and_viewers_leave_none() {
        let [program, operator, viewer] = [Principal::Program, principal(Role::Operator), principal(Role::Viewer)];
        assert_eq!(of(|kind| may_leave_will(program, kind)), [false, false, false, true, true]);
        assert_eq!(of(|kind| may_leave_will(operator, kind)), [false, false, false, false, true]);
        assert_eq!(of(|kind| may_leave_will(viewer, kind)), [false; 5]);
    }

    #[test]
    fn the_pulse_is_for_the_program_alone() {
        let (topics, operator) = (Topics::new("hallsweep", "discovery", "unibo/qak"), principal(Role::Operator));
        assert!(topics.may_subscribe(Principal::Program, PULSE) && topics.may_see(Principal::Program, PULSE.as_bytes()));
        assert!(!topics.may_subscribe(operator, PULSE) && !topics.may_see(operator, PULSE.as_bytes()));
        assert!(topics.may_subscribe(operator, "#") && topics.may_see(operator, b"a"));
    }
}
