//! The vocabulary of the core: what may be asked, what may be reported, what is refused, and the names of everything
//! that is counted, held or carried. No module here knows the course of a mission; all others use these.

pub mod arm;
pub mod asked;
pub mod command;
pub mod event;
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
