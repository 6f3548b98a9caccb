//! Behaviour trees: an engine with the rules of BehaviorTree.CPP 4, which reads and writes its files. START HERE. The
//! program performs the leaves, through the trait `Leaves`. The rules of every node are documented beside its code.
//!
//! ```text
//!   file ─ xml::read ─► Document ─ Tree::build ─► Tree ─ tick(blackboard, leaves, time) ─► Status
//!            ▲             │        (every name     │  ▲                │
//!            └ xml::write ─┘         looked up)     │  └── resume ◄── state
//!                                                   └► nodes(), log::TickLog
//! ```
//! * `findings`: all faults of a file.
//! * `status`, `value`: what nodes return and ports hold.
//! * `blackboard`: the entries.
//! * `leaf`: the catalogue of leaves and who performs them.
//! * `kind`: the engine's own nodes.
//! * `build`: names, ports and scopes.
//! * `tree`: the nodes in one row.
//! * `tick`: the rules.
//! * `script`: the language of conditions.
//! * `state`: continuing after a restart.
//! * `log`: what each tick changed.
//! * `mock`: leaves with scripted results.

#![warn(missing_docs)]

/// Declares an enum with one fixed word for each variant, and a list of all variants in order.
macro_rules! named {
    ($(#[$meta:meta])* $vis:vis enum $name:ident { $($(#[$doc:meta])* $variant:ident = $word:literal,)* }) => {
        $(#[$meta])*
        $vis enum $name {
            $($(#[$doc])* $variant,)*
        }

        impl $name {
            /// All variants in the order of their declaration.
            $vis const ALL: [$name; [$($word),*].len()] = [$($name::$variant),*];

            /// The fixed word of this variant in files and messages.
            #[must_use]
            $vis const fn word(self) -> &'static str {
                match self {
                    $($name::$variant => $word,)*
                }
            }
        }
    };
}

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
pub use self::value::{Cell, Value, ValueType};

/// The FNV-1a hash of a text. The hash is stored, so it must be the same in every version of the program.
fn fnv1a(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Compiles the example in the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
