//! The pair that fetches a piece: what its two robots can do and say, where they can be, and the ways they find.
//! Who may move when, and what is on record of it, is the engine's business.

pub mod arm;
pub mod fault;
pub mod kept;
mod leaves;
pub mod not_fetched;
pub mod place;
pub mod steer;
pub mod team;
pub mod view;
pub mod way;

pub use self::arm::{ArmAction, ArmState, Controllers, Gripper, Parcel};
pub use self::fault::RetrievalFault;
pub use self::kept::TeamState;
pub(crate) use self::leaves::MOST_FAILURES;
pub use self::leaves::catalogue;
pub use self::not_fetched::{AloneFault, NotFetched, StuckFault};
pub use self::place::Place;
pub use self::steer::{Gear, steer};
pub use self::team::{Team, TeamStage, TickOutcome};
pub use self::view::{BasePose, BaseView, Proposal, Saying, View, Which};
pub use self::way::{Floor, Stands, Train};
