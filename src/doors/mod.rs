//! The doors: how operators and programs reach hallsweep. A door knows neither other doors nor adapters. Parts that
//! several doors use are in the files of this folder: ports, limits of connections and requests, write time limits,
//! limits of logging, the rate of large publications, and problems.

pub mod coap;
pub mod connection_limits;
pub mod http;
pub mod listeners;
mod log_throttle;
pub mod mqtt;
mod problem;
mod update_interval;
mod write_timeout;
