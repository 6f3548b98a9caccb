//! The MQTT interface with clients by other authors, each in its own process, against the real program and its own
//! broker. The standard is tested beside the gate; these tests check that clients which people have installed work.
//!
//! The part of a missing client is skipped with a message. With `HALLSWEEP_REQUIRE_CLIENTS=1` it fails.

mod availability;
pub(crate) mod client;
mod doors;
mod five;
mod json_missions;
mod kept;
mod old_missions;
mod old_words;
mod once;
mod opening;
mod rights;
pub(crate) mod running;
mod sessions;
pub(crate) mod told;
mod web;

use client::Client;
use told::Message;

/// Filter of all topics of the program.
const OURS: &str = "hallsweep/discovery/#";

/// Topic that says whether the program is running.
const AVAILABILITY: &str = "hallsweep/discovery/availability";

/// Topic of a command.
fn command(name: &str) -> String {
    format!("hallsweep/discovery/command/{name}")
}

/// Received results of a command.
fn results(heard: &[Message], name: &str) -> Vec<serde_json::Value> {
    let topic = format!("{}/result", command(name));
    heard.iter().filter(|message| message.topic == topic).map(Message::json).collect()
}

/// Runs a scenario with every installed client.
fn with_each(scenario: impl Fn(Client)) {
    for client in Client::ALL.into_iter().filter(|client| client.is_here()) {
        // The test harness prints this when the scenario fails.
        eprintln!("with {client:?}");
        scenario(client);
    }
}
