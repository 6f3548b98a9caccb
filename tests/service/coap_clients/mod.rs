//! The CoAP interface with clients by other authors, each in its own process, against the real program. The RFCs are
//! tested beside the endpoint; these tests check that clients which people have installed work.
//!
//! The part of a missing client is skipped with a message. With `HALLSWEEP_REQUIRE_CLIENTS=1` it fails.

pub(crate) mod ask;
mod beyond;
pub(crate) mod client;
mod commanding;
mod observer;
mod observing;
mod old_wire;
mod on_the_wire;
mod photos;
mod reading;
pub(crate) mod shown;
mod tap;

use client::Client;

use crate::program::{Program, hallsweep};

/// Content-Format numbers (IANA, CoAP Content-Formats).
const TEXT: u16 = 0;
const LINKS: u16 = 40;
const OCTETS: u16 = 42;
const JSON: u16 = 50;
const CBOR: u16 = 60;
const SENML: u16 = 110;

/// Option numbers (RFC 7252, section 12.2).
const IF_MATCH: u16 = 1;
const ETAG: u16 = 4;
const IF_NONE_MATCH: u16 = 5;

/// Starts the program with this hall at this speed, with HTTP and CoAP on free ports.
fn serve(hall: &str, speed: &str) -> Program {
    let arguments = ["--http", "127.0.0.1:0", "--coap", "127.0.0.1:0", "--seed", "1", "--hall", hall, "--speed", speed];
    Program::started(hallsweep(&["serve"]).args(arguments))
}

/// Beginning of a URL of the program's CoAP interface.
fn door(program: &Program) -> String {
    format!("coap://{}", program.coap())
}

/// Runs a scenario with every installed client.
fn with_each(scenario: impl Fn(Client)) {
    for client in Client::ALL.into_iter().filter(|client| client.is_here()) {
        // The test harness prints this when the scenario fails.
        eprintln!("with {client:?}");
        scenario(client);
    }
}
