//! The mission: its phases, what holds it, and the one total table that says what every input does in every phase.
//! The table and its words are here; `crate::engine` carries its acts out.

mod asked;
pub mod fact_words;
mod hold;
mod input;
mod pace;
mod phase;
mod print;
mod rule;
mod state;
mod table;
mod words;
pub use asked::Asked;
pub use hold::{Hold, Holds};
pub(crate) use input::{Input, InputContext};
pub use phase::{FaultCause, Inspection, Phase, PhaseName, Stage};
pub use print::table_markdown;
pub(crate) use rule::{Act, Case, Guard, Rule, To};
pub use state::Goal;
pub(crate) use state::{Deciding, Mission, Recording, TRAIL};
pub(crate) use table::rules;
pub use words::in_words;
