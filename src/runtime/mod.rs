//! The runtime: the one loop that joins core, robots, store and doors, and the handle by which doors reach it.

pub mod archive;
pub mod archive_reader;
pub mod carry_out;
pub mod clock;
pub mod figures;
pub mod halt;
pub mod handle;
pub mod link;
mod links;
#[cfg(test)]
pub(crate) mod obedient;
mod overflow;
#[cfg(test)]
pub(crate) mod partial_archive;
pub mod simulator;
pub mod store;
pub mod task;
pub mod threads;
#[cfg(test)]
pub(crate) mod within;
