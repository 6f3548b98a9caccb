//! Behaviour trees: the engine, by the rules of BehaviorTree.CPP 4, whose files it reads and writes. START HERE.
//! What the leaves of a tree do is not here: whoever performs them is a `Leaves`. docs/trees.md says what may stand in a file.
//!
//! ```text
//!   file ─ xml::read ─► Document ─ Tree::build ─► Tree ─ tick(blackboard, leaves, time) ─► Status
//!            ▲             │        (every name     │  ▲                │
//!            └ xml::write ─┘         looked up)     │  └── resume ◄── state
//!                                                   └► nodes(), log::TickLog
//! ```
//! `findings`: all that is wrong with a file. `status`, `value`: what nodes say and ports hold. `blackboard`: the entries. `leaf`: the catalogue of leaves and who performs them.
//! `kind`: the engine's own nodes. `build`: names, ports and scopes. `tree`: the row of nodes. `tick`: the rules. `script`: the
//! language of conditions. `state`: going on after a restart. `log`: what each tick changed. `mock`: leaves by script.

pub mod blackboard;
mod build;
pub mod document;
pub mod error;
pub mod findings;
pub mod kind;
pub mod leaf;
pub mod log;
pub mod mock;
pub mod script;
pub mod state;
pub mod status;
pub mod tick;
pub mod tree;
pub mod value;
pub mod xml;

pub use self::blackboard::Blackboard;
pub use self::document::{Document, Element};
pub use self::error::TreeError;
pub use self::findings::Findings;
pub use self::leaf::{Catalogue, Direction, Leaf, LeafKind, Leaves, Port};
pub use self::log::TickLog;
pub use self::mock::Mocks;
pub use self::state::TreeState;
pub use self::status::Status;
pub use self::tick::Fault;
pub use self::tree::{NodeId, NodeView, Tree};
pub use self::value::{Value, ValueType};
