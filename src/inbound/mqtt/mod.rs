//! The MQTT door: the old topics, the JSON topics, and a broker of our own behind a gate, or somebody else's. It turns messages
//! into commands and snapshots into messages; it decides nothing about the mission.

mod engine;
mod limits;
pub mod orders;
pub mod publication;
pub mod qak;
mod slots;
pub mod topics;
