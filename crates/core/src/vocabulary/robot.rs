//! The name of a robot, what it does, and what it is made of, as far as a mission cares: whoever wants something of a robot asks here
//! whether it has what it takes.

use std::sync::Arc;

/// The name by which settings, orders, reports and records mean one robot.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotId(Arc<str>);

impl RobotId {
    /// The longest name, in bytes: it stands in a topic, a path and a caption.
    pub const MOST: usize = 32;

    /// `text` as a name: 1 to `MOST` small letters, digits and hyphens, the first a letter; else `None`.
    #[must_use]
    pub fn new(text: &str) -> Option<RobotId> {
        let usable = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-';
        let begins = text.bytes().next().is_some_and(|first| first.is_ascii_lowercase());
        (begins && text.len() <= RobotId::MOST && text.bytes().all(usable)).then(|| RobotId(Arc::from(text)))
    }

    /// The robot that searches, where nothing else is said.
    #[must_use]
    pub fn discovery() -> RobotId {
        RobotId(Arc::from("discovery"))
    }

    /// The name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.0
    }
}

impl std::fmt::Display for RobotId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

named! {
    ALL by name;
    /// What a robot does, by the words of the seeds, which have none for an arm.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum RobotState {
        Stopped = "stopped",
        MovingForward = "movingForward",
        MovingBackward = "movingBackward",
        RotateLeft = "rotateLeft",
        RotateRight = "rotateRight",
        TakingPhoto = "takingPhoto",
        SendingPhoto = "sendingPhoto",
        MovingArm = "movingArm",
    }
}

named! {
    ALL by name;
    /// One thing that a robot may have.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Part {
        /// It drives.
        Base = "base",
        /// It takes photos.
        Camera = "camera",
        /// It measures how far it is to what is ahead.
        Sonar = "sonar",
        /// It has a light that can blink.
        Led = "led",
        /// It measures the temperature.
        Thermometer = "thermometer",
        /// It feels what it runs into.
        Bump = "bump",
        /// It reaches out.
        Arm = "arm",
        /// It takes hold of things.
        Gripper = "gripper",
        /// It says itself when a move has ended.
        AcknowledgedMoves = "acknowledgedMoves",
    }
}

/// A set of parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts(u16);

impl Parts {
    /// A round robot that searches: it drives, sees, measures and blinks.
    pub const ROUND_ROBOT: Parts =
        Parts::of(&[Part::Base, Part::Camera, Part::Sonar, Part::Led, Part::Thermometer, Part::Bump, Part::AcknowledgedMoves]);

    /// The same with a hook, by which it takes a piece onto its back.
    pub const ROUND_ROBOT_WITH_HOOK: Parts = Parts::ROUND_ROBOT.with(Part::Gripper);

    /// A robot that fetches: it drives, sees, reaches out and takes hold.
    pub const MANIPULATOR: Parts =
        Parts::of(&[Part::Base, Part::Camera, Part::Bump, Part::Arm, Part::Gripper, Part::AcknowledgedMoves]);

    /// These.
    #[must_use]
    pub const fn of(parts: &[Part]) -> Parts {
        let (mut set, mut n) = (0, 0);
        while n < parts.len() {
            set |= 1 << parts[n] as u16;
            n += 1;
        }
        Parts(set)
    }

    /// These and one more.
    #[must_use]
    pub const fn with(self, part: Part) -> Parts {
        Parts(self.0 | 1 << part as u16)
    }

    /// These but for one.
    #[must_use]
    pub const fn without(self, part: Part) -> Parts {
        Parts(self.0 & !(1 << part as u16))
    }

    /// Whether this is among them.
    #[must_use]
    pub const fn has(self, part: Part) -> bool {
        self.0 & (1 << part as u16) != 0
    }

    /// All that are in it, in the order of `Part::ALL`.
    pub fn iter(self) -> impl Iterator<Item = Part> {
        Part::ALL.into_iter().filter(move |part| self.has(*part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_has_what_was_put_into_it_and_nothing_else() {
        for part in Part::ALL {
            assert_eq!(Parts::of(&[part]).iter().collect::<Vec<_>>(), [part]);
        }
        assert!(!Parts::ROUND_ROBOT.has(Part::Gripper) && Parts::ROUND_ROBOT.has(Part::Camera));
    }
}
