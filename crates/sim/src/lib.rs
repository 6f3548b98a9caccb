//! The simulated robot and its hall: a hall as data, a body on two wheels, a sonar, and a camera. `headless` runs
//! core and simulator in one plain loop, in simulated time. Nothing here waits: the time `now` is an argument.
//!
//! ```text
//!  hall files ─► hall ─┐
//!                      ├─► simulator ─► memory ─► page (its stored form)
//!  drive · sonar · recognise · camera ─┘
//! ```
//! The simulator does not decide what the robot does. It gets one order at a time and answers it.

mod bag;
pub mod camera;
mod curve;
mod drive;
mod fingerprint;
mod hall;
pub mod headless;
mod memory;
mod misses;
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
