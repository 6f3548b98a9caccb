//! Robots outside this program: a driver that knows how one is spoken to (`hallsweep_drivers`), the wire to it, and the small file by
//! which the next program knows where it stands, where it does not say so itself.

mod drawing;
mod link;
mod memory_file;
mod robot;
mod room;
mod wire;

pub(super) use robot::ExternalRobot;
pub use room::UnusableScene;
