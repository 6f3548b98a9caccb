//! What hallsweep reaches out to: robots and the store. The doors through which others reach in are not here but in `inbound`.

mod files;
pub mod robot;
pub mod store;
