//! The doors of hallsweep (the interfaces that clients use), with their names in records.

use hallsweep_core::command::Door;

/// The console, which is the page at `/`.
pub const CONSOLE: Door = Door("console");

/// JSON over HTTP, and the HTTP routes of the old console.
pub const HTTP: Door = Door("http");

pub const COAP: Door = Door::COAP;

pub const MQTT: Door = Door("mqtt");

pub const DOORS: [Door; 5] = [CONSOLE, HTTP, COAP, MQTT, Door::LOCAL];
