//! The messages of the original system (mission §8): their syntax, the meaning of incoming messages, and the contents
//! of outgoing messages. Topics, sessions and the order of publishing are elsewhere.

pub mod incoming;
pub mod message;
pub mod outgoing;
mod reader;
pub mod term;
