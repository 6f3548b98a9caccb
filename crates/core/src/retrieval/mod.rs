//! The retrieval of a dangerous piece by a pair of mobile manipulators: where they can be and which ways they have.

mod place;
mod way;

pub use self::place::Place;
pub use self::way::{Floor, Stands, Train};
