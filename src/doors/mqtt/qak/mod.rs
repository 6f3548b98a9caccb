//! The messages of the original system (mission §8): how they are written, what those that come in ask for, and those that go out.
//! Pure: topics, sessions and the order in which things are published are not here.

pub mod incoming;
pub mod message;
pub mod outgoing;
mod reader;
pub mod term;
