//! The first reports of a simulated robot: where it stands and what it can do.

use std::time::Duration;

use super::super::settings::SimSettings;
use super::Sim;
use hallsweep_core::event::{Capabilities, RobotEvent, Whereabouts};
use hallsweep_core::robot::{Part, Parts};

impl Sim {
    /// Queues the first reports after the link is up: the place, the hook if there is one, then the capabilities.
    pub(super) fn introduce(&mut self) {
        let off_centre = self.is_off_centre();
        let stands = match self.outside {
            0 => RobotEvent::Stands(Whereabouts { pose: self.pose, off_centre }),
            steps => RobotEvent::StandsOutside(steps, self.pose.heading, off_centre),
        };
        self.events.push_back(stands);
        self.tell_hook();
        self.events.push_back(RobotEvent::LinkUp(self.capabilities()));
    }

    /// What the robot can do, with times in simulated time.
    #[must_use]
    pub const fn capabilities(&self) -> Capabilities {
        let SimSettings { step, turn, photo, has_hook, hook, .. } = self.settings;
        let (arm, parts) = if has_hook { (hook, Parts::ROUND_ROBOT_WITH_HOOK) } else { (Duration::ZERO, Parts::ROUND_ROBOT) };
        let parts = if self.faults.no_thermometer { parts.without(Part::Thermometer) } else { parts };
        Capabilities { step, turn, photo, arm, nudges: false, parts }
    }

    pub fn tell_capabilities(&mut self) {
        self.events.push_back(RobotEvent::LinkUp(self.capabilities()));
    }
}
