//! The room of the Roomba and its body: where the body is after one tick at given speeds, and when it touches a wall.
//! Phases and the counting of the floor are elsewhere.
//!
//! ```text
//!   (0, 0)  x ─►           The room has no cells. θ is 0 along x and grows clockwise, from x towards y,
//!     ┌──────────────┐     so a negative angle turns counterclockwise as seen from above.
//!   y │   ╭───╮      │     The centre of the body stays at least its radius from every wall.
//!   ▼ │   │ ──► θ=0  │
//!     │   ╰───╯      │ 4.8 m
//!     └──────────────┘
//!          6.4 m
//! ```

use hallsweep_sim::BodyPose;

/// Length of the room along x, in metres (docs/laboratory.md).
pub(super) const ROOM_LENGTH_M: f64 = 6.4;

/// Width of the room along y, in metres (docs/laboratory.md).
pub(super) const ROOM_WIDTH_M: f64 = 4.8;

/// Radius of the round body, in metres (docs/laboratory.md).
pub(super) const RADIUS_M: f64 = 0.17;

/// Number of ticks per second. In each tick the Roomba decides and moves once (docs/laboratory.md).
pub(super) const TICKS_PER_SECOND: u32 = 60;

/// Highest driving speed, in metres per second (docs/laboratory.md).
const MAX_LINEAR: f64 = 1.0;

/// Highest turning speed, in radians per second (docs/laboratory.md).
const MAX_ANGULAR: f64 = 2.0;

pub(super) const TICK_S: f64 = 1.0 / TICKS_PER_SECOND as f64;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Velocity {
    /// Forward speed in metres per second. Negative is backward.
    pub(super) linear: f64,
    /// Turning speed in radians per second. It has the same sign as the angle: positive is clockwise.
    pub(super) angular: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    pub(super) pose: BodyPose,
    /// Whether a wall cut the last move short. A body that only stands or turns beside a wall does not press the
    /// bumper.
    pub(super) bumper: bool,
}

impl Body {
    /// The middle of the room, facing along x (docs/laboratory.md).
    pub(super) const START: Body =
        Body { pose: BodyPose { x_m: ROOM_LENGTH_M / 2.0, y_m: ROOM_WIDTH_M / 2.0, theta: 0.0 }, bumper: false };

    /// The body after one tick at these speeds. A wall stops only the part of the move that is directed towards the
    /// wall.
    pub(super) fn driven(self, velocity: Velocity) -> Body {
        // Each speed is limited separately. If the body should turn too fast, it keeps its driving speed and drives a
        // wider curve.
        let linear = velocity.linear.clamp(-MAX_LINEAR, MAX_LINEAR);
        let angular = velocity.angular.clamp(-MAX_ANGULAR, MAX_ANGULAR);
        let free = self.pose.after(linear, angular, TICK_S);
        let x_m = free.x_m.clamp(RADIUS_M, ROOM_LENGTH_M - RADIUS_M);
        let y_m = free.y_m.clamp(RADIUS_M, ROOM_WIDTH_M - RADIUS_M);
        Body { pose: BodyPose { x_m, y_m, ..free }, bumper: x_m != free.x_m || y_m != free.y_m }
    }
}

pub(super) fn seconds(ticks: u32) -> f64 {
    f64::from(ticks) / f64::from(TICKS_PER_SECOND)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x_m: f64, y_m: f64, theta: f64) -> Body {
        Body { pose: BodyPose { x_m, y_m, theta }, bumper: false }
    }

    const AHEAD: Velocity = Velocity { linear: 0.5, angular: 0.0 };

    #[test]
    fn a_wall_stops_the_body_at_its_radius_and_presses_the_bumper() {
        let body = at(ROOM_LENGTH_M - RADIUS_M - 0.001, 2.4, 0.0).driven(AHEAD);
        assert_eq!((body.pose.x_m, body.pose.y_m, body.bumper), (6.4 - 0.17, 2.4, true));
        let corner = at(0.171, 0.171, -2.4).driven(AHEAD);
        assert_eq!((corner.pose.x_m, corner.pose.y_m, corner.bumper), (0.17, 0.17, true));
    }

    #[test]
    fn a_body_that_leaves_a_wall_or_turns_beside_it_is_not_pressed() {
        let pressed = at(0.17, 2.4, 3.0).driven(AHEAD);
        assert!(pressed.bumper);
        assert!(!pressed.driven(Velocity { linear: -0.1, angular: 0.0 }).bumper);
        assert!(!pressed.driven(Velocity { linear: 0.0, angular: 0.5 }).bumper);
        assert!(!pressed.driven(Velocity { linear: 0.0, angular: 0.0 }).bumper);
    }

    #[test]
    fn the_body_goes_no_faster_than_it_can_and_drives_on_where_it_cannot_turn_so_fast() {
        let fast = Body::START.driven(Velocity { linear: -7.0, angular: 0.0 });
        assert!((Body::START.pose.x_m - fast.pose.x_m - 1.0 / 60.0).abs() < 1e-12);
        let curve = Body::START.driven(Velocity { linear: 0.5, angular: 2.5 });
        assert_eq!(curve, Body::START.driven(Velocity { linear: 0.5, angular: 2.0 }));
        assert!((curve.pose.theta - 2.0 / 60.0).abs() < 1e-12);
        assert_eq!(Body::START.driven(Velocity { linear: 0.0, angular: -9.0 }).pose.theta, -2.0 / 60.0);
    }
}
