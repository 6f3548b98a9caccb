//! The four phases of the Roomba of the original specification (seed 001), with the speeds during each. The state
//! machine and the behaviour tree decide which phase comes next.

use std::f64::consts::{PI, TAU};

use super::room::{TICK_S, TICKS_PER_SECOND, Velocity, seconds};
use hallsweep_core::rng::RandomStream;

/// Speed forward and in a spiral, in metres per second (docs/laboratory.md).
const FORWARD_SPEED: f64 = 0.5;

/// Duration of MoveForward, in seconds. It is t1 of the original specification.
const FORWARD_S: u32 = 3;

/// Duration of a spiral, in seconds. It is t2 of the original specification.
const SPIRAL_S: u32 = 20;

/// Radius at the beginning of a spiral, in metres. It is r0 of the original specification.
const SPIRAL_START_M: f64 = 0.2;

/// How fast the radius of a spiral grows, in metres per second. It is b of the original specification.
const SPIRAL_GROWTH: f64 = 0.05;

/// Speed backward, in metres per second (docs/laboratory.md).
const BACK_SPEED: f64 = 0.1;

/// Duration of GoBack, in ticks: half a second. It is t3 of the original specification.
const BACK_TICKS: u32 = TICKS_PER_SECOND / 2;

/// Speed of a turn, in radians per second (docs/laboratory.md).
const TURN_SPEED: f64 = 0.5;

/// Name of the random stream of the angles. One angle is drawn at the beginning of each turn.
pub(super) const TURNS: &str = "roomba turns";

/// A phase of the Roomba's behaviour: a state of the machine, and also a leaf of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phase {
    MoveForward,
    MoveInSpiral,
    /// Drives straight back from the wall that the robot touched.
    GoBack,
    /// Turns by a random angle.
    Rotate,
}

impl Phase {
    /// All phases, in the order of the original specification.
    pub const ALL: [Phase; 4] = [Phase::MoveForward, Phase::MoveInSpiral, Phase::GoBack, Phase::Rotate];

    /// The name of the phase on the page, in figures and in the file of the tree.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Phase::MoveForward => "MoveForward",
            Phase::MoveInSpiral => "MoveInSpiral",
            Phase::GoBack => "GoBack",
            Phase::Rotate => "Rotate",
        }
    }

    pub(super) const fn heeds_bumper(self) -> bool {
        match self {
            Phase::MoveForward | Phase::MoveInSpiral => true,
            Phase::GoBack | Phase::Rotate => false,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    pub(super) phase: Phase,
    pub(super) ticks: u32,
    /// Angle of the turn, in radians in `-π..π`. `None` in other phases.
    pub(super) angle: Option<f64>,
}

impl Motion {
    /// Begins a phase. Only `Rotate` draws a random number.
    pub(super) fn begin(phase: Phase, turns: &mut RandomStream) -> Motion {
        let angle = match phase {
            Phase::Rotate => Some(TAU * turns.fraction() - PI),
            Phase::MoveForward | Phase::MoveInSpiral | Phase::GoBack => None,
        };
        Motion { phase, ticks: 0, angle }
    }

    /// Whether a wall ends the phase. In its first tick, a phase ignores the bumper, because the phase before met
    /// that wall. So each phase lasts at least one tick.
    pub(super) const fn meets_wall(&self, bumper: bool) -> bool {
        bumper && self.ticks > 0 && self.phase.heeds_bumper()
    }

    pub(super) fn is_over(&self) -> bool {
        match self.phase {
            Phase::MoveForward => self.ticks >= FORWARD_S * TICKS_PER_SECOND,
            Phase::MoveInSpiral => self.ticks >= SPIRAL_S * TICKS_PER_SECOND,
            Phase::GoBack => self.ticks >= BACK_TICKS,
            Phase::Rotate => self.ticks > 0 && self.left_to_turn() == 0.0,
        }
    }

    /// Returns the speeds of the next tick, and counts the tick.
    pub(super) fn tick(&mut self) -> Velocity {
        let velocity = match self.phase {
            Phase::MoveForward => Velocity { linear: FORWARD_SPEED, angular: 0.0 },
            Phase::MoveInSpiral => {
                let radius = SPIRAL_START_M + SPIRAL_GROWTH * seconds(self.ticks);
                // In the first second, the radius is below 0.25 m and the body cannot turn that fast. It then drives
                // a circle of 0.25 m.
                Velocity { linear: FORWARD_SPEED, angular: FORWARD_SPEED / radius }
            }
            Phase::GoBack => Velocity { linear: -BACK_SPEED, angular: 0.0 },
            Phase::Rotate => {
                // The last tick turns by the angle that is left, so that the total is exact.
                let step = self.left_to_turn().min(TURN_SPEED * TICK_S);
                Velocity { linear: 0.0, angular: (step / TICK_S).copysign(self.angle.unwrap_or_default()) }
            }
        };
        self.ticks = self.ticks.saturating_add(1);
        velocity
    }

    /// The angle that is still to turn, in radians, without its sign.
    fn left_to_turn(&self) -> f64 {
        let whole = self.angle.map_or(0.0, f64::abs);
        (whole - TURN_SPEED * seconds(self.ticks)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::room::Body;
    use super::*;

    /// Drives a whole phase from the middle of a room, far from walls. Returns the body and the duration in ticks.
    fn driven(mut motion: Motion) -> (Body, u32) {
        let mut body = Body::START;
        while !motion.is_over() {
            body = body.driven(motion.tick());
            assert!(!body.bumper, "no wall is as near as that");
        }
        (body, motion.ticks)
    }

    fn of(phase: Phase) -> Motion {
        Motion { phase, ticks: 0, angle: None }
    }

    #[test]
    fn three_seconds_forward_are_a_metre_and_a_half() {
        let (body, ticks) = driven(of(Phase::MoveForward));
        assert_eq!(ticks, 180);
        assert!((body.pose.x_m - 4.7).abs() < 1e-9 && body.pose.y_m == 2.4, "{body:?}");
    }

    #[test]
    fn half_a_second_back_is_five_centimetres() {
        let (body, ticks) = driven(of(Phase::GoBack));
        assert_eq!(ticks, 30);
        assert!((body.pose.x_m - 3.15).abs() < 1e-9 && body.pose.theta == 0.0, "{body:?}");
    }

    #[test]
    fn a_turn_meets_its_angle_in_its_direction_and_takes_the_angle_divided_by_its_speed() {
        for angle in [-PI, -1.0, -0.001, 0.001, 0.7, 3.1] {
            let (body, ticks) = driven(Motion { phase: Phase::Rotate, ticks: 0, angle: Some(angle) });
            assert!((body.pose.theta - angle).abs() < 1e-9, "{angle}: {body:?}");
            assert!((0.0..=1.0 + 1e-9).contains(&(f64::from(ticks) - angle.abs() / TURN_SPEED * 60.0)), "{angle}: {ticks} ticks");
            let first = Motion { phase: Phase::Rotate, ticks: 0, angle: Some(angle) }.tick();
            assert_eq!(first.angular.signum(), angle.signum(), "the short way is not taken, the way of the sign is");
        }
    }

    #[test]
    fn a_turn_by_nothing_takes_a_tick() {
        let (body, ticks) = driven(Motion { phase: Phase::Rotate, ticks: 0, angle: Some(0.0) });
        assert_eq!((body.pose, ticks), (Body::START.pose, 1));
    }

    /// ω = v / (r0 + b·t) is above 2 rad/s until r = v / 2 = 0.25 m, which is at t = (0.25 − 0.2) / 0.05 = 1 s. Until
    /// then the body turns by 2 rad. After that it turns by ∫ v / (r0 + b·t) dt = (v / b) ln(r(20) / r(1)) = 10
    /// ln(1.2 / 0.25).
    #[test]
    fn a_spiral_turns_at_most_by_what_the_body_can_in_its_first_second_and_by_the_integral_from_there() {
        let (mut motion, mut body, mut turned) = (of(Phase::MoveInSpiral), Body::START, 0.0);
        let mut after_a_second = 0.0;
        while !motion.is_over() {
            let before = body.pose.theta;
            body = body.driven(motion.tick());
            turned += hallsweep_sim::normal(body.pose.theta - before);
            if motion.ticks == 60 {
                after_a_second = turned;
            }
        }
        assert_eq!(motion.ticks, 1200);
        assert!((after_a_second - 2.0).abs() < 1e-9, "{after_a_second}");
        // Each tick uses the turning speed at its beginning, and this speed never rises. So the sum is greater than
        // the integral, but by less than one tick at the highest speed.
        let above = turned - 2.0 - 10.0 * (1.2_f64 / 0.25).ln();
        assert!((0.0..2.0 / 60.0).contains(&above), "{above}");
    }

    /// With very short ticks, the path is ∫ (cos θ, sin θ) v dt. Here θ(t) = 2t up to 1 s, and later 2 + 10 ln((0.2 +
    /// 0.05 t) / 0.25).
    #[test]
    fn a_spiral_ends_where_the_integral_of_its_curve_does() {
        let heading = |t: f64| if t < 1.0 { 2.0 * t } else { 2.0 + 10.0 * ((0.2 + 0.05 * t) / 0.25).ln() };
        let step = 1e-4;
        let (x, y) = (0..200_000)
            .map(|n| heading((f64::from(n) + 0.5) * step))
            .fold((0.0, 0.0), |(x, y), theta| (x + FORWARD_SPEED * step * theta.cos(), y + FORWARD_SPEED * step * theta.sin()));
        let (body, _) = driven(of(Phase::MoveInSpiral));
        let off = (body.pose.x_m - 3.2 - x).hypot(body.pose.y_m - 2.4 - y);
        assert!(off < 0.02, "{off} m from ({x}, {y})");
    }

    #[test]
    fn angles_are_drawn_from_minus_half_a_turn_up_to_half_a_turn() {
        let mut turns = RandomStream::new(1, TURNS);
        let angles: Vec<f64> = (0..10_000).filter_map(|_| Motion::begin(Phase::Rotate, &mut turns).angle).collect();
        assert!(angles.iter().all(|angle| (-PI..PI).contains(angle)));
        assert!(angles.iter().any(|angle| *angle < -3.1) && angles.iter().any(|angle| *angle > 3.1));
        let mean = angles.iter().sum::<f64>() / 10_000.0;
        assert!(mean.abs() < 0.1, "{mean}");
    }

    #[test]
    fn nothing_but_a_turn_draws() {
        let mut turns = RandomStream::new(1, TURNS);
        let first = Motion::begin(Phase::Rotate, &mut turns.clone());
        for phase in [Phase::MoveForward, Phase::MoveInSpiral, Phase::GoBack] {
            assert_eq!(Motion::begin(phase, &mut turns).angle, None);
        }
        assert_eq!(Motion::begin(Phase::Rotate, &mut turns), first);
    }
}
