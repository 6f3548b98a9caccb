//! The settings of the simulated robot. The origin of settings and the speed of simulated time are not here.

use std::time::Duration;

/// Times are in simulated time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimSettings {
    /// The seed of its noise and failures.
    pub seed: u64,
    /// Probability that the camera cannot tell what an obstacle is, 0–1.
    pub unknown_rate: f64,
    /// Probability that a photo fails, 0–1.
    pub photo_failure_rate: f64,
    /// The standard deviation of the sonar, in centimetres.
    pub sonar_noise_cm: f64,
    /// Number of cells ahead that the sonar reports as free or not without being asked. With 0 the robot finds
    /// obstacles only by bumping into them.
    pub sonar_cells: u8,
    pub camera: Camera,
    /// Duration of a step of one cell.
    pub step: Duration,
    /// Duration of a turn of 90°.
    pub turn: Duration,
    pub photo: Duration,
    /// Whether the robot has a hook, with which it takes the piece ahead onto its back.
    pub has_hook: bool,
    /// Duration of taking a piece, and of releasing it.
    pub hook: Duration,
    pub wheel_radius_m: f64,
    /// The distance between the wheels, in metres.
    pub axle_m: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Camera {
    #[default]
    Rendered,
    /// Two pixels that still differ from bag to bag, for runs in which nobody looks.
    Stub,
}

/// Shortest move, so that speeds stay finite.
const QUICKEST: Duration = Duration::from_millis(1);

impl SimSettings {
    #[must_use]
    pub fn new(seed: u64, camera: Camera) -> SimSettings {
        SimSettings { seed, camera, ..SimSettings::default() }
    }

    /// Limits every value to the range that the arithmetic can handle: no move is quicker than a millisecond, no wheel
    /// smaller than a millimetre.
    pub(super) fn sound(mut self) -> SimSettings {
        for time in [&mut self.step, &mut self.turn, &mut self.photo, &mut self.hook] {
            *time = (*time).max(QUICKEST);
        }
        (self.wheel_radius_m, self.axle_m) = (self.wheel_radius_m.max(0.001), self.axle_m.max(0.001));
        self
    }
}

impl Default for SimSettings {
    fn default() -> SimSettings {
        SimSettings {
            seed: 0,
            unknown_rate: 0.0,
            photo_failure_rate: 0.0,
            sonar_noise_cm: 0.4,
            sonar_cells: 0,
            camera: Camera::Rendered,
            step: Duration::from_millis(330),
            turn: Duration::from_millis(500),
            photo: Duration::from_millis(300),
            has_hook: false,
            hook: Duration::from_millis(1500),
            wheel_radius_m: 0.04,
            axle_m: 0.28,
        }
    }
}
