//! Of the doors, the CoAP endpoint alone: it reads datagrams from anywhere.

pub mod coap;
