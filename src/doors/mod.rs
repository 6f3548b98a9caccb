//! The doors: how operators and programs reach hallsweep. No door knows another door or an adapter. Shared parts are beside the
//! doors: ports, pending connections, the scaling of limits on systems with few descriptors, quotas of keys, write time limits,
//! the rate of large publications, and problems.

pub mod coap;
pub mod connection_limits;
pub mod http;
pub mod listeners;
mod log_throttle;
pub mod mqtt;
mod problem;
mod update_interval;
mod write_timeout;
