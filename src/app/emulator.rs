//! Plays a robot at the other end of a connection until SIGINT, SIGTERM or SIGHUP, without doors and without a store.

use super::{AppError, LEFT_BEHIND, signals, threads};
use crate::config::Settings;
use crate::robots::emulator::{self, Emulation};
use crate::robots::{Unusable, sim};

/// Plays the robot. Calls `announce` with the address of the robot, including the real port.
pub fn emulate(settings: &Settings, emulation: Emulation, announce: impl FnOnce(&str)) -> Result<(), AppError> {
    let hall = sim::hall(&settings.hall).map_err(Unusable::from)?;
    let runtime = threads::ordinary().map_err(AppError::System)?;
    let played = runtime.block_on(async {
        let signalled = signals::listen().map_err(AppError::System)?;
        tokio::select! {
            _ = signalled => Ok(()),
            ended = emulator::play(hall, &settings.hall.robot, emulation, announce) => Ok(ended?),
        }
    });
    runtime.shutdown_timeout(LEFT_BEHIND);
    played
}
