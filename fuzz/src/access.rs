//! Of access, the network of an address and the roles: the CoAP endpoint asks whether a peer is on this machine, the gate of the MQTT
//! door who may publish where.

#[path = "../../src/access/network.rs"]
mod network;
#[path = "../../src/access/role.rs"]
mod role;

pub use network::{Network, is_this_machine};
pub use role::{Need, Role};
