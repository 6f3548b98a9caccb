//! The simulated robot: a hall as data, a body on two wheels, a sonar, a camera, and the link that joins them to the loop.
//!
//! ```text
//!  config/halls/*.toml ─► hall ─┐
//!                               ├─► simulator (sans-IO) ◄─► link (the only file with channels and timers)
//!  drive · sonar · recognise · camera ─┘       memory ─────────► diary (a file in the data folder)
//! ```
//! What the robot is told to do is not decided here: it gets one order at a time, and answers it.

mod bag;
pub mod camera;
mod curve;
mod diary;
mod drive;
mod fingerprint;
mod hall;
mod hall_error;
mod hall_files;
mod hall_movingai;
mod hall_rows;
mod hall_toml;
mod link;
mod memory;
mod recognise;
mod senses;
mod settings;
mod simulator;
mod sonar;
mod speed;

pub use bag::{Bag, Colour, Kind};
pub use diary::{Diary, DiaryError};
pub use drive::BodyPose;
pub use hall::{Hall, Truth};
pub use hall_error::{HallError, HallFault};
pub use link::run;
pub use memory::SimMemory;
pub use settings::{Camera, SimSettings};
pub use simulator::Sim;
pub use speed::{Speed, SpeedError};
