//! A parcel between two grippers. The gripping force, the angle of the paddles and the distance of the bases are
//! computed in fixed steps. Noise disturbs each of these quantities, and each has a controller. Other files decide
//! when the controllers start and where the parcel is.
//!
//! ```text
//!            force ─►▐▓▓▓▓▓▓▌◄─ force      a load makes the force decrease and the paddles tilt;
//!   ┌──────┐   ╱angle╲      ┌──────┐       the two bases never have exactly the same speed;
//!   │ SRM1 │◄──── gap ─────►│ SRM2 │       a controller keeps each quantity at its target value
//!   └──────┘                └──────┘
//! ```

use std::time::Duration;

use hallsweep_core::arm::{Controllers, Parcel};
use hallsweep_core::rng::RandomStream;

/// The time step of the simulation. It is a tenth of the step that the fastest controller needs.
pub(super) const STEP: Duration = Duration::from_millis(10);
const DT: f64 = 0.01;

/// The target value of the gripping force, in newtons.
pub const FORCE_N: f64 = 60.0;

/// Greatest allowed error of the gripping force, in newtons. With less force the parcel slips, and with more it is
/// crushed.
pub const FORCE_LIMIT_N: f64 = 15.0;

/// Greatest allowed tilt of the paddles, in radians. With a greater tilt the parcel slides off.
pub const ANGLE_LIMIT: f64 = 0.2;

/// Greatest allowed error of the distance between the bases, in metres. The wrists cannot reach further.
pub const GAP_LIMIT_M: f64 = 0.08;

/// The parcel is lost if a quantity is beyond its limit for more than this number of time steps in a row (a third of
/// a second).
const PATIENCE: u32 = 33;

/// Constants of one controlled quantity: its noise and the gains of its controller.
struct Loop {
    /// Standard deviation of the noise that builds up in one second, in the unit of the quantity.
    noise: f64,
    /// Proportional gain of the controller, per second.
    p: f64,
    /// Integral gain of the controller, per second squared. It removes the error that a steady drift would leave.
    i: f64,
}

const FORCE: Loop = Loop { noise: 1.0, p: 4.0, i: 4.0 };
const ANGLE: Loop = Loop { noise: 0.01, p: 5.0, i: 5.0 };
const GAP: Loop = Loop { noise: 0.004, p: 4.0, i: 4.0 };

/// How fast the force decreases while the grippers bear the parcel, in newtons a second.
const FORCE_CREEP: f64 = 2.5;

/// How fast the paddles tilt while the grippers bear the parcel, in radians a second.
const ANGLE_CREEP: f64 = 0.03;

/// Smallest and largest difference between the speeds of the two bases, as a share of the speed.
const SPEED_DIFFERS: (f64, f64) = (0.04, 0.08);

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Held {
    pub(super) error: f64,
    pub(super) sum: f64,
}

impl Held {
    fn advance(&mut self, by: &Loop, drift: f64, is_held: bool, noise: &mut RandomStream) {
        // The noise is uniform with standard deviation 1. After many steps, its sum is normally distributed anyway.
        let shake = (noise.fraction() - 0.5) * 12.0_f64.sqrt() * by.noise * DT.sqrt();
        let answer = if is_held { by.p * self.error + by.i * self.sum } else { 0.0 };
        if is_held {
            self.sum += self.error * DT;
        }
        self.error += (drift - answer) * DT + shake;
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grip {
    pub(super) parcel: Parcel,
    /// How high the parcel is lifted: 0 on the floor, 1 at full height.
    pub(super) height: f64,
    /// Number of steps (from place to place) over which the parcel was carried.
    pub(super) steps: u32,
    /// Errors of the force (newtons), the angle (radians) and the gap between the bases (metres).
    pub(super) force: Held,
    pub(super) angle: Held,
    pub(super) gap: Held,
    /// How much faster the second base drives, as a share of its speed. Negative if it is slower.
    pub(super) faster: f64,
    /// The direction in which the paddles tilt, 1 or −1.
    pub(super) tilts: f64,
    /// Number of time steps in a row with a quantity beyond its limit.
    pub(super) beyond: u32,
}

impl Grip {
    /// Grippers that have just closed around a parcel. The errors are small and random.
    pub(super) fn new(parcel: Parcel, noise: &mut RandomStream) -> Grip {
        let mut about = |most: f64| Held { error: (noise.fraction() * 2.0 - 1.0) * most, sum: 0.0 };
        let (force, angle) = (about(5.0), about(0.03));
        let (least, most) = SPEED_DIFFERS;
        let mut either = || if noise.happens(0.5) { 1.0 } else { -1.0 };
        let (tilts, sign) = (either(), either());
        let faster = sign * (least + (most - least) * noise.fraction());
        Grip { parcel, height: 0.0, steps: 0, force, angle, gap: Held::default(), faster, tilts, beyond: 0 }
    }

    /// Whether the grippers bear the parcel. If not, it stands on the floor.
    pub(super) fn is_loaded(&self) -> bool {
        self.height > 0.0
    }

    /// Advances by one time step. The bases drive at `speed` metres a second. Returns true if the parcel is lost.
    /// Without a load nothing changes, because the drives of the grippers lock by themselves.
    pub(super) fn advance(&mut self, at_work: Controllers, speed: f64, noise: &mut RandomStream) -> bool {
        if !self.is_loaded() {
            return false;
        }
        self.force.advance(&FORCE, -FORCE_CREEP, at_work.force, noise);
        self.angle.advance(&ANGLE, ANGLE_CREEP * self.tilts, at_work.angle, noise);
        if speed > 0.0 {
            self.gap.advance(&GAP, speed * self.faster, at_work.distance, noise);
        }
        let is_beyond =
            self.force.error.abs() > FORCE_LIMIT_N || self.angle.error.abs() > ANGLE_LIMIT || self.gap.error.abs() > GAP_LIMIT_M;
        self.beyond = if is_beyond { self.beyond.saturating_add(1) } else { 0 };
        self.beyond > PATIENCE
    }
}

/// Statistics of the errors of one quantity while a parcel was carried.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    count: u64,
    squares: f64,
    worst: f64,
}

impl Spread {
    pub(super) fn add(&mut self, error: f64) {
        self.count += 1;
        self.squares += error * error;
        self.worst = self.worst.max(error.abs());
    }

    fn join(&mut self, other: &Spread) {
        self.count += other.count;
        self.squares += other.squares;
        self.worst = self.worst.max(other.worst);
    }

    #[must_use]
    pub const fn worst(&self) -> f64 {
        self.worst
    }

    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a run has far fewer steps than a double counts")]
    pub fn rms(&self) -> f64 {
        if self.count == 0 { 0.0 } else { (self.squares / self.count as f64).sqrt() }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Holding {
    /// Errors of the gripping force, in newtons.
    pub force_n: Spread,
    /// Angles of the paddles, in radians from upright.
    pub angle_rad: Spread,
    /// Errors of the distance between the bases, in metres.
    pub gap_m: Spread,
}

impl Holding {
    pub fn join(&mut self, other: &Holding) {
        self.force_n.join(&other.force_n);
        self.angle_rad.join(&other.angle_rad);
        self.gap_m.join(&other.gap_m);
    }

    pub(super) fn add(&mut self, grip: &Grip) {
        self.force_n.add(grip.force.error);
        self.angle_rad.add(grip.angle.error);
        self.gap_m.add(grip.gap.error);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::place::Place;
    use hallsweep_core::units::Piece;

    const ALL: Controllers = Controllers { force: true, angle: true, distance: true };

    /// Returns how many seconds a lifted parcel stays in the grippers, at most 60. Also returns the statistics of its
    /// errors.
    fn held(seed: u64, at_work: Controllers, speed: f64) -> (f64, Holding) {
        let mut noise = RandomStream::new(seed, "grip");
        let mut grip = Grip::new(Parcel { piece: Piece(1), place: Place::ENTRANCE }, &mut noise);
        grip.height = 1.0;
        let mut holding = Holding::default();
        for step in 0..6000 {
            if grip.advance(at_work, speed, &mut noise) {
                return (f64::from(step) * DT, holding);
            }
            holding.add(&grip);
        }
        (60.0, holding)
    }

    #[test]
    fn with_all_controllers_at_work_everything_stays_well_within_its_limits() {
        for seed in 0..100 {
            let (seconds, holding) = held(seed, ALL, 0.5);
            assert!((seconds - 60.0).abs() < f64::EPSILON, "seed {seed}: lost after {seconds} s");
            // At the beginning, the force may be 5 N off and the angle 0.03 rad.
            assert!(holding.force_n.worst() < 7.0 && holding.force_n.rms() < 1.0, "seed {seed}: {holding:?}");
            assert!(holding.angle_rad.worst() < 0.05 && holding.angle_rad.rms() < 0.01, "seed {seed}: {holding:?}");
            assert!(holding.gap_m.worst() < 0.03 && holding.gap_m.rms() < 0.006, "seed {seed}: {holding:?}");
        }
    }

    #[test]
    fn without_any_one_of_the_controllers_the_parcel_is_lost() {
        for seed in 0..100 {
            for missing in
                [Controllers { force: false, ..ALL }, Controllers { angle: false, ..ALL }, Controllers { distance: false, ..ALL }]
            {
                let (seconds, _) = held(seed, missing, 0.5);
                assert!((1.0..15.0).contains(&seconds), "seed {seed}, {missing:?}: {seconds} s");
            }
        }
    }

    #[test]
    fn a_halted_pair_holds_its_parcel_and_its_distance() {
        let halted = Controllers { distance: false, ..ALL };
        let (seconds, holding) = held(3, halted, 0.0);
        assert!((seconds - 60.0).abs() < f64::EPSILON && holding.gap_m.worst() == 0.0);
    }

    #[test]
    fn what_stands_on_the_floor_is_not_lost_however_long_nobody_holds_it() {
        let mut noise = RandomStream::new(1, "grip");
        let mut grip = Grip::new(Parcel { piece: Piece(1), place: Place::ENTRANCE }, &mut noise);
        assert!((0..100_000).all(|_| !grip.advance(Controllers::default(), 0.0, &mut noise)));
    }
}
