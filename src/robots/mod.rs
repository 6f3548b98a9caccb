//! The robots, one folder for each vendor. Only this folder names vendors: from the settings, the factory creates
//! what the core's loop needs. The simulated robot is a vendor like any other: it has a body, sensors and a
//! camera, and knows nothing of missions.

use std::future::Future;
use std::pin::Pin;

use crate::runtime::link::RobotSide;

pub mod emulator;
mod external;
mod factory;
pub mod sim;
mod waits;

pub use external::UnusableScene;
pub use factory::{Adapters, Robots, Unusable};
pub use sim::SimulatorParts;

/// Runs a robot with its end of the link. The future ends when the core's loop has dropped the other end.
pub type Adapter = Box<dyn FnOnce(RobotSide) -> Pin<Box<dyn Future<Output = ()> + Send>> + Send>;
