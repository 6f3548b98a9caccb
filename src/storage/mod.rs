//! The store on disk or in memory, which implements `runtime::store::Store` and `runtime::archive::Archive`. The code
//! here also writes the file that remembers a STOP. It decides how all files of the data folder are named, created,
//! opened and written.

pub(crate) mod files;
pub mod names;
pub(crate) mod private_file;
pub(crate) mod small_file;
pub mod sqlite;
pub mod stops;
#[cfg(test)]
pub(crate) mod tests;
