//! The resource model: robot, hall map, luggage, temperature, alarms, log, and the snapshot of it all that the doors show.

pub mod alarm;
pub mod hall_map;
pub mod log;
pub mod luggage;
pub(crate) mod model;
pub mod records;
pub mod resource;
pub mod retrieval;
pub mod robot;
pub mod said;
pub mod snapshot;
pub mod temperature;
mod tiles;
