//! Touching a known thing before an order: a robot that has driven far and faces something whose place is known touches
//! it to find out where it is.

use std::time::Duration;

use super::reckoning::DRIFT;
use super::{Aim, VirtualRobot};

/// Cells driven on an axis since the last contact on it, from which on the robot touches what it can.
const FAR: f64 = 3.0;

/// Cells that it goes on, one after the other, when a thing that certainly stands there is not met.
const FURTHER: u8 = 2;

/// Share of the order's time that touching may take, there and back.
const SHARE: f64 = 0.5;

impl VirtualRobot {
    /// Distance to what it should touch now, if anything, and whether that certainly stands there.
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
            // It is not as far as was counted, and no report contradicts the room.
            return self.stands_before_it();
        }
        if further == FURTHER {
            return self.lose("what stood ahead of it is not met any more, so it has drifted");
        }
        let (towards, backward) = (self.moves_towards(), self.moves_backward());
        self.aim(Aim::Touch { is_certain, further: further + 1 });
        self.drive(towards, 1.0, backward);
    }

    pub(super) fn came_back_touched(&mut self) {
        self.off_centre = false;
        // An order to go back to the centre is complete here.
        self.aim(Aim::Back);
        if let Some(action) = self.task.as_ref().map(|task| task.action) {
            self.begin(action);
        }
    }
}
