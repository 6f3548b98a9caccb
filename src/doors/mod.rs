//! The doors: how operators and programs reach hallsweep. No door knows another, and none knows an adapter. Shared parts are
//! beside them: ports, waiting connections, the reduction of bounds on systems with few descriptors, quotas of keys, write time
//! limits, the rate of large publications, and problems.

pub mod coap;
pub mod connection_limits;
pub mod http;
pub mod listeners;
mod log_throttle;
pub mod mqtt;
mod problem;
mod update_interval;
mod write_timeout;
