//! The CoAP door, for small devices and scripts. They can read and observe the resources of hallsweep, and send
//! commands. This door turns requests into commands and snapshots into answers. It decides nothing about the mission.

mod application;
mod change_feed;
mod flood_filter;
mod pending;
mod resources;
mod serve;
mod socket;

pub use application::{Application, Reply};
pub use resources::Resources;
pub use serve::serve;
pub use socket::{Socket, beside};
