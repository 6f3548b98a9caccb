//! The simulated robot: `hallsweep_sim` says what it does; here are what the settings make of it, the link that joins it to the loop,
//! and the state file by which it is as it was left.

mod link;
mod pair;
mod pair_link;
mod pair_state_file;
mod robot;
mod settings;
mod state_file;

pub(super) use pair::SimPair;
pub(super) use robot::SimRobot;
pub use settings::{UnusableHall, hall, sim_settings};
