//! Parses the bytes of requests before hyper and the routes read them: where each request begins and ends, what it names, and
//! who sends it. There is no socket, no clock and no decision about permissions here.

mod body;
pub mod names;
mod scanner;

pub use scanner::{BodyLength, Field, Head, Heard, KEYS, Scanner};
