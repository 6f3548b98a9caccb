//! The doors: how operators and programs reach hallsweep. No door knows another, and none knows an adapter. What doors with
//! connections have in common lies beside them: the ports they listen to, the limits of connections, sessions and requests, how long a
//! reader may stall, how soon what is large is said again, and what is said where something is not done.

pub mod coap;
pub mod connection_limits;
pub mod http;
pub mod listeners;
mod log_throttle;
pub mod mqtt;
mod problem;
mod update_interval;
mod write_timeout;
