//! The bytes of every client are read on the hearing thread (safety S7). `scanning` parses the bytes before hyper
//! does. A STOP of a permitted sender halts the robot as soon as its head is complete (S8). Then the bytes are passed
//! to hyper on another runtime.
//!
//! ```text
//!   client ─► connection: read, decrypt ─► scanning ─► judge ─► Handle (halts)
//!                  │ a pipe of PIPE bytes                │ result of the STOP, by the request's number
//!                  ▼                                     ▼
//!   connection_task: hyper ─► guard ─► gate ─► handler of the same request ─► answer ─► client
//! ```

mod connection;
mod connection_task;
mod context;
mod frames;
mod judge;
mod shared;

#[cfg(test)]
pub(super) use connection::AHEAD;
pub(super) use connection::converse;
pub(super) use context::ServerContext;
pub(super) use shared::{Arrived, Pressed};
