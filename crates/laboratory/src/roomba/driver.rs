//! What drives the Roomba, tick by tick.

use super::phase::Motion;
use super::room::Velocity;

/// Whoever says in each tick how fast the body is to go.
pub(super) trait Driver {
    /// One tick: `bumper` is whether a wall cut the last move short.
    fn tick(&mut self, bumper: bool) -> Velocity;

    /// What was done in the last tick.
    fn motion(&self) -> Motion;
}
