//! The resource model: hall map, luggage, temperature and alarms. The engine decides what changes them, and when.

pub mod alarm;
pub mod areas;
pub mod coverage;
pub mod hall_map;
pub mod keep_out;
pub mod luggage;
mod mark;
pub mod records;
pub mod resource;
pub mod scores;
mod sweep;
pub mod temperature;
mod tiles;
