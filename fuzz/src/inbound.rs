//! Of the doors, what reads bytes from anywhere: what is heard of HTTP, the gate of the MQTT door, and the messages of the original system.

pub mod http;
pub mod mqtt;
