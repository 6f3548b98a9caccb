//! The interface of the two drivers (state machine and tree), which control the Roomba tick by tick.

use super::phase::Motion;
use super::room::Velocity;

pub(super) trait Driver {
    /// Performs one tick and returns the speeds. `bumper` says whether a wall cut the last move short.
    fn tick(&mut self, bumper: bool) -> Velocity;

    fn motion(&self) -> Motion;
}
