//! Of the adapters, the simulated robot, which reads halls, and how its file is written.

#[path = "../../src/outbound/files.rs"]
mod files;
#[path = "../../src/outbound/robot/mod.rs"]
pub mod robot;
