//! What the settings of the program say of a simulated robot and of its hall, in the words of `hallsweep_sim`.

use std::sync::Arc;

use crate::config::{self, RobotSettings, Settings};
use hallsweep_sim::{Camera, Hall, HallError, SimSettings, Speed};

/// The hall of the settings cannot be read. `Display` is the line for whoever started the program.
#[derive(Debug, thiserror::Error)]
#[error("setting hall.file = {name:?} (from {origin}): {error}")]
pub struct UnusableHall {
    /// The hall's name or path, as it was set.
    pub name: String,
    /// Where that was set, as `flag --hall`.
    pub origin: String,
    pub error: HallError,
}

pub fn hall(settings: &Settings) -> Result<Arc<Hall>, UnusableHall> {
    let (name, origin) = (settings.hall.clone(), settings.hall_origin.clone());
    Hall::named_or_file(&settings.hall).map(Arc::new).map_err(|error| UnusableHall { name, origin, error })
}

pub fn sim_settings(robot: &RobotSettings, camera: Camera) -> SimSettings {
    SimSettings {
        unknown_rate: robot.unknown_rate,
        photo_failure_rate: robot.photo_failure_rate,
        sonar_noise_cm: robot.sonar_noise_cm,
        sonar_cells: robot.sonar_cells,
        ..SimSettings::new(robot.seed, camera)
    }
}

pub(in crate::robots) const fn speed(speed: config::Speed) -> Speed {
    match speed {
        config::Speed::Times(factor) => Speed::Times(factor),
        config::Speed::Max => Speed::Max,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_speed_that_can_be_set_is_one_the_simulator_knows() {
        assert_eq!((config::Speed::SLOWEST, config::Speed::FASTEST), (Speed::SLOWEST, Speed::FASTEST));
    }
}
