//! The Roomba of seed 001: a round robot in an empty room, driven by a state machine or by a behaviour tree with the same
//! behaviour. It shares only arithmetic and random numbers with the hall and its mission.
//!
//! ```text
//!              ┌── machine ──┐  how fast?                 ┌─ drawing (SVG)
//!  seed ─► phase             ├───────────► room ─► run ───┼─ compare
//!              └── tree ─────┘  ◄── bumper ──            └─ floor (share passed over)
//! ```
//! There are sixty ticks per second. In each tick the driver is told whether a wall cut the last move short, and returns the
//! speeds; then the body moves. `phase` describes each of the four phases. Machine and tree only know the order of the phases.

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
