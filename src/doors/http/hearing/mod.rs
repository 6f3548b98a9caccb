//! How this door hears: what a client sends is read on a thread of its own (safety S7), followed by the `scanning` before hyper sees
//! it, and a STOP of whoever may stop halts at the end of its head (S8); then the bytes go on to hyper, which runs elsewhere.
//!
//! ```text
//!   client ─► connection: read, decrypt ─► scanning ─► judge ─► Handle (halts)
//!                  │ a pipe of PIPE bytes                │ what became of it, by the request's number
//!                  ▼                                     ▼
//!   connection_task: hyper ─► routes ─► gate ─► handler of the same request ─► answer ─► client
//! ```

mod connection;
mod connection_task;
mod context;
mod conversation;
mod frames;
mod judge;
mod shared;
mod stop_search;

#[cfg(test)]
pub(super) use connection::AHEAD;
pub(super) use context::ServerContext;
pub(super) use conversation::converse;
pub(super) use shared::{Arrived, Pressed};
