//! The shapes of resources, commands and refusals in JSON and CBOR, shared by the doors. The runtime and the core do
//! not use serde. The tables from which the doors derive their paths, and the statuses of problem details, are here
//! too. Some shapes are used by one door only (the simulator, the record, excerpts, results). They are here for two
//! reasons: all shapes that users see are in one place, and `api` may use the simulator's crate, but doors may not.

pub mod address;
pub mod alarm;
pub mod answer;
pub mod cbor;
pub mod changes;
pub mod command;
pub mod commands;
pub mod concise_problem;
pub mod coverage;
pub mod door;
pub mod excerpt;
pub mod exercise;
pub mod fields;
pub mod hall_files;
pub mod halls;
pub mod halt;
pub mod journal;
pub mod journal_words;
pub mod log;
pub mod luggage;
pub mod map;
pub mod map_files;
pub mod map_text;
pub mod mission;
pub mod mission_record;
pub mod old_clients;
pub mod old_items;
pub mod problem;
pub mod receipt;
pub mod replay;
pub mod resources;
pub mod result;
pub mod retrieval;
pub mod retrieval_record;
pub mod robot;
pub mod robot_parts;
pub mod schemas;
pub mod senml;
pub mod simulator;
pub mod state;
pub mod temperature;
#[cfg(test)]
pub(crate) mod tests;
pub mod text;
pub mod time;
pub mod vocabulary;

/// Whether a field is left out, because its value is the usual one.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
