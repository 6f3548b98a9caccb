//! The runtime: the one loop that connects core, robots, store and doors, and the handle that doors use to reach the
//! loop.

pub mod archive;
pub mod archive_reader;
pub mod carry_out;
pub mod clock;
pub mod figures;
pub mod halt;
pub mod handle;
pub mod link;
mod links;
mod overflow;
pub mod simulator;
pub mod store;
pub mod task;
#[cfg(test)]
pub(crate) mod tests;
pub mod threads;
