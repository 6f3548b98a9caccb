//! A parcel between two grippers: the gripping force, the angle of the paddles and the distance of the bases, computed
//! in fixed steps. Each is disturbed, and each has a controller. Other files decide when the controllers start and
//! where the parcel is.
//!
//! ```text
//!            force ─►▐▓▓▓▓▓▓▌◄─ force      the load makes the force creep away and the paddles tilt;
//!   ┌──────┐   ╱angle╲      ┌──────┐       two bases never drive equally fast;
//!   │ SRM1 │◄──── gap ─────►│ SRM2 │       a controller that was started holds each at its set value
//!   └──────┘                └──────┘
//! ```

use std::time::Duration;

use hallsweep_core::arm::{Controllers, Parcel};
use hallsweep_core::rng::RandomStream;

/// The integration step: a tenth of the step that the fastest controller needs.
pub(super) const STEP: Duration = Duration::from_millis(10);
const DT: f64 = 0.01;

/// The set value of the gripping force, in newtons.
pub const FORCE_N: f64 = 60.0;

/// Greatest error of the gripping force, in newtons: with less force the parcel slips, with more it is crushed.
pub const FORCE_LIMIT_N: f64 = 15.0;

/// Greatest tilt of the paddles, in radians: beyond it, the parcel slides off.
pub const ANGLE_LIMIT: f64 = 0.2;

/// Greatest error of the distance of the bases, in metres: the reach of the wrists.
pub const GAP_LIMIT_M: f64 = 0.08;

/// Number of steps (a third of a second) for which a quantity may be beyond its limit before the parcel is lost.
const PATIENCE: u32 = 33;

/// One quantity that is held: its drift under load, its noise, and its controller.
struct Loop {
    /// Deviation of the noise, in units for each square root of a second.
    noise: f64,
    /// Gain for the error, per second.
    p: f64,
    /// Gain for the sum of the error, per second squared: it removes the error that a steady drift would leave.
    i: f64,
}

const FORCE: Loop = Loop { noise: 1.0, p: 4.0, i: 4.0 };
const ANGLE: Loop = Loop { noise: 0.01, p: 5.0, i: 5.0 };
const GAP: Loop = Loop { noise: 0.004, p: 4.0, i: 4.0 };

/// How fast the force decreases under load, in newtons a second.
const FORCE_CREEP: f64 = 2.5;

/// How fast the paddles tilt under load, in radians a second.
const ANGLE_CREEP: f64 = 0.03;

/// Least and greatest difference between the speeds of two bases, as a share.
const SPEED_DIFFERS: (f64, f64) = (0.04, 0.08);

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Held {
    pub(super) error: f64,
    pub(super) sum: f64,
}

impl Held {
    fn advance(&mut self, by: &Loop, drift: f64, is_held: bool, noise: &mut RandomStream) {
        // Uniform with deviation 1: the sums over many steps are normal all the same.
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
    /// 0 on the floor, 1 all the way up.
    pub(super) height: f64,
    /// Steps over which it was carried.
    pub(super) steps: u32,
    /// Errors: of the force in newtons, of the angle in radians, of the gap in metres.
    pub(super) force: Held,
    pub(super) angle: Held,
    pub(super) gap: Held,
    /// Share of its speed by which the second base is faster.
    pub(super) faster: f64,
    /// The direction in which the paddles tilt, 1 or −1.
    pub(super) tilts: f64,
    /// Number of steps for which a quantity has been beyond its limit.
    pub(super) beyond: u32,
}

impl Grip {
    /// Grippers that have just closed round a parcel, with small random errors.
    pub(super) fn new(parcel: Parcel, noise: &mut RandomStream) -> Grip {
        let mut about = |most: f64| Held { error: (noise.fraction() * 2.0 - 1.0) * most, sum: 0.0 };
        let (force, angle) = (about(5.0), about(0.03));
        let (least, most) = SPEED_DIFFERS;
        let mut either = || if noise.happens(0.5) { 1.0 } else { -1.0 };
        let (tilts, sign) = (either(), either());
        let faster = sign * (least + (most - least) * noise.fraction());
        Grip { parcel, height: 0.0, steps: 0, force, angle, gap: Held::default(), faster, tilts, beyond: 0 }
    }

    /// Whether the grippers, and not the floor, bear the parcel.
    pub(super) fn is_loaded(&self) -> bool {
        self.height > 0.0
    }

    /// Advances by one step of time; the bases drive at `speed` in metres a second. Returns true when the parcel is
    /// lost. Without a load nothing creeps, because the drives of the grippers lock by themselves.
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

/// How well a quantity was held while a parcel was carried.
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
    /// The angle of the paddles, in radians from upright.
    pub angle_rad: Spread,
    /// Errors of the distance of the bases, in metres.
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

    /// For how many seconds a lifted parcel stays in the grippers, a minute at most, and how well it is held.
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
            // At the beginning the force may be 5 N off, the angle 0.03 rad.
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
