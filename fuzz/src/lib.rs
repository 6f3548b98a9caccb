//! The rooms of hallsweep in which bytes are read, from hallsweep's own sources: without doors, store and command line, which no
//! target needs, all of this is built for fuzzing in a fraction of the time. Nothing is here that is not there.

pub mod access;
#[path = "../../src/core/mod.rs"]
pub mod core;
pub mod inbound;
pub mod outbound;
#[path = "../../src/runtime/mod.rs"]
pub mod runtime;
#[path = "../../src/wire/mod.rs"]
pub mod wire;
