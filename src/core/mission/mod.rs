//! The mission: its phases, what holds it, and the one total table that says what every input does in every phase.
//! The table and its words are here; `crate::core::sweep` carries its acts out.

mod hold;
mod phase;
pub use hold::{Hold, Holds};
pub use phase::{FaultCause, Inspection, Phase, PhaseName, Stage};
