//! Who may publish, subscribe and leave a will where. What a command is good for is judged by whoever hears it.

use super::topics::{PULSE, Place, Topics};
use crate::access::Role;
use mqtt_gate::rights::{Guest, Rights, Tier};

/// What somebody of this role is to the gate.
pub(super) const fn guest(role: Role) -> Guest {
    match role {
        Role::Operator => Guest::Client(Tier::Full),
        Role::Viewer => Guest::Client(Tier::Limited),
    }
}

impl Rights for Topics {
    fn is_for_commands(&self, topic: &str) -> bool {
        match self.place(topic) {
            Place::Command(_) | Place::Word | Place::Old => true,
            Place::Ours | Place::Elsewhere => false,
        }
    }

    fn may_publish(&self, who: Guest, topic: &str) -> bool {
        may_publish(who, self.place(topic))
    }

    /// To all but the broker's own pulse.
    fn may_subscribe(&self, who: Guest, filter: &str) -> bool {
        who == Guest::Program || filter != PULSE
    }

    fn may_see(&self, who: Guest, topic: &[u8]) -> bool {
        who == Guest::Program || topic != PULSE.as_bytes()
    }

    /// A will is no command: nobody stands behind it when it is read.
    fn may_leave_will(&self, who: Guest, topic: &str) -> bool {
        may_leave_will(who, self.place(topic))
    }
}

const fn may_publish(who: Guest, place: Place<'_>) -> bool {
    match (who, place) {
        (Guest::Program, _) | (Guest::Client(_), Place::Command(_) | Place::Word | Place::Old) => true,
        (Guest::Client(tier), Place::Elsewhere) => matches!(tier, Tier::Full),
        (Guest::Client(_), Place::Ours) => false,
    }
}

const fn may_leave_will(who: Guest, place: Place<'_>) -> bool {
    match place {
        Place::Command(_) | Place::Word | Place::Old => false,
        Place::Ours => matches!(who, Guest::Program),
        Place::Elsewhere => matches!(who, Guest::Program | Guest::Client(Tier::Full)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACES: [Place<'static>; 5] = [Place::Command("stop"), Place::Word, Place::Old, Place::Ours, Place::Elsewhere];

    fn of(what: impl Fn(Place<'static>) -> bool) -> [bool; 5] {
        PLACES.map(what)
    }

    #[test]
    fn only_the_program_itself_publishes_where_the_state_is() {
        let [house, operator, viewer] = [Guest::Program, guest(Role::Operator), guest(Role::Viewer)];
        assert_eq!(of(|place| may_publish(house, place)), [true; 5]);
        assert_eq!(of(|place| may_publish(operator, place)), [true, true, true, false, true]);
        assert_eq!(of(|place| may_publish(viewer, place)), [true, true, true, false, false]);
    }

    #[test]
    fn a_will_is_never_a_command_and_viewers_leave_none() {
        let [house, operator, viewer] = [Guest::Program, guest(Role::Operator), guest(Role::Viewer)];
        assert_eq!(of(|place| may_leave_will(house, place)), [false, false, false, true, true]);
        assert_eq!(of(|place| may_leave_will(operator, place)), [false, false, false, false, true]);
        assert_eq!(of(|place| may_leave_will(viewer, place)), [false; 5]);
    }

    #[test]
    fn the_pulse_is_for_the_program_alone() {
        let (topics, operator) = (Topics::new("hallsweep", "discovery", "unibo/qak"), guest(Role::Operator));
        assert!(topics.may_subscribe(Guest::Program, PULSE) && topics.may_see(Guest::Program, PULSE.as_bytes()));
        assert!(!topics.may_subscribe(operator, PULSE) && !topics.may_see(operator, PULSE.as_bytes()));
        assert!(topics.may_subscribe(operator, "#") && topics.may_see(operator, b"a"));
    }
}
