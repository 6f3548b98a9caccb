//! The way out of the hall and back in. It begins at home. The entrance is behind a robot that stands there facing
//! south.

use super::{End, Sim};
use hallsweep_core::effect::Order;
use hallsweep_core::place::Place;
use hallsweep_core::units::Pose;

impl Sim {
    pub(super) fn begin_entering(&mut self, order: Order) {
        match self.outside {
            _ if self.is_off_centre() => self.fail(order.id, "it stands between two places: recentre first"),
            0 => self.fail(order.id, "it is in the hall"),
            1 => self.drive(order, 1.0, End::At(self.pose)),
            steps => self.drive(order, 1.0, End::Outside(steps - 1)),
        }
    }

    /// Drives one step backwards, through the entrance behind the robot or further out.
    pub(super) fn begin_leaving(&mut self, order: Order) {
        if self.is_off_centre() {
            self.fail(order.id, "it stands between two places: recentre first");
        } else if self.pose != Pose::START {
            self.fail(order.id, "the way out begins at home, facing south");
        } else if self.outside >= Place::FURTHEST {
            self.fail(order.id, "it is at the end of the way out");
        } else {
            self.drive(order, -1.0, End::Outside(self.outside + 1));
        }
    }
}
