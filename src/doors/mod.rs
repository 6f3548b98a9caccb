//! The doors: how operators and programs reach hallsweep. No door knows another, and none knows an adapter. Shared parts are
//! beside them: ports, waiting connections, the reduction of bounds on systems with few descriptors, quotas of keys, write time
//! limits, the rate of large publications, and problems.

pub mod coap;
pub mod http;
pub mod listeners;
pub mod mqtt;
mod pace;
mod problem;
pub mod room;
mod seldom;
mod shares;
mod vestibule;
mod write_timeout;
