//! The mission: the one total table that defines every input in every phase. Phases stand in
//! `crate::state`; `crate::engine` carries the acts out.

mod input;
mod print;
mod rule;
mod table;
pub(crate) use input::{Input, InputContext};
pub use print::table_markdown;
pub(crate) use rule::{Act, Case, Guard, Rule, To};
pub(crate) use table::rules;
