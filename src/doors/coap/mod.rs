//! The CoAP door: the resources of hallsweep for small devices and scripts, to be read, observed and acted upon. It turns requests
//! into commands and snapshots into answers; it decides nothing about the mission.

mod application;
mod news;
mod resources;
mod serve;
mod sieve;
mod socket;
mod under_way;

pub use application::{Application, Said};
pub use resources::Resources;
pub use serve::serve;
pub use socket::{Socket, beside};
