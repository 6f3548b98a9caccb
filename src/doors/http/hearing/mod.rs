//! How this door hears: what a client sends is read on a thread of its own (safety S7), followed by the `scanning` before hyper sees
//! it, and a STOP of whoever may stop halts at the end of its head (S8); then the bytes go on to hyper, which runs elsewhere.
//!
//! ```text
//!   client ─► connection: read, decrypt ─► scanning ─► judge ─► Handle (halts)
//!                  │ a pipe of PIPE bytes                │ what became of it, by the request's number
//!                  ▼                                     ▼
//!              talk: hyper ─► routes ─► gate ─► handler of the same request ─► answer ─► client
//! ```

mod connection;
mod judge;
mod line;
mod stop_search;
mod talk;

#[cfg(test)]
pub(super) use connection::AHEAD;
pub(super) use line::{Line, converse};
pub(super) use talk::{Arrived, Pressed};
