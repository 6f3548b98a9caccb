//! Touches a known thing before an order, to find out the robot's own position. This is done when the robot has
//! driven far and faces a thing with a known place.

use std::time::Duration;

use super::reckoning::DRIFT;
use super::{Aim, VirtualRobot};

/// Distance along an axis since the last contact on that axis, in cells, after which the robot touches a thing.
const FAR: f64 = 3.0;

/// If a thing that certainly stands there is not met, the robot drives this number of additional cells, one by one.
const FURTHER: u8 = 2;

/// Share of an order's time that may be used for touching a thing and coming back.
const SHARE: f64 = 0.5;

impl VirtualRobot {
    /// Distance to the thing that the robot should touch now. The flag says whether the thing certainly stands there.
    /// `None` if the robot should not touch anything.
    pub(super) fn is_to_touch(&self, has: Duration) -> Option<(f64, bool)> {
        let heading = self.reckoning.pose().heading;
        let is_due = !self.off_centre && self.latency.is_some() && self.reckoning.driven(heading) >= FAR;
        let (way, is_certain) = self.reckoning.contact_ahead().filter(|_| is_due)?;
        let lasts = (self.step.mul_f64(way + DRIFT) + self.margin()) * 2;
        (lasts < has.mul_f64(SHARE)).then_some((way, is_certain))
    }

    pub(super) fn begin_touching(&mut self, way: f64, is_certain: bool) {
        self.aim(Aim::Touch { is_certain, further: 0 });
        self.drive(self.reckoning.pose().heading, way + DRIFT, false);
    }

    pub(super) fn not_touched(&mut self, is_certain: bool, further: u8) {
        self.off_centre = true;
        if !is_certain {
            self.reckoning.nothing_ahead();
            self.aim(Aim::Return);
            return self.go_back();
        }
        if further == FURTHER && self.room.is_some() {
            // The robot has not come as far as counted. The map is still right.
            return self.stands_before_it();
        }
        if further == FURTHER {
            return self.lose("it does not meet the obstacle ahead any more, so it has drifted");
        }
        let (towards, backward) = (self.moves_towards(), self.moves_backward());
        self.aim(Aim::Touch { is_certain, further: further + 1 });
        self.drive(towards, 1.0, backward);
    }

    pub(super) fn came_back_touched(&mut self) {
        self.off_centre = false;
        // Nothing is left to do if the order is to go back to the centre. Any other order begins now.
        self.aim(Aim::Back);
        if let Some(action) = self.task.as_ref().map(|task| task.action) {
            self.begin(action);
        }
    }
}
