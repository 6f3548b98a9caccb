//! Of the doors, what reads bytes from anywhere: the CoAP endpoint, what is heard of HTTP, the gate of the MQTT door, and the messages of the original system.

pub mod coap;
pub mod http;
pub mod mqtt;
