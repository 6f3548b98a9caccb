//! The simulated robot and its hall: a hall as data, a body on two wheels, a sonar, a camera; and core and simulator in
//! one plain loop, in simulated time (`headless`). It never waits: `now` is an argument.
//!
//! ```text
//!  hall files ─► hall ─┐
//!                      ├─► simulator ─► memory ─► page (how it is written)
//!  drive · sonar · recognise · camera ─┘
//! ```
//! The orders of the robot are decided elsewhere: it gets one at a time, and answers it.

mod bag;
pub mod camera;
mod curve;
mod drive;
mod fingerprint;
mod hall;
pub mod headless;
mod memory;
pub mod page;
pub mod pair;
mod recognise;
mod senses;
mod settings;
mod simulator;
mod sonar;

pub use drive::{BodyPose, normal};
pub use hall::{Export, Format, Hall, HallError, HallFault, MAX_PIECES, Truth, WrittenHall};
pub use hall::{Floor, HallOfScene, MovingObstacle, PLAYER, Player, Scene, SceneSonar, StaticObstacle};
pub use memory::SimMemory;
pub use settings::{Camera, SimSettings};
pub use simulator::{Faults, Sim};
