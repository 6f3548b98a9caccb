//! The two robots that fetch a piece: their behaviour trees with the leaves, and their ways. The engine decides who
//! may move when, and what is recorded.

mod kept;
mod leaves;
pub mod steer;
pub mod team;
pub mod view;
pub mod way;

pub(crate) use self::leaves::MOST_FAILURES;
pub use self::leaves::catalogue;
pub use self::steer::{Gear, steer};
pub use self::team::{Team, TickOutcome};
pub use self::view::{BaseView, Proposal, View};
pub use self::way::{Floor, Stands, Train};
