//! What can be set of the simulated robot. Where settings come from, and how fast simulated time runs, is not here.

use std::time::Duration;

/// The settings of a simulated robot. Times are in simulated time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimSettings {
    /// The seed of its noise and failures.
    pub seed: u64,
    /// How likely the camera cannot tell what an obstacle is, 0–1.
    pub unknown_rate: f64,
    /// How likely a photo fails, 0–1.
    pub photo_failure_rate: f64,
    /// The standard deviation of the sonar, in centimetres.
    pub sonar_noise_cm: f64,
    /// So many cells ahead it says of itself whether they are free; 0: it bumps into what is there.
    pub sonar_cells: u8,
    /// What photos are made of.
    pub camera: Camera,
    /// How long a step of one cell takes.
    pub step: Duration,
    /// How long a turn of 90° takes.
    pub turn: Duration,
    /// How long a photo takes.
    pub photo: Duration,
    /// Whether it has a hook, by which it takes the piece ahead onto its back.
    pub has_hook: bool,
    /// How long it takes to do so, and to let go.
    pub hook: Duration,
    /// The radius of a wheel, in metres.
    pub wheel_radius_m: f64,
    /// The distance between the wheels, in metres.
    pub axle_m: f64,
}

/// What photos are made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Camera {
    /// A perspective picture of the hall.
    #[default]
    Rendered,
    /// Two pixels that still differ from bag to bag, for runs in which nobody looks.
    Stub,
}

/// No move is quicker than this, so that speeds stay finite.
const QUICKEST: Duration = Duration::from_millis(1);

impl SimSettings {
    /// The usual robot with this seed and camera.
    #[must_use]
    pub fn new(seed: u64, camera: Camera) -> SimSettings {
        SimSettings { seed, camera, ..SimSettings::default() }
    }

    /// With every value where arithmetic holds: no move quicker than a millisecond, no wheel smaller than a millimetre.
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
