//! What the bytes of requests say before hyper and the routes read them: where each request begins and ends, what it names, and
//! who sends it. There is no socket, no clock and no decision about permissions here.

mod body;
mod head;
pub mod names;
mod scanner;

pub use head::{BodyLength, Field, Head, KEYS};
pub use scanner::{Heard, Scanner};
