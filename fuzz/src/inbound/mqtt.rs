//! The gate, without sockets and engine, and the topics by which it knows whose business a message is.

#[path = "../../../src/inbound/mqtt/gate/mod.rs"]
pub mod gate;
#[path = "../../../src/inbound/mqtt/topics.rs"]
pub mod topics;
