//! The stores behind the ports `runtime::store::Store` and `runtime::archive::Archive`: in memory, and on disk; and
//! what remembers a STOP beside it.

mod belonging;
pub(crate) mod files;
pub mod memory;
pub mod sqlite;
pub mod stops;
