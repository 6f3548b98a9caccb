//! The MQTT door: the topics of the original system, and our own topics with JSON. It runs our own broker behind a
//! gate, or connects to another broker. It turns messages into commands and snapshots into messages, and decides
//! nothing about the mission.

pub mod change_feed;
mod client_ids;
mod client_io;
mod client_service;
mod clients;
pub mod commands;
mod embedded;
mod halls;
mod hearing;
pub mod home_assistant;
mod identity;
mod incoming;
mod introduction;
mod limits;
pub mod publication;
pub mod qak;
mod read_ahead;
mod rights;
#[cfg(feature = "rumqttd-router")]
mod rumqttd;
pub mod session;
pub mod topic_map;
pub mod topics;

pub use clients::Clients;
pub use embedded::{Ways, serve};
pub use halls::Halls;
pub use incoming::{ClientReader, IncomingConnection, Origin, Writer};
#[cfg(feature = "rumqttd-router")]
pub use rumqttd::RumqttdRouter;
