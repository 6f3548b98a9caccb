//! What the console says of the robots' doings, and of the one that searches: whether it is there, and what it is made of.

use super::view::View;
use hallsweep_core::mission::Hold;
use hallsweep_core::robots::{Part, Parts};
use hallsweep_core::world::robot::RobotState;

/// What it does nobody knows.
const UNREACHED: &str = "no link";

/// What is said of whoever was told to halt and has not said yet that it stands.
const HALTING: &str = "halting …";

impl View<'_> {
    /// What the robots do, in the bar: there a STOP is seen on a screen that has no room for what else holds them.
    pub(super) fn doing(&self) -> &'static str {
        let is_halting = self.snapshot.robot.halting || self.snapshot.robots.iter().any(|robot| robot.view.halting);
        let searching_stands = self.snapshot.robot.state == RobotState::Stopped;
        match self.is_still() {
            true if self.snapshot.mission.holds.contains(&Hold::Operator) => "held by STOP",
            false if is_halting => HALTING,
            false if searching_stands => "the pair moves",
            true | false => self.robot_state(),
        }
    }

    /// Why the robot that searches cannot be reached, while that is so.
    pub(super) fn unreached(&self) -> Option<&str> {
        self.snapshot.robots.first()?.unreached.as_deref()
    }

    /// What it is made of; `None` while there is no link.
    pub(super) fn parts(&self) -> Option<Parts> {
        self.snapshot.robots.first().and_then(|robot| robot.parts)
    }

    /// What its LED does.
    pub(super) fn led(&self) -> &'static str {
        match self.parts() {
            Some(parts) if !parts.has(Part::Led) => "none",
            Some(_) | None if self.snapshot.robot.led_blinking => "blinking",
            Some(_) | None => "off",
        }
    }

    /// The robot's state in words.
    pub(super) fn robot_state(&self) -> &'static str {
        if self.unreached().is_some() {
            return UNREACHED;
        }
        if self.snapshot.robot.halting {
            return HALTING;
        }
        match self.snapshot.robot.state {
            RobotState::Stopped => "stands still",
            RobotState::MovingForward => "moves forward",
            RobotState::MovingBackward => "moves backward",
            RobotState::RotateLeft => "turns left",
            RobotState::RotateRight => "turns right",
            RobotState::TakingPhoto => "takes a photo",
            RobotState::SendingPhoto => "sends the photo",
            RobotState::MovingArm => "moves its arm",
        }
    }
}
