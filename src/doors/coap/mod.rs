//! The CoAP door: the resources of hallsweep for small devices and scripts, which can read them, observe them and send
//! commands. It turns requests into commands and snapshots into answers, and decides nothing about the mission.

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
