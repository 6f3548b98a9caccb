//! The MQTT door: the old topics, the JSON topics, and a broker of our own behind a gate, or somebody else's. It turns messages
//! into commands and snapshots into messages; it decides nothing about the mission.

mod embedded;
mod engine;
mod guests;
mod hearing;
pub mod home_assistant;
mod identity;
mod introduction;
mod limits;
mod memory;
pub mod news;
pub mod orders;
pub mod publication;
mod pump;
pub mod qak;
mod read_ahead;
mod rights;
mod seats;
pub mod session;
mod slots;
mod suspicion;
pub mod topics;
mod upstream;
mod visitor;

pub use embedded::{Embedded, Ways};
pub use engine::EngineError;
pub use guests::House;
pub use identity::HOUSE;
pub use visitor::{Origin, Reader, Visitor, Writer};
