//! The interface of drivers, which control the Roomba tick by tick.

use super::phase::Motion;
use super::room::Velocity;

pub(super) trait Driver {
    /// Performs one tick: `bumper` says whether a wall cut the last move short.
    fn tick(&mut self, bumper: bool) -> Velocity;

    fn motion(&self) -> Motion;
}
