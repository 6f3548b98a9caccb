//! The MQTT door with clients that others wrote, each in its own process, against the real program and its own broker. That the gate
//! keeps to the standard is tested beside it; here it matters that what people have installed works with it.
//!
//! Where a client is absent its share is left out with a word; with `HALLSWEEP_REQUIRE_CLIENTS=1` it fails.

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
mod running;
mod sessions;
mod told;
mod web;

use client::Client;
use told::Message;

/// Where everything of ours is.
const OURS: &str = "hallsweep/discovery/#";

/// Where it stands whether the program is there.
const AVAILABILITY: &str = "hallsweep/discovery/availability";

/// The topic of a command of ours.
fn command(name: &str) -> String {
    format!("hallsweep/discovery/command/{name}")
}

/// The results of a command that were heard.
fn results(heard: &[Message], name: &str) -> Vec<serde_json::Value> {
    let topic = format!("{}/result", command(name));
    heard.iter().filter(|message| message.topic == topic).map(Message::json).collect()
}

/// Plays a scenario with every client that is there.
fn with_each(scenario: impl Fn(Client)) {
    for client in Client::ALL.into_iter().filter(|client| client.is_here()) {
        // Seen when the scenario fails.
        eprintln!("with {client:?}");
        scenario(client);
    }
}
