//! The core: what hallsweep knows and decides. Pure: no clock, no I/O, no thread, no channel; `now` is an argument.
//!
//! The verbs are the same at every layer: `handle_command`, `handle_event`, `handle_timeout` bring something in,
//! `poll_effect` and `poll_timeout` take out what follows from it.

pub mod command;
pub mod effect;
pub mod engine;
pub mod event;
pub mod mission;
pub mod refused;
pub mod rng;
pub mod robots;
pub mod search;
pub mod settings;
pub mod state;
pub mod units;
pub mod world;
