//! The mission: one complete table that defines every input in every phase. `crate::state` has the phases, and
//! `crate::engine` carries out the acts.

mod input;
mod print;
mod rule;
mod table;
pub(crate) use input::{Input, InputContext};
pub use print::table_markdown;
pub(crate) use rule::{Act, Case, Guard, Rule, To};
pub(crate) use table::rules;
