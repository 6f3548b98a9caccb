//! The stores behind the ports `runtime::store::Store` and `runtime::archive::Archive`: in memory today.

pub mod memory;
