//! The gate, without sockets and engine, the topics by which it knows whose business a message is, and the messages of the original
//! system.

#[path = "../../../src/inbound/mqtt/gate/mod.rs"]
pub mod gate;
#[path = "../../../src/inbound/mqtt/qak/mod.rs"]
pub mod qak;
#[path = "../../../src/inbound/mqtt/topics.rs"]
pub mod topics;
