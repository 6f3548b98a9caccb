//! The settings of the simulated robot. The program that runs the robot reads the settings, and sets the speed of
//! simulated time.

use std::time::Duration;

/// Settings of the simulated robot. All times are simulated time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimSettings {
    /// The seed of the robot's noise and failures.
    pub seed: u64,
    /// Probability that the camera cannot tell what an obstacle is, 0–1.
    pub unknown_rate: f64,
    /// Whether the camera can miss luggage and take it for a wall (`misses`).
    pub camera_misses: bool,
    /// Probability that a photo fails, 0–1.
    pub photo_failure_rate: f64,
    /// The standard deviation of the sonar's noise, in centimetres.
    pub sonar_noise_cm: f64,
    /// Number of cells ahead that the sonar reports on after each move. With 0, the robot notices obstacles only by
    /// bumping into them.
    pub sonar_cells: u8,
    pub camera: Camera,
    /// Duration of a step of one cell.
    pub step: Duration,
    /// Duration of a turn of 90°.
    pub turn: Duration,
    pub photo: Duration,
    /// Whether the robot has a hook. With the hook it takes the piece ahead onto its back.
    pub has_hook: bool,
    /// Duration of taking or releasing a piece.
    pub hook: Duration,
    pub wheel_radius_m: f64,
    /// The distance between the wheels, in metres.
    pub axle_m: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Camera {
    #[default]
    Rendered,
    /// A picture of only two pixels, which still differs from piece to piece. It is for runs in which nobody looks at
    /// the photos.
    Stub,
}

/// Shortest duration of a movement. It keeps speeds finite.
const QUICKEST: Duration = Duration::from_millis(1);

impl SimSettings {
    #[must_use]
    pub fn new(seed: u64, camera: Camera) -> SimSettings {
        SimSettings { seed, camera, ..SimSettings::default() }
    }

    /// Changes values that the arithmetic could not handle. For example, no move is shorter than a millisecond, and
    /// no wheel is smaller than a millimetre.
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
            camera_misses: false,
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
