//! The name of a robot, its state, and its parts. A robot gets a task only if it has the parts that the task needs.

use std::sync::Arc;

use super::hall::is_plain;

/// The name of a robot in settings, orders, reports and records.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotId(Arc<str>);

impl RobotId {
    /// Maximum length of a name, in bytes. The name appears in a topic, a path and a caption.
    pub const MOST: usize = 32;

    /// Returns `None` unless the text has 1 to `MOST` small letters, digits and hyphens, and begins with a letter.
    #[must_use]
    pub fn new(text: &str) -> Option<RobotId> {
        is_plain(text, RobotId::MOST).then(|| RobotId(Arc::from(text)))
    }

    /// The default name of the robot that searches.
    #[must_use]
    pub fn discovery() -> RobotId {
        RobotId(Arc::from("discovery"))
    }

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
    /// What a robot is doing. All names are from the original specification, except `movingArm`: that specification
    /// has no arm.
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
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Part {
        Base = "base",
        Camera = "camera",
        Sonar = "sonar",
        Led = "led",
        Thermometer = "thermometer",
        /// The robot notices when it runs into something.
        Bump = "bump",
        Arm = "arm",
        Gripper = "gripper",
        /// The robot reports the end of a move.
        AcknowledgedMoves = "acknowledgedMoves",
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts(u16);

impl Parts {
    /// The parts of a robot that searches.
    pub const ROUND_ROBOT: Parts =
        Parts::of(&[Part::Base, Part::Camera, Part::Sonar, Part::Led, Part::Thermometer, Part::Bump, Part::AcknowledgedMoves]);

    /// The parts of a robot that searches and has a hook. With the hook it takes a piece onto its back.
    pub const ROUND_ROBOT_WITH_HOOK: Parts = Parts::ROUND_ROBOT.with(Part::Gripper);

    /// The parts of each robot of the pair that fetches.
    pub const MANIPULATOR: Parts =
        Parts::of(&[Part::Base, Part::Camera, Part::Bump, Part::Arm, Part::Gripper, Part::AcknowledgedMoves]);

    #[must_use]
    pub const fn of(parts: &[Part]) -> Parts {
        let (mut set, mut n) = (0, 0);
        while n < parts.len() {
            set |= 1 << parts[n] as u16;
            n += 1;
        }
        Parts(set)
    }

    #[must_use]
    pub const fn with(self, part: Part) -> Parts {
        Parts(self.0 | 1 << part as u16)
    }

    #[must_use]
    pub const fn without(self, part: Part) -> Parts {
        Parts(self.0 & !(1 << part as u16))
    }

    #[must_use]
    pub const fn has(self, part: Part) -> bool {
        self.0 & (1 << part as u16) != 0
    }

    /// Returns the parts in the order of `Part::ALL`.
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
