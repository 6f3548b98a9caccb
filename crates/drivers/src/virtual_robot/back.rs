//! The way back to the centre of its cell: along the way it faces, and, where its scene file says that it stands beside the centre,
//! across that too.

use super::measures::{CENTRED, FEELS};
use super::{Aim, TURN, VirtualRobot, Way};
use hallsweep_core::effect::Action;
use hallsweep_core::event::{RobotEvent, Whereabouts};
use hallsweep_core::units::Pose;

/// As far beside the centre it may stand, in cells: nearer than that it meets nothing that is not in its way.
const BESIDE: f64 = 0.15;

impl VirtualRobot {
    /// Senses, as far as that is needed, and goes back to the centre of its cell.
    pub(super) fn begin_recentring(&mut self) {
        if self.unheard.is_some() {
            self.aim(Aim::Feel);
            return self.drive(self.reckoning.pose().heading, FEELS, false);
        }
        self.go_back();
    }

    /// One leg further towards the centre of its cell, or the end of the order when it is there.
    pub(super) fn go_back(&mut self) {
        let Pose { cell, heading } = self.reckoning.pose();
        let ahead = self.reckoning.way_to(cell, heading);
        if ahead.abs() <= CENTRED {
            return if self.is_recentring() && self.room.is_some() { self.turn_aside() } else { self.came_back() };
        }
        if !matches!(self.task.as_ref().map(|task| task.aim), Some(Aim::Return | Aim::Gauged)) {
            self.aim(Aim::Back);
        }
        let cells = ahead.abs();
        if ahead > 0.0 { self.drive(heading, cells, false) } else { self.drive(heading.opposite(), cells, true) }
    }

    fn is_recentring(&self) -> bool {
        self.task.as_ref().is_some_and(|task| (task.action, task.aim) == (Action::Recentre, Aim::Back))
    }

    /// Who knows the room may know that it stands beside the centre as well. What lies there it is not to meet, so it turns towards the
    /// centre, and stays as it stands then.
    fn turn_aside(&mut self) {
        let Pose { cell, heading } = self.reckoning.pose();
        let right = self.reckoning.way_to(cell, heading.right());
        if right.abs() <= BESIDE {
            return self.came_back();
        }
        let (heading, left) = if right > 0.0 { (heading.right(), false) } else { (heading.left(), true) };
        self.aim(Aim::Aside(Pose { cell, heading }));
        self.set_out(Way::Turn { left, lasts: TURN });
    }

    pub(super) fn turned_aside(&mut self, pose: Pose, is_halted: bool) {
        self.reckoning.complete(pose);
        self.off_centre = true;
        self.events.push_back(RobotEvent::Stands(Whereabouts { pose, off_centre: true }));
        if is_halted {
            return self.answer(|order| RobotEvent::Halted(order, true));
        }
        self.aim(Aim::Back);
        self.go_back();
    }

    pub(super) fn came_back(&mut self) {
        match self.task.as_ref().map(|task| task.aim) {
            Some(Aim::Return) => return self.came_back_touched(),
            Some(Aim::Gauged) => return self.came_back_gauged(),
            _ => {}
        }
        self.off_centre = false;
        self.answer(RobotEvent::Done);
    }
}
