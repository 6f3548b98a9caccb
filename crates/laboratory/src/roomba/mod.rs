//! The Roomba of seed 001: a round robot in an empty room, driven by a state machine or by a behaviour tree that do the same.
//! It has nothing of the hall and its mission; only arithmetic and chance are shared.
//!
//! ```text
//!              ┌── machine ──┐  how fast?                 ┌─ drawing (SVG)
//!  seed ─► phase             ├───────────► room ─► run ───┼─ compare
//!              └── tree ─────┘  ◄── bumper ──            └─ floor (share passed over)
//! ```
//! In each of sixty ticks a second the one that drives is told whether a wall cut the last move short and says how fast to go; then
//! the body moves. `phase` is how each of the four phases goes; in which order they follow is all that machine and tree know.

mod compare;
mod drawing;
mod driver;
mod floor;
mod length;
mod machine;
mod phase;
mod room;
mod run;
mod shown;
#[cfg(test)]
mod tests;
mod tree;

pub use compare::Parting;
pub use drawing::Words;
pub use length::{RunLength, RunLengthError};
pub use phase::Phase;
pub use run::{Controller, Figures, Run, Transition};
pub use shown::{FigureRow, Roomba, RoombaJson};
