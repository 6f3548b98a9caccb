//! The messages of the original system, without topics and broker.

#[path = "../../../src/inbound/mqtt/qak/mod.rs"]
pub mod qak;
