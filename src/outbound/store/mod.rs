//! The stores behind the ports `runtime::store::Store` and `runtime::archive::Archive`: in memory, and on disk.

pub mod memory;
pub mod sqlite;
