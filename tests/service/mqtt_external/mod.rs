//! The MQTT interface through an external broker: mosquitto and NATS from Debian, started by the test. The session is
//! tested beside its code with any kind of broker; these tests check that it works with these two.
//!
//! The part of a missing broker is skipped with a message. With `HALLSWEEP_REQUIRE_CLIENTS=1` it fails.

mod broker;
mod missions;
mod session;
mod subscriber;
