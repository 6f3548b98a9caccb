//! Who may publish, subscribe and leave a will where. What a command is good for is judged by whoever hears it.

use crate::access::Role;
use crate::doors::mqtt::topics::{PULSE, Place};

/// Who is at the other end of a connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guest {
    /// The program itself.
    House,
    /// Somebody who was let in.
    Somebody(Role),
}

impl Guest {
    /// Whether it may publish there.
    #[must_use]
    pub const fn may_publish(self, place: Place<'_>) -> bool {
        match (self, place) {
            (Guest::House, _) | (Guest::Somebody(_), Place::Command(_) | Place::Word | Place::Old) => true,
            (Guest::Somebody(role), Place::Elsewhere) => matches!(role, Role::Operator),
            (Guest::Somebody(_), Place::Ours) => false,
        }
    }

    /// Whether it may subscribe to a filter: to all but the broker's own pulse.
    #[must_use]
    pub fn may_subscribe(self, filter: &str) -> bool {
        self == Guest::House || filter != PULSE
    }

    /// Whether it sees what is published on a topic that a filter of its matches.
    #[must_use]
    pub fn may_see(self, topic: &[u8]) -> bool {
        self == Guest::House || topic != PULSE.as_bytes()
    }

    /// Whether it may leave a will there. A will is no command: nobody stands behind it when it is read.
    #[must_use]
    pub const fn may_leave_will(self, place: Place<'_>) -> bool {
        match place {
            Place::Command(_) | Place::Word | Place::Old => false,
            Place::Ours => matches!(self, Guest::House),
            Place::Elsewhere => matches!(self, Guest::House | Guest::Somebody(Role::Operator)),
        }
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
        let [house, operator, viewer] = [Guest::House, Guest::Somebody(Role::Operator), Guest::Somebody(Role::Viewer)];
        assert_eq!(of(|place| house.may_publish(place)), [true; 5]);
        assert_eq!(of(|place| operator.may_publish(place)), [true, true, true, false, true]);
        assert_eq!(of(|place| viewer.may_publish(place)), [true, true, true, false, false]);
    }

    #[test]
    fn a_will_is_never_a_command_and_viewers_leave_none() {
        let [house, operator, viewer] = [Guest::House, Guest::Somebody(Role::Operator), Guest::Somebody(Role::Viewer)];
        assert_eq!(of(|place| house.may_leave_will(place)), [false, false, false, true, true]);
        assert_eq!(of(|place| operator.may_leave_will(place)), [false, false, false, false, true]);
        assert_eq!(of(|place| viewer.may_leave_will(place)), [false; 5]);
    }

    #[test]
    fn the_pulse_is_for_the_program_alone() {
        let operator = Guest::Somebody(Role::Operator);
        assert!(Guest::House.may_subscribe(PULSE) && Guest::House.may_see(PULSE.as_bytes()));
        assert!(!operator.may_subscribe(PULSE) && !operator.may_see(PULSE.as_bytes()));
        assert!(operator.may_subscribe("#") && operator.may_see(b"a"));
    }
}
