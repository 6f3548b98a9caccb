//! What the scene file of the page tells: where everything stands, and so how long a cell takes. That is found out once, with the first
//! motion that is ordered: ahead until something is met, and back.

use std::time::Duration;

use super::motion::{STEPS, TURNS_LATE, legs};
use super::{Aim, TURN, Then, VirtualRobot};
use hallsweep_core::event::RobotEvent;
use hallsweep_core::units::{Heading, Pose};

/// Over a shorter way, in cells, a frame of the page more or less counts too much.
const SHORTEST: f64 = 2.0;

/// A page may be so many times slower than it was made for; what is slower still, or does not meet anything, is of another scene.
const SLOWER: f64 = 4.0;

/// So much longer than a step its first contact takes, of three times of a step that an order has at least: there, back, and there again.
const CONTACT: f64 = 1.3;

/// So much longer a motion may take before which it finds out where it is.
const FINDING_OUT: f64 = 1.8;

/// A leg is a cell at most.
const LEG: f64 = 1.0;

impl VirtualRobot {
    /// It is so far to what stands ahead of its start.
    pub(super) fn gauge_by(&mut self, ahead: f64) {
        self.gauge = Some(ahead).filter(|ahead| *ahead >= SHORTEST && !self.is_gauged);
    }

    /// The longest time that an order of one cell may take: the first contact is made twice, and gauging is done with the first motion.
    pub(super) fn longest_step(&self) -> Duration {
        let step = self.step + self.margin() * legs(self.step);
        let step = if self.latency.is_none() { step.mul_f64(CONTACT) } else { step };
        self.longest_gauging().unwrap_or_else(|| self.with_finding_out(step))
    }

    pub(super) fn longest_turn(&self) -> Duration {
        self.longest_gauging().unwrap_or_else(|| self.with_finding_out(TURN + TURNS_LATE + self.margin()))
    }

    /// Who knows the room may go some way to find out where it is.
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

    /// Whether lengths are counted by a step that is not gauged yet.
    pub(super) fn is_gauging(&self) -> bool {
        let aim = self.task.as_ref().map(|task| task.aim);
        matches!(aim, Some(Aim::Gauge | Aim::Gauged | Aim::Retreat(Then::Gauged) | Aim::Measure(Then::Gauged)))
    }

    pub(super) fn begin_gauging(&mut self) {
        self.gauged = Duration::ZERO;
        self.aim(Aim::Gauge);
        self.gauge_on();
    }

    /// One leg further.
    pub(super) fn gauge_on(&mut self) {
        let longest = self.gauge.unwrap_or_default() * SLOWER;
        if self.gauged.div_duration_f64(self.step) > longest {
            return self.lose_sight("what its scene file says that stands ahead is not met");
        }
        self.drive(Heading::South, LEG, false);
    }

    /// Something was met; it has driven so long since its last leg.
    pub(super) fn gauge_ends(&mut self, driven: Duration) {
        self.gauged += driven;
        if !self.is_met_as_it_should_be() {
            // How far that is nobody knows: by it a step is as long as it was taken to be.
            self.gauge = Some(self.gauged.div_duration_f64(self.step));
        }
        self.retreat(self.step.mul_f64(LEG), Then::Gauged);
    }

    /// Back at its start, it knows how long a cell takes; now for what was ordered.
    pub(super) fn came_back_gauged(&mut self) {
        let Some(ahead) = self.gauge.take() else { return };
        let step = self.gauged.div_f64(ahead);
        if step.div_duration_f64(self.step) < SLOWER.recip() || step < STEPS[0] {
            return self.lose_sight("something stands much nearer to its start than its scene file says");
        }
        if step > STEPS[1] {
            return self.lose_sight("its page is slower than any that shows a robot");
        }
        (self.step, self.is_gauged, self.off_centre, self.is_changed) = (step, true, false, true);
        self.reckoning.set_out_from_home();
        self.events.push_back(RobotEvent::LinkUp(self.can()));
        // Who was to go back to the centre is there.
        self.aim(Aim::Back);
        if let Some(action) = self.task.as_ref().map(|task| task.action) {
            self.begin(action);
        }
    }
}
