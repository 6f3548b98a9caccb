//! Measures how long the robot needs to drive the length of a cell, with the distances in the page's scene file. The
//! measurement is made once, when the first motion is ordered. The robot drives ahead until it meets something, and
//! then back.

use std::time::Duration;

use super::motion::{STEPS, TURNS_LATE, legs};
use super::{Aim, TURN, Then, VirtualRobot};
use hallsweep_core::event::RobotEvent;
use hallsweep_core::units::{Heading, Pose};

/// Shortest distance that is used for the measurement, in cells. On a shorter distance, a single frame of the page
/// would change the result too much.
const SHORTEST: f64 = 2.0;

/// Largest factor by which a page may be slower than the assumed time of a step. If even such a slow robot must have
/// met the thing ahead, but has met nothing, the scene file does not fit the room.
const SLOWER: f64 = 4.0;

/// Factor by which a step may take longer at the first contact: the robot drives to the thing, back, and to the thing
/// again. The factor can be small, because an order has at least the time of three steps.
const CONTACT: f64 = 1.3;

/// Factor by which a motion may take longer if the robot first finds out where it is.
const FINDING_OUT: f64 = 1.8;

/// Length of one leg of the measurement, in cells. A leg is a motion by one command.
const LEG: f64 = 1.0;

impl VirtualRobot {
    /// Plans a measurement. `ahead` is the distance from the robot's start to a thing, in cells.
    pub(super) fn gauge_by(&mut self, ahead: f64) {
        self.gauge = Some(ahead).filter(|ahead| *ahead >= SHORTEST && !self.is_gauged);
    }

    /// The longest time that a step can take. This includes a second contact if the latency is unknown, and the
    /// measurement of the step if it was not made yet.
    pub(super) fn longest_step(&self) -> Duration {
        let step = self.step + self.margin() * legs(self.step);
        let step = if self.latency.is_none() { step.mul_f64(CONTACT) } else { step };
        self.longest_gauging().unwrap_or_else(|| self.with_finding_out(step))
    }

    pub(super) fn longest_turn(&self) -> Duration {
        self.longest_gauging().unwrap_or_else(|| self.with_finding_out(TURN + TURNS_LATE + self.margin()))
    }

    /// Adds time for finding out where the robot is. This can happen only if the room is known.
    fn with_finding_out(&self, motion: Duration) -> Duration {
        if self.room.is_some() { motion.mul_f64(FINDING_OUT) } else { motion }
    }

    fn longest_gauging(&self) -> Option<Duration> {
        let leg = self.step + self.margin() * legs(self.step);
        self.gauge.map(|ahead| leg.mul_f64(2.0 * SLOWER * (ahead + 1.0)))
    }

    pub(super) fn is_to_be_gauged(&self) -> bool {
        self.gauge.is_some() && !self.off_centre && self.reckoning.pose() == Pose::START
    }

    /// Whether the step is being measured, so that lengths are counted with an assumed step.
    pub(super) fn is_gauging(&self) -> bool {
        let aim = self.task.as_ref().map(|task| task.aim);
        matches!(aim, Some(Aim::Gauge | Aim::Gauged | Aim::Retreat(Then::Gauged) | Aim::Measure(Then::Gauged)))
    }

    pub(super) fn begin_gauging(&mut self) {
        self.gauged = Duration::ZERO;
        self.aim(Aim::Gauge);
        self.gauge_on();
    }

    pub(super) fn gauge_on(&mut self) {
        let longest = self.gauge.unwrap_or_default() * SLOWER;
        if self.gauged.div_duration_f64(self.step) > longest {
            return self.lose_sight("it did not meet the obstacle ahead that its scene file shows");
        }
        self.drive(Heading::South, LEG, false);
    }

    /// Handles the contact at the end of the measurement. `driven` is the time of driving since the last leg began.
    pub(super) fn gauge_ends(&mut self, driven: Duration) {
        self.gauged += driven;
        if !self.is_met_as_it_should_be() {
            // The real distance is unknown, so it is computed with the assumed step. The way back needs this
            // distance.
            self.gauge = Some(self.gauged.div_duration_f64(self.step));
        }
        self.retreat(self.step.mul_f64(LEG), Then::Gauged);
    }

    pub(super) fn came_back_gauged(&mut self) {
        let Some(ahead) = self.gauge.take() else { return };
        let step = self.gauged.div_f64(ahead);
        if step.div_duration_f64(self.step) < SLOWER.recip() || step < STEPS[0] {
            return self.lose_sight("an obstacle is much nearer to its start than its scene file shows");
        }
        if step > STEPS[1] {
            return self.lose_sight("its page is too slow");
        }
        (self.step, self.is_gauged, self.off_centre, self.is_changed) = (step, true, false, true);
        self.reckoning.set_out_from_home();
        self.events.push_back(RobotEvent::LinkUp(self.can()));
        // Nothing is left to do if the order is to go back to the centre. Any other order begins now.
        self.aim(Aim::Back);
        if let Some(action) = self.task.as_ref().map(|task| task.action) {
            self.begin(action);
        }
    }
}
