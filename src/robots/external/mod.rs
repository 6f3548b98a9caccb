//! Robots outside this program. Each has a driver for its protocol (`hallsweep_drivers`) and a connection. For a
//! robot that does not report its position, a small file tells the position to the next program.

mod drawing;
mod link;
mod memory_file;
mod robot;
mod room;
mod wire;

pub(super) use robot::ExternalRobot;
pub use room::UnusableScene;
