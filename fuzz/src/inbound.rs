//! Of the doors, the CoAP endpoint and the gate of the MQTT door alone: they read bytes from anywhere.

pub mod coap;
pub mod mqtt;
