//! The basic types of the core: commands, reports, refusals, and the names of everything that is counted, held or
//! carried. No module here knows the course of a mission. All other modules use these types.

pub mod arm;
pub mod asked;
pub mod bomb_size;
pub mod closing;
pub mod command;
pub mod event;
pub mod hall;
pub mod hand_over;
pub mod hold;
pub mod not_fetched;
pub mod pair;
pub mod phase;
pub mod place;
pub mod refused;
pub mod robot;
pub mod simulated;
pub mod speed;
pub mod units;
pub mod words;
