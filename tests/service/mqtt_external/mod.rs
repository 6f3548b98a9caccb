//! The MQTT door through somebody else's broker: mosquitto and NATS as Debian has them, started by the test. What the session does
//! before a broker of any kind is tested beside it; here it matters that it gets on with these.
//!
//! Where a broker is absent its share is left out with a word; with `HALLSWEEP_REQUIRE_CLIENTS=1` it fails.

mod broker;
mod missions;
mod session;
mod subscriber;
