//! The CoAP door with clients that others wrote, each in its own process, against the real program. That the door keeps to the RFCs
//! is tested beside the endpoint; here it matters that what people have installed works with it.
//!
//! Where a client is absent its share is left out with a word; with `HALLSWEEP_REQUIRE_CLIENTS=1` it fails.

mod ask;
mod beyond;
mod client;
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

/// Formats by their numbers (IANA, CoAP Content-Formats).
const TEXT: u16 = 0;
const LINKS: u16 = 40;
const OCTETS: u16 = 42;
const JSON: u16 = 50;
const CBOR: u16 = 60;
const SENML: u16 = 110;

/// Options by their numbers (RFC 7252, section 12.2).
const IF_MATCH: u16 = 1;
const ETAG: u16 = 4;
const IF_NONE_MATCH: u16 = 5;

/// The program with this hall at this speed, both doors on free ports.
fn serve(hall: &str, speed: &str) -> Program {
    let arguments = ["--http", "127.0.0.1:0", "--coap", "127.0.0.1:0", "--seed", "1", "--hall", hall, "--speed", speed];
    Program::started(hallsweep(&["serve"]).args(arguments))
}

/// Where the CoAP door of a program is, as the beginning of a URL.
fn door(program: &Program) -> String {
    format!("coap://{}", program.coap())
}

/// Plays a scenario with every client that is there.
fn with_each(scenario: impl Fn(Client)) {
    for client in Client::ALL.into_iter().filter(|client| client.is_here()) {
        // Seen when the scenario fails.
        eprintln!("with {client:?}");
        scenario(client);
    }
}
