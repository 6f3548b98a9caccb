//! The doors: how operators and programs reach hallsweep. No door knows another, and none knows an adapter.

pub mod coap;
pub mod http;
pub mod mqtt;
