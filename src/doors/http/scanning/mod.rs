//! What can be told of requests from their bytes alone, before hyper and the routes: where each begins and ends, what it names, and
//! who asks. No socket, no clock, and no decision whether anybody may.

mod body;
mod head;
pub mod names;
mod scanner;

pub use head::{BodyLength, Field, Head, KEYS};
pub use scanner::{Heard, Scanner};
