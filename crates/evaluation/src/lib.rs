//! Measures and tunes search strategies: families of random halls, searches without a mission, and the tuning of
//! weights. Nothing here is needed to run a mission, and no file is written.
//!
//! ```text
//!   family ─► hall ─► ground ─► walk: a strategy searches the true hall, move by move
//!                                ├─► compare: strategies on the same halls ─► figures, drawing
//!                                ├─► time_left: how often a forecast of the remaining time is correct
//!                                └─► tune: cross-entropy ─► counterfactuals ─► weights
//! ```

pub mod areas;
pub mod calibrate;
pub mod compare;
pub mod drawing;
pub mod family;
mod ground;
mod parallel;
pub mod time_left;
pub mod tune;
pub mod walk;

pub use ground::Ground;
