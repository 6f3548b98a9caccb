//! The store behind the ports `runtime::store::Store` and `runtime::archive::Archive`, on disk or in memory; the file that
//! remembers a STOP; and how all files of the data folder are named, created, opened and written.

pub(crate) mod files;
pub mod names;
pub(crate) mod private_file;
pub(crate) mod small_file;
pub mod sqlite;
pub mod stops;
#[cfg(test)]
pub(crate) mod tests;
