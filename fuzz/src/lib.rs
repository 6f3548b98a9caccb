//! The rooms of hallsweep in which bytes are read, from hallsweep's own sources: without doors, store and command line, which no
//! target needs, all of this is built for fuzzing in a fraction of the time. Nothing is here that is not there.

pub mod access;
#[path = "../../src/api/mod.rs"]
pub mod api;
pub mod doors;
#[path = "../../src/runtime/mod.rs"]
pub mod runtime;

pub use behaviour_trees;
pub use hallsweep_core as core;
pub use hallsweep_sim as sim;
