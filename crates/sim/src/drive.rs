//! Kinematics of a robot with two wheels: computes the place of the body from the wheel speeds, exactly. Obstacles
//! are not known here.
//!
//! ```text
//!        x (east) ─►            v = r (ωl + ωr) / 2     metres a second, forward
//!      y │   ▯──┬──▯            ω = r (ωl − ωr) / axle  radians a second, clockwise, because y grows to the south
//!        ▼  left │ right        ω = 0: a straight line; else: an arc of radius v / ω
//! ```

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::time::Duration;

use hallsweep_core::units::{Heading, Pose};

/// Where the body really is. In a hall, (0, 0) is the centre of the home cell. In the Roomba's room, it is the
/// north-west corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPose {
    /// Metres to the east of (0, 0).
    pub x_m: f64,
    /// Metres to the south of (0, 0).
    pub y_m: f64,
    /// Heading: radians clockwise from the east, as seen from above, in `-π..=π`.
    pub theta: f64,
}

impl BodyPose {
    /// Puts the body at the centre of a cell with sides of `cell_m` metres. It faces exactly along the heading.
    #[must_use]
    pub fn centred(pose: Pose, cell_m: f64) -> BodyPose {
        let theta = match pose.heading {
            Heading::North => -FRAC_PI_2,
            Heading::East => 0.0,
            Heading::South => FRAC_PI_2,
            Heading::West => PI,
        };
        BodyPose { x_m: f64::from(pose.cell.x) * cell_m, y_m: f64::from(pose.cell.y) * cell_m, theta }
    }

    /// The vector of length 1 in the direction of the heading.
    #[must_use]
    pub fn ahead(self) -> (f64, f64) {
        (self.theta.cos(), self.theta.sin())
    }

    /// Where the body is after `t` seconds, at `v` metres a second forward and `omega` radians a second clockwise.
    #[must_use]
    pub fn after(self, v: f64, omega: f64, t: f64) -> BodyPose {
        if omega == 0.0 {
            let (dx, dy) = self.ahead();
            return BodyPose { x_m: self.x_m + v * t * dx, y_m: self.y_m + v * t * dy, theta: self.theta };
        }
        let theta = self.theta + omega * t;
        let radius = v / omega;
        let x_m = self.x_m + radius * (theta.sin() - self.theta.sin());
        let y_m = self.y_m - radius * (theta.cos() - self.theta.cos());
        BodyPose { x_m, y_m, theta: normal(theta) }
    }
}

/// Speeds of the two wheels, in radians a second. A positive speed drives forward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wheels {
    pub(super) left: f64,
    pub(super) right: f64,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Chassis {
    pub(super) wheel_radius_m: f64,
    pub(super) axle_m: f64,
}

impl Chassis {
    /// The wheel speeds for driving straight on at `v` metres a second. A negative `v` drives backwards.
    pub(super) fn straight(self, v: f64) -> Wheels {
        Wheels { left: v / self.wheel_radius_m, right: v / self.wheel_radius_m }
    }

    /// The wheel speeds for turning on the spot at `omega` radians a second. A positive `omega` turns clockwise.
    pub(super) fn spin(self, omega: f64) -> Wheels {
        let speed = omega * self.axle_m / (2.0 * self.wheel_radius_m);
        Wheels { left: speed, right: -speed }
    }

    pub(super) fn after(self, from: BodyPose, wheels: Wheels, time: Duration) -> BodyPose {
        let v = self.wheel_radius_m * (wheels.left + wheels.right) / 2.0;
        let omega = self.wheel_radius_m * (wheels.left - wheels.right) / self.axle_m;
        from.after(v, omega, time.as_secs_f64())
    }
}

/// Returns the same angle in `-π..=π`.
#[must_use]
pub fn normal(angle: f64) -> f64 {
    // An angle within these limits is returned unchanged to the last bit. So a body that has not moved still equals
    // its exact centred pose.
    if angle.abs() <= PI {
        return angle;
    }
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}

/// A motion with constant wheel speeds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) from: BodyPose,
    pub(super) wheels: Wheels,
    /// When the motion began, counted from the start of the run.
    pub(super) began: Duration,
    pub(super) ends: Duration,
}

impl Motion {
    pub(super) fn at(&self, chassis: Chassis, now: Duration) -> BodyPose {
        chassis.after(self.from, self.wheels, now.min(self.ends).saturating_sub(self.began))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::Cell;

    const CHASSIS: Chassis = Chassis { wheel_radius_m: 0.05, axle_m: 0.3 };

    fn check(wheels: Wheels, seconds: f64, expect: (f64, f64, f64)) {
        let from = BodyPose::centred(Pose { cell: Cell::HOME, heading: Heading::East }, 0.5);
        let to = CHASSIS.after(from, wheels, Duration::from_secs_f64(seconds));
        let error = (to.x_m - expect.0).abs() + (to.y_m - expect.1).abs() + normal(to.theta - expect.2).abs();
        assert!(error < 1e-9, "{to:?}");
    }

    #[test]
    fn equal_wheels_drive_straight_and_opposite_ones_turn_on_the_spot() {
        check(Wheels { left: 10.0, right: 10.0 }, 2.0, (1.0, 0.0, 0.0));
        check(CHASSIS.straight(-0.5), 1.0, (-0.5, 0.0, 0.0));
        check(CHASSIS.spin(FRAC_PI_2), 1.0, (0.0, 0.0, FRAC_PI_2));
    }

    #[test]
    fn unequal_wheels_drive_an_arc() {
        // v = 0.45 m/s and ω = 1 rad/s to the right. The quarter circle of radius 0.45 m ends in the south-east,
        // facing south.
        check(Wheels { left: 12.0, right: 6.0 }, FRAC_PI_2, (0.45, 0.45, FRAC_PI_2));
        check(Wheels { left: 6.0, right: 12.0 }, FRAC_PI_2, (0.45, -0.45, -FRAC_PI_2));
    }

    #[test]
    fn many_small_arcs_give_the_same_as_one() {
        let wheels = Wheels { left: 9.0, right: 7.0 };
        let from = BodyPose { x_m: 1.0, y_m: 2.0, theta: 0.3 };
        let once = CHASSIS.after(from, wheels, Duration::from_millis(800));
        let many = (0..800).fold(from, |pose, _| CHASSIS.after(pose, wheels, Duration::from_millis(1)));
        assert!((once.x_m - many.x_m).abs() + (once.y_m - many.y_m).abs() + (once.theta - many.theta).abs() < 1e-9);
    }
}
