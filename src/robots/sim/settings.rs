//! Converts the program's settings of a simulated robot and of its hall for `hallsweep_sim`.

use std::sync::Arc;

use crate::config::{HallSettings, RobotSettings};
use hallsweep_sim::{Camera, Hall, HallError, HallFault, SimSettings};

/// `Display` is the message for the person who started the program.
#[derive(Debug, thiserror::Error)]
pub enum UnusableHall {
    /// `origin` is where the name or path of the hall was set, such as `flag --hall`.
    #[error("setting hall.file = {name:?} (from {origin}): {error}")]
    File { name: String, origin: String, error: HallError },
    #[error("setting hall.start: {0}")]
    Start(HallFault),
    #[error("setting hall.exercise: {0}")]
    Exercise(HallFault),
}

pub fn hall(settings: &HallSettings) -> Result<Arc<Hall>, UnusableHall> {
    let unreadable = |error| UnusableHall::File { name: settings.file.clone(), origin: settings.origin.clone(), error };
    let hall = Hall::named_or_file(&settings.file).map_err(unreadable)?;
    let Some(start) = settings.start else { return Ok(Arc::new(hall)) };
    hall.starting_at(start).map(Arc::new).map_err(UnusableHall::Start)
}

pub fn exercise(hall: &Hall, pieces: u32, seed: u64) -> Result<Arc<Hall>, UnusableHall> {
    hall.with_tests(pieces, seed).map(Arc::new).map_err(UnusableHall::Exercise)
}

pub fn sim_settings(robot: &RobotSettings, camera: Camera) -> SimSettings {
    SimSettings {
        unknown_rate: robot.unknown_rate,
        camera_misses: robot.camera_misses,
        photo_failure_rate: robot.photo_failure_rate,
        sonar_noise_cm: robot.sonar_noise_cm,
        sonar_cells: robot.sonar_cells,
        ..SimSettings::new(robot.seed, camera)
    }
}
