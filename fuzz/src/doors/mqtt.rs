//! The messages of the original system.

#[path = "../../../src/doors/mqtt/qak/mod.rs"]
pub mod qak;
