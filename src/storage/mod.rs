//! The store behind the ports `runtime::store::Store` and `runtime::archive::Archive`, on disk or in memory; what remembers a STOP
//! beside it; and how files of the data folder are named, made, opened and written, for all that keeps something there.

pub(crate) mod files;
pub mod names;
pub(crate) mod private_file;
#[cfg(test)]
pub(crate) mod scratch;
pub(crate) mod small_file;
pub mod sqlite;
pub mod stops;
