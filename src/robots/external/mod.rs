//! Robots outside this program: a driver that knows the robot's protocol (`hallsweep_drivers`), the wire to it, and the small
//! file that tells the next program the position of a robot that does not report it.

mod drawing;
mod link;
mod memory_file;
mod robot;
mod room;
mod wire;

pub(super) use robot::ExternalRobot;
pub use room::UnusableScene;
