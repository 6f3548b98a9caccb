//! The endpoint, without socket and resources.

#[path = "../../../src/inbound/coap/endpoint/mod.rs"]
pub mod endpoint;
