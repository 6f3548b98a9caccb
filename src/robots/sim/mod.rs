//! The simulated robot. `hallsweep_sim` decides what the robot does. This folder has its settings, the link that
//! joins it to the core's loop, and the state file from which it is restored.

mod chosen_hall;
mod kept_halls;
mod link;
mod offered_halls;
mod pair;
mod pair_link;
mod pair_state_file;
mod remote;
mod robot;
mod settings;
mod sim_time;
mod simulator;
mod state_file;

pub(super) use chosen_hall::ChosenHall;
pub(super) use kept_halls::unreadable as unreadable_halls;
pub(super) use pair::SimPair;
pub(super) use remote::{Controls, Remote, SimulatedHall};
pub(super) use robot::SimRobot;
pub use settings::{UnusableHall, exercise, hall, sim_settings};
pub use simulator::SimulatorParts;
pub(super) use simulator::{Parts, venue};
