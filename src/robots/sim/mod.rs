//! The simulated robot: `hallsweep_sim` says what it does; here are the link that joins it to the loop, and the state file by which it is
//! as it was left.

mod link;
mod state_file;

pub use link::run;
pub use state_file::{SimStateFile, StateFileError};
