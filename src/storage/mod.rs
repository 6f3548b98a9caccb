//! The store behind the ports `runtime::store::Store` and `runtime::archive::Archive`, on disk or in memory; and what remembers a
//! STOP beside it.

pub(crate) mod files;
pub mod sqlite;
pub mod stops;
