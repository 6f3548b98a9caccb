//! Parses the bytes of requests before hyper and the routes read them. Finds where each request begins and ends,
//! which route it names, and who sends it. There is no socket, no clock and no decision about rights here.

mod body;
pub mod names;
mod scanner;

pub use scanner::{BodyLength, Field, Head, Heard, KEYS, Scanner};
