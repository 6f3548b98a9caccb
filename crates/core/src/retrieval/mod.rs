//! The pair that fetches a piece: its trees with their leaves, and the ways that its robots find.
//! Who may move when, and what is on record of it, is the engine's business.

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
pub use self::view::{BasePose, BaseView, Proposal, View, Which};
pub use self::way::{Floor, Stands, Train};
