//! Of the adapters, the simulated robot alone: it reads halls.

#[path = "../../src/outbound/robot/mod.rs"]
pub mod robot;
