//! Of the doors, what reads bytes from anywhere: the CoAP endpoint, the gate of the MQTT door, and the messages of the original system.

pub mod coap;
pub mod mqtt;
