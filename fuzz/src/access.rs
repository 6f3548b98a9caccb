//! Of access, the network of an address alone: the CoAP endpoint asks whether a peer is on this machine.

#[path = "../../src/access/network.rs"]
mod network;

pub use network::{Network, is_this_machine};
