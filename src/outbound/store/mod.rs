//! The stores behind the ports `runtime::store::Store` and `runtime::archive::Archive`: in memory, and on disk.

mod belonging;
pub mod memory;
pub mod sqlite;
