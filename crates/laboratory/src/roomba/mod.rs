//! The Roomba of the original specification (seed 001): a round robot in an empty room. It is driven by a state
//! machine or by a behaviour tree, which behave the same. Only arithmetic and random numbers are shared with the hall
//! mission.
//!
//! ```text
//!              ┌── machine ──┐  how fast?                 ┌─ drawing (SVG)
//!  seed ─► phase             ├───────────► room ─► run ───┼─ compare
//!              └── tree ─────┘  ◄── bumper ──            └─ floor (share passed over)
//! ```
//! There are sixty ticks per second. In each tick, the driver is told whether a wall cut the last move short, and
//! returns the speeds. Then the body moves. Each of the four phases is described in `phase`. Machine and tree only
//! know the order of the phases.

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
