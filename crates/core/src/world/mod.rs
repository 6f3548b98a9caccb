//! The resource model: hall map, luggage, temperature and alarms. What changes them, and when, is decided in the
//! engine.

pub mod alarm;
mod area;
pub mod hall_map;
pub mod luggage;
pub mod records;
pub mod resource;
pub mod temperature;
mod tiles;
