//! The MQTT door: the old topics, the JSON topics, and a broker of our own behind a gate, or somebody else's. It turns messages
//! into commands and snapshots into messages; it decides nothing about the mission.

pub mod change_feed;
mod clients;
pub mod commands;
mod embedded;
mod hearing;
pub mod home_assistant;
mod identity;
mod incoming;
mod introduction;
mod limits;
pub mod publication;
mod pump;
pub mod qak;
mod read_ahead;
mod rights;
mod router;
mod seats;
pub mod session;
mod slots;
mod suspicion;
pub mod topics;
mod upstream;

pub use clients::Clients;
pub use embedded::{Embedded, Ways};
pub use identity::OWN_SESSION;
pub use incoming::{IncomingConnection, Origin, Reader, Writer};
pub use router::RouterError;
