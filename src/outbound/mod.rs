//! What hallsweep reaches out to: robots today. The doors through which others reach in are not here but in `inbound`.

pub mod robot;
