//! The CoAP door: the resources of hallsweep for small devices and scripts, to be read, observed and acted upon. It turns requests
//! into commands and snapshots into answers; it decides nothing about the mission.

pub mod endpoint;
pub mod links;
pub mod resources;
